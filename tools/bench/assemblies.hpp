#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/benchmarks.hpp"
#include "contact/pipeline/contact_pipeline.hpp"
#include "lockstep/bodies.hpp"

namespace tact::bench {

/// Two bodies as they are served: baked, mapped.
struct Assembly {
  SceneSpec spec;
  lockstep::Bodies bodies;
  contact::BakedScene baked;

  double voxel_m() const { return bodies.field.voxel_m(); }
};

/// Bakes what is not in the cache. Throws SetupError.
Assembly bake_assembly(SceneSpec spec);

/// A tool that is set down somewhere and asked what it feels; its mesh frame in that of the obstacle.
class Probe {
 public:
  Probe(const Assembly& assembly, const std::string& law);

  const contact::ContactResult& at(const Pose& X_OM);
  /// What the contacts do along a path of poses at `s`: force for a path in metres, torque for one in radians. Positive
  /// along growing s.
  double effort(const std::function<Pose(double)>& path, double s, double step);

 private:
  contact::ContactPipeline pipeline_;
  Pose X_MT_;
};

/// Where a function that falls from above `level` at `low` to below it at `high` passes it.
double falls_to(const std::function<double(double)>& f, double level, double low, double high);

/// Laws to compare.
std::vector<std::string> laws_for(const Effort& effort);

/// The parts of benchmark `assemblies`.
void bench_pegs(const Effort& effort, Report& report);
void bench_thread(const Effort& effort, Report& report);
void bench_engine_part(const Effort& effort, Report& report);
void bench_scans(const Effort& effort, Report& report);

}  // namespace tact::bench
