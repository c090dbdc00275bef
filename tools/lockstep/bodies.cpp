#include "lockstep/bodies.hpp"

#include <cmath>
#include <numbers>

#include "field/field_builder.hpp"

namespace tact::lockstep {
namespace {

constexpr double kVoxel_m = 1e-3, kFoot_m = 0.04, kGap_m = 0.002, kPress_m = 0.03;

/// One level: brute force over all points, which is what a few hundred of them want.
std::shared_ptr<const contact::Pointshell> flat_shell(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                                      double gyration_radius_m) {
  contact::Pointshell shell;
  for (std::size_t i = 0; i < points.size(); ++i) {
    shell.position_T.push_back(points[i].cast<float>());
    shell.normal_T.push_back(normals[i].cast<float>());
    shell.bounding_radius_m = std::max(shell.bounding_radius_m, points[i].norm());
  }
  const std::size_t n = points.size();
  shell.radius_m.assign(n, 0.f);
  shell.child_begin.assign(n, 0);
  shell.child_end.assign(n, 0);
  shell.level_begin = {0, static_cast<std::uint32_t>(n)};
  shell.area_m2.assign(n, static_cast<float>(1.0 / static_cast<double>(n)));
  shell.gyration_radius_m = gyration_radius_m;
  shell.inertia_shape_m2 = Mat3::Identity() * gyration_radius_m * gyration_radius_m;
  return std::make_shared<const contact::Pointshell>(std::move(shell));
}

/// `count` points at the corners of a square lattice, as square as the count allows, in the plane z = 0 of T.
std::shared_ptr<const contact::Pointshell> foot(int count) {
  const int rows = static_cast<int>(std::lround(std::sqrt(count)));
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const int row = i % rows, column = i / rows, columns = (count + rows - 1) / rows;
    points.emplace_back(kFoot_m * (column / std::max(1.0, columns - 1.0) - 0.5),
                        kFoot_m * (row / std::max(1.0, rows - 1.0) - 0.5), 0);
  }
  return flat_shell(points, std::vector<Vec3>(points.size(), Vec3::UnitZ()), 0.025);
}

AnalyticScene scene(const std::string& name, DistanceField field, std::shared_ptr<const contact::Pointshell> shell,
                    double start_z_m) {
  AnalyticScene s;
  s.spec.name = name;
  s.spec.start_X_WM.p.z() = start_z_m;
  Pose end = s.spec.start_X_WM;
  end.p.z() -= kPress_m;
  s.motion_WM = {{0, 0.5}, {s.spec.start_X_WM, end}};
  s.bodies = {std::move(field), std::move(shell)};
  return s;
}

DistanceField half_space() {
  return build_field(Vec3(-0.06, -0.06, -0.02), Vec3(0.06, 0.06, 0.01), kVoxel_m, [](const Vec3& p) { return p.z(); });
}

}  // namespace

Bodies open_bodies(const contact::BakedScene& baked) {
  return {DistanceField::open(baked.obstacle.data, baked.obstacle.hash),
          std::make_shared<const contact::Pointshell>(contact::load_pointshell(baked.tool.data, baked.tool.hash))};
}

AnalyticScene flat_face(int points) {
  return scene("flat-" + std::to_string(points), half_space(), foot(points), kGap_m);
}

AnalyticScene ball_on_plane(int points) {
  constexpr double kRadius_m = 0.02;
  std::vector<Vec3> position, normal;
  constexpr double kTop = -0.8;       // of the points, in radii: what can touch while the ball hardly turns
  for (int i = 0; i < points; ++i) {  // Fibonacci
    const double z = -1 + (kTop + 1) * (i + 0.5) / points, r = std::sqrt(1 - z * z);
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    normal.emplace_back(-r * std::cos(angle), -r * std::sin(angle), -z);
    position.push_back(-kRadius_m * normal.back());
  }
  return scene("ball", half_space(), flat_shell(position, normal, std::sqrt(0.4) * kRadius_m), kRadius_m + kGap_m);
}

AnalyticScene foot_on_wires(int points) {
  const auto wires = [](const Vec3& p) {
    double nearest = 1e9;
    for (const double x : {-0.015, 0.0, 0.015}) nearest = std::min(nearest, std::hypot(p.x() - x, p.z()) - kVoxel_m);
    return nearest;
  };
  return scene("wires", build_field(Vec3(-0.02, -0.04, -0.004), Vec3(0.02, 0.04, 0.004), kVoxel_m, wires), foot(points),
               kVoxel_m + kGap_m);
}

}  // namespace tact::lockstep
