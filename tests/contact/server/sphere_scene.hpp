#pragma once
#include <memory>
#include <random>

#include "contact/hierarchy.hpp"
#include "contact/pipeline/contact_pipeline.hpp"
#include "field/field_builder.hpp"

/// A shell on a sphere of 20 mm meets a field body that is a sphere of 40 mm.
namespace tact::contact::test {

inline constexpr double kVoxel = 0.002;

inline DistanceField sphere_field() {
  const Vec3 box = Vec3::Constant(0.05);
  return build_field(-box, box, kVoxel, [](const Vec3& p) { return p.norm() - 0.04; });
}

inline std::shared_ptr<const Pointshell> sphere_points(std::size_t n) {
  std::mt19937 rng(41);
  return std::make_shared<const Pointshell>(sphere_shell(rng, n, 0.02));
}

inline Pose touching(double depth_m) { return {Vec3(0.06 - depth_m, 0, 0), Quat::Identity()}; }

}  // namespace tact::contact::test
