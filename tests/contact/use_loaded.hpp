#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "contact/pipeline/contact_pipeline.hpp"
#include "field/distance_field.hpp"
#include "field/field_builder.hpp"
#include "mesh/mesh.hpp"

/// What a server does with what it has loaded, so that contents which lead astray do so in a test.
namespace tact::test {

/// Asks a field everything, one by one and many at once, wherever a tool may be. Returns at how many of the points the
/// two ways differ: at none, whatever the field holds.
inline std::size_t use(const DistanceField& field) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-0.5, 1.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> points{Vec3(nan, 0, 0), Vec3(1e300, -1e300, 0), field.min_O(), field.max_O()};
  while (points.size() < 203) {  // no multiple of any SIMD width
    points.push_back(field.min_O() +
                     Vec3(unit(random), unit(random), unit(random)).cwiseProduct(field.max_O() - field.min_O()));
  }
  const std::size_t n = points.size();
  std::vector<double> x, y, z, probed(n), clearance(n), value(n), gx(n), gy(n), gz(n);
  std::vector<std::uint8_t> flags(n);
  for (const Vec3& p : points) x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
  const DistanceField::Points many{x.data(), y.data(), z.data(), n};
  field.probe(many, probed.data(), clearance.data());
  field.sample(many, {value.data(), gx.data(), gy.data(), gz.data(), flags.data()});
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  std::size_t differ = 0;
  volatile double sink = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto sample = field.sample(points[i]);
    const auto probe = field.probe(points[i]);
    sink = sink + field.lower_bound(points[i]);
    const bool agree =
        same(sample.value_m, value[i]) && same(probe.value_m, probed[i]) && same(probe.clearance_m, clearance[i]) &&
        same(sample.gradient.x(), gx[i]) && same(sample.gradient.y(), gy[i]) && same(sample.gradient.z(), gz[i]) &&
        flags[i] == (sample.in_band ? DistanceField::kInBand : 0) + (sample.doubtful ? DistanceField::kDoubtful : 0);
    differ += agree ? 0 : 1;
  }
  return differ;
}

/// Steps the tool through the field: far off, touching, deep, back. Returns whether every contact names a point that is
/// there, in ascending order.
inline bool use(const DistanceField& field, std::shared_ptr<const contact::Pointshell> shell) {
  contact::PipelineParams params;
  params.hold_thin_parts = true;
  params.stiffness_n_per_m = 1000;
  params.x_max_m = 1e-3;
  const std::size_t points = shell->size();
  const Vec3 low = field.min_O(), size = field.max_O() - low;
  const Vec3 middle_T = shell->position_T.front().cast<double>();
  contact::ContactPipeline pipeline(field, std::move(shell), 16, params);
  bool sound = true;
  for (const double at : {100.0, 0.9, 0.5, 0.1, 1e30, 0.7}) {
    contact::ToolQuery query;
    query.X_WT.p = low + at * size - middle_T;
    query.X_WT.q = Quat(0.8, 0, 0.6, 0);
    pipeline.step(query);
    const contact::ContactBuffer& found = pipeline.contacts();
    for (std::size_t i = 0; i < found.size; ++i) {
      sound &= found.point_id[i] < points && (i == 0 || found.point_id[i - 1] < found.point_id[i]);
    }
  }
  return sound;
}

/// A sound field for doubtful shells, 1 cm in radius.
inline const DistanceField& sound_field() {
  static const DistanceField ball =
      build_field(Vec3::Constant(-0.01), Vec3::Constant(0.01), 0.002, [](const Vec3& p) { return p.norm() - 0.01; });
  return ball;
}

/// A sound shell for doubtful fields: two points, and below them three.
inline std::shared_ptr<const contact::Pointshell> sound_shell() {
  static const auto shell = [] {
    contact::Pointshell s;
    for (int i = 0; i < 5; ++i) {
      s.position_T.push_back(0.002f * Eigen::Vector3f(static_cast<float>(i), 1, -1));
      s.normal_T.push_back(Eigen::Vector3f::UnitZ());
      s.radius_m.push_back(i < 2 ? 0.01f : 0);
      s.area_m2.push_back(1e-6f);
    }
    s.child_begin = {2, 4, 5, 5, 5};
    s.child_end = {4, 5, 5, 5, 5};
    s.level_begin = {0, 2, 5};
    s.gyration_radius_m = s.bounding_radius_m = s.spacing_m = 0.01;
    return std::make_shared<const contact::Pointshell>(s);
  }();
  return shell;
}

}  // namespace tact::test
