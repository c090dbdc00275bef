// Assemblies whose answer is known or that people really have: pegs, a screw, an engine's part, scans.
#include "bench/assemblies.hpp"

#include <cstdio>

#include "math/exp_log.hpp"

namespace tact::bench {

Assembly bake_assembly(SceneSpec spec) {
  bool told = false;
  auto baked = contact::ensure_baked(spec, cache_dir(MachineSpec{}), [&](const contact::BakeStep& step) {
    if (!told)
      std::fprintf(stderr, "tact-bench: baking %s of %s (kept in the cache)\n", step.part.c_str(), spec.name.c_str());
    return told = true;
  });
  lockstep::Bodies bodies = lockstep::open_bodies(baked);
  return {std::move(spec), std::move(bodies), std::move(baked)};
}

Probe::Probe(const Assembly& assembly, const std::string& law)
    : pipeline_(assembly.bodies.field, assembly.bodies.shell, static_cast<std::size_t>(assembly.spec.contact.capacity),
                [&] {
                  ContactSpec contact = assembly.spec.contact;
                  contact.law = law;
                  return contact::pipeline_params(contact, assembly.voxel_m(), assembly.spec.coupling.mass_kg, 1);
                }()),
      X_MT_(assembly.bodies.shell->X_TM.inverse()) {}

const contact::ContactResult& Probe::at(const Pose& X_OM) { return pipeline_.step({X_OM * X_MT_, {}, {}, {}}); }

double Probe::effort(const std::function<Pose(double)>& path, double s, double step) {
  const Vec6 way = displacement(path(s - step) * X_MT_, path(s + step) * X_MT_) / (2 * step);
  return at(path(s)).response_W.F.vector().dot(way);
}

double falls_to(const std::function<double(double)>& f, double level, double low, double high) {
  for (int i = 0; i < 50 && high - low > 1e-12; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) > level ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::vector<std::string> laws_for(const Effort& effort) {
  if (effort.quick) return {"none", "adaptive-6dof", "potential"};
  return {"none", "global", "cluster", "adaptive-3dof", "adaptive-6dof", "potential"};
}

void bench_assemblies(const Effort& effort, Report& report) {
  bench_pegs(effort, report);
  bench_thread(effort, report);
  bench_engine_part(effort, report);
  bench_scans(effort, report);
}

}  // namespace tact::bench
