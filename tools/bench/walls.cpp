// What thin parts bear before a tool slips through, and what a closed path through them yields, by direction of force.
#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/benchmarks.hpp"
#include "contact/pipeline/contact_pipeline.hpp"
#include "field/field_builder.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

constexpr double kVoxel = 1e-3;

/// Points on one level: as brute force has it.
std::shared_ptr<const contact::Pointshell> flat_shell(const std::vector<Vec3>& points,
                                                      const std::vector<Vec3>& normals) {
  auto shell = std::make_shared<contact::Pointshell>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    shell->position_T.push_back(points[i].cast<float>());
    shell->normal_T.push_back(normals[i].cast<float>());
    shell->bounding_radius_m = std::max(shell->bounding_radius_m, points[i].norm());
  }
  shell->radius_m.assign(points.size(), 0.f);
  shell->area_m2.assign(points.size(), 1e-6f);
  shell->child_begin.assign(points.size(), 0);
  shell->child_end.assign(points.size(), 0);
  shell->level_begin = {0, static_cast<std::uint32_t>(points.size())};
  return shell;
}

/// 20 x 20 mm, 10 mm high, points 0.7 voxels apart.
std::shared_ptr<const contact::Pointshell> box() {
  std::vector<Vec3> points, normals;
  const auto at = [](int i) { return 7e-4 * i - 9.8e-3; };
  for (const int s : {-1, 1}) {
    for (int i = 0; i < 29; ++i) {
      for (int j = 0; j < 29; ++j) points.emplace_back(at(i), at(j), 5e-3 * s), normals.push_back(-s * Vec3::UnitZ());
      for (int j = 0; j < 14; ++j) {
        points.emplace_back(at(i), 0.01 * s, 7e-4 * j - 4.6e-3), normals.push_back(-s * Vec3::UnitY());
        points.emplace_back(0.01 * s, at(i), 7e-4 * j - 4.6e-3), normals.push_back(-s * Vec3::UnitX());
      }
    }
  }
  return flat_shell(points, normals);
}

/// Radius 15 mm, 20 mm long, about y.
std::shared_ptr<const contact::Pointshell> cylinder() {
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 134; ++i) {
    for (int j = 0; j < 29; ++j) {
      const double a = 2 * M_PI * (i + 0.5 * (j % 2)) / 134;
      const Vec3 u(std::cos(a), 0, std::sin(a));
      points.push_back(0.015 * u + Vec3(0, 7e-4 * j - 9.8e-3, 0));
      normals.push_back(-u);
    }
  }
  return flat_shell(points, normals);
}

struct Case {
  std::string obstacle, tool;
  std::function<double(const Vec3&)> distance_m;
  std::shared_ptr<const contact::Pointshell> shell;
  double reach_m;  // from the tool's centre down to its surface
};

/// Poses are in the obstacle's frame; it lies askew in its grid.
class Press {
 public:
  Press(const Case& c, const std::string& law, const std::string& force_along)
      : reach_m_(c.reach_m),
        pipeline_(
            contact::ContactPipeline(build_field(Vec3::Constant(-0.035), Vec3::Constant(0.035), kVoxel,
                                                 [&](const Vec3& p) { return c.distance_m(kAskew.conjugate() * p); }),
                                     c.shell, c.shell->size(), params(law, force_along))) {}

