// The hydraulic actuator. All numbers are millimetres (Assembly).
#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"
#include "shapes/landing_gear.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;

/// Fork at x = 0, open towards -x: two cheeks 43 mm apart on a base that reaches to `root`.
void add_fork(Assembly& a, const Pose& X, double root) {
  for (const double side : {-1.0, 1.0}) {
    Outline cheek = circle(34, a.sides(34));
    for (const double y : {-30.0, 30.0}) cheek.emplace_back(root - 14, y);
    const double low = side < 0 ? -37.5 : 21.5;
    // In (x, z): thickness along -y.
    a.add(plate(convex_hull(cheek), {circle(16, a.sides(16))}, low, low + 16),
          X * frame(Vec3::Zero(), -Vec3::UnitY(), Vec3::UnitX()));
    // A bush round the hole.
    const Vec3 face(0, -side * (37.5 + kSeam), 0);
    a.turned({{16.2, 0}, {23, 0}, {23, 2.5}, {16.2, 2.5}}, X * frame(face, face), 0.4);
  }
  a.add(bevelled(rounded(rectangle({-37.5, -32}, {37.5, 32}), 8, a.edge()), 14 - kSeam, 2),
        X * frame({root - 14 + kSeam, 0, 0}, Vec3::UnitX(), Vec3::UnitY()));
}

}  // namespace

double Actuator::length_m() { return (LandingGear::lower_pin() - LandingGear::upper_pin()).norm(); }

Mesh Actuator::mesh() const {
  Assembly a(edge_m * 1e3);
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const double end = length_m() * 1e3;
  add_fork(a, {}, 70);
  add_fork(a, Pose{{end, 0, 0}, Quat(Eigen::AngleAxisd(std::numbers::pi, z))}, 68);
  const Pose axis = frame(Vec3::Zero(), x, z);
  // Cylinder with its end caps.
  Outline body{{0, 70.1}, {30, 70.1}, {34, 76}, {34, 84}, {50, 86}, {51, 88}, {51, 112}, {50, 114}, {48, 115}};
  for (int i = 0; i < 5; ++i) {  // bands
    const double at = 150 + 56. * i;
    body.insert(body.end(), {{48, at}, {49.5, at + 1}, {49.5, at + 9}, {48, at + 10}});
  }
  body.insert(body.end(), {{48, 428},
                           {50, 429},
                           {51, 431},
                           {51, 462},
                           {49, 465},
                           {38, 466},
                           {36, 468},
                           {36, 482},
                           {34, 484},
                           {24, 484},
                           {24, end - 92},
                           {26, end - 90},
                           {32, end - 88},
                           {32, end - 70},
                           {30, end - 68.1},
                           {0, end - 68.1}});
  a.turned(body, axis, 0.8);
  for (const double at : {100.0, 447.0}) {  // ports with their fittings
    a.turned({{0, 0}, {11, 0}, {11, 6}, {8, 7}, {8, 13}, {9.5, 14}, {9.5, 19}, {0, 19}}, frame({at, 51.2, 0}, y), 0.5);
    // On the other side a boss for the tube that joins both caps.
    a.turned({{0, 0}, {9, 0}, {9, 5}, {10, 6}, {10, 15}, {8, 17}, {0, 17}}, frame({at, -51.2, 0}, -y), 0.5);
  }
  a.bar({110.2, -60, 0}, {436.8, -60, 0}, 5);
  return a.take();
}

}  // namespace tact::shapes