  Pose pose(const Vec3& p_voxels, const Vec3& turn = Vec3::Zero()) const {
    const Vec3 p = kVoxel * p_voxels + Vec3(0, 0, reach_m_);
    return {kAskew * p, kAskew * exp_so3(turn)};
  }
  const contact::ContactResult& step(const Pose& X) {
    contact::ToolQuery query;
    query.X_WT = X;
    return pipeline_.step(query);
  }
  /// Pushed straight through: the largest force against it, in k voxels, and the depth there in voxels.
  std::pair<double, double> hold() {
    std::pair<double, double> best{0, 0};
    for (double z = 1; z > -4; z -= 0.01) {
      const auto& result = step(pose(Vec3(0.1, 0.17, z)));
      const double up = (kAskew.conjugate() * result.response_W.F.force).z() / (kStiffness * kVoxel);
      if (up > best.first) best = {up, result.max_depth_m / kVoxel};
      if (best.first > 0.3 && up < 0) break;
    }
    return best;
  }
  /// Into the obstacle and out again, `deep` voxels past first touch, aside and turning: net work over all work.
  double loop(int n, std::size_t steps) {
    double net = 0, all = 0;
    Pose last;
    for (std::size_t i = 0; i <= steps; ++i) {
      const double a = 2 * M_PI * static_cast<double>(i) / static_cast<double>(steps);
      const double z = 1.2 - (1.2 + 0.16 * n) * 0.5 * (1 - std::cos(a));
      const Pose X = pose(Vec3(0.1 + 2 * std::sin(a) * (n % 3 - 1), 0.17 + std::sin(2 * a) * (n % 2), z),
                          Vec3(0.02 * std::sin(a) * (n % 2), 0.03 * std::sin(a) * (n % 3 - 1), 0));
      if (i > 0) {
        const Vec6 dx = displacement(last, X);
        const double work = step(displaced(last, 0.5 * dx)).response_W.F.vector().dot(dx);
        net += work;
        all += std::fabs(work);
      }
      last = X;
    }
    return net / all;
  }

 private:
  static constexpr double kStiffness = 1e4;
  static inline const Quat kAskew = exp_so3(Vec3(0.3, 0.2, 0.5));
  static contact::PipelineParams params(const std::string& law, const std::string& force_along) {
    ContactSpec spec;
    spec.law = law;
    spec.force_along = force_along;
    spec.stiffness_n_per_m = kStiffness;
    return contact::pipeline_params(spec, kVoxel, 0.2, 1);
  }
  double reach_m_;
  contact::ContactPipeline pipeline_;
};

}  // namespace

void bench_walls(const Effort& effort, Report& report) {
  report.say(
      "Obstacles two voxels thick, askew in their grid. Holds: the largest force against a tool pushed straight "
      "through, in "
      "k voxels, and the depth there. Closed paths: net work over all work, six paths that reach up to two voxels in, "
      "the "
      "most gained and the mean.");
  const auto block = [](const Vec3& p, const Vec3& half) {
    const Vec3 q = p.cwiseAbs() - half;
    return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
  };
  const auto plate = [=](const Vec3& p) { return block(p, Vec3(0.03, 0.03, 1e-3)); };
  const auto edges = [=](const Vec3& p) {  // two walls 12 voxels apart, standing
    return block(Vec3(std::fabs(p.x()) - 6e-3, p.y(), p.z() + 6e-3), Vec3(1e-3, 0.03, 6e-3));
  };
  const auto wire_y = [](const Vec3& p) { return std::hypot(p.x(), p.z()) - 1e-3; };
  const auto wire_x = [](const Vec3& p) { return std::hypot(p.y(), p.z()) - 1e-3; };
  const Case cases[] = {{"plate", "box", plate, box(), 5e-3},
                        {"plate", "cylinder", plate, cylinder(), 0.015},
                        {"edges of two plates", "box", edges, box(), 5e-3},
                        {"wire", "box", wire_y, box(), 5e-3},
                        {"wire across", "cylinder", wire_x, cylinder(), 0.015},
                        {"wire along", "cylinder", wire_y, cylinder(), 0.015}};
  std::vector<Report::Row> rows;
  for (const Case& c : cases) {
    for (const std::string law : {"potential", "adaptive-6dof"}) {
      for (const std::string along : {"normal", "gradient", "held"}) {
        Press press(c, law, along);
        const auto [force, depth] = press.hold();
        double most = -1, sum = 0;
        for (int n = 0; n < 6; ++n) {
          const double net = press.loop(n, effort.quick ? 500 : 3000);
          most = std::max(most, net);
          sum += net;
        }
        rows.push_back(
            {c.obstacle + ", " + c.tool, law, along, number(force), number(depth), number(most), number(sum / 6)});
      }
    }
  }
  report.table({"obstacle, tool", "law", "force_along", "holds, k voxels", "depth, voxels", "most gained", "mean"},
               rows);
}

}  // namespace tact::bench
