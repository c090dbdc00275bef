// A braked wheel of the landing gear. All numbers are millimetres (Assembly).
#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"
#include "shapes/landing_gear.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;
constexpr double kTurn = 2 * std::numbers::pi;

void add_tyre(Assembly& a, const Pose& hub) {
  Outline half{{281, -140}, {300, -146}, {340, -160}, {450, -160}, {490, -146}, {512, -116}};
  for (int i = 0; i < 5; ++i) {  // grooves of the tread
    const double z = -84 + 42 * i, crown = 520 - 2.5 * std::abs(i - 2);
    half.insert(half.end(), {{crown, z - 4}, {508, z - 3.4}, {508, z + 3.4}, {crown, z + 4}});
  }
  half.insert(half.end(), {{512, 116}, {490, 146}, {450, 160}, {340, 160}, {300, 146}, {281, 140}});
  a.turned(half, hub, 3);
}

void add_rim(Assembly& a, const Pose& hub) {
  a.turned({{262, -150},
            {295, -162},
            {298, -157},
            {280.8, -146},
            {280.8, 146},
            {298, 157},
            {295, 162},
            {262, 150},
            {258, 60},
            {258, -60}},
           hub, 2);
  std::vector<Outline> holes{circle(70, a.sides(70))};
  for (int i = 0; i < 12; ++i) {
    const double angle = kTurn * (i + 0.5) / 12;
    holes.push_back(circle(30, a.sides(30), 190 * Vec2(std::cos(angle), std::sin(angle))));
  }
  a.add(plate(circle(258 - kSeam, a.sides(258)), holes, 10, 46), hub);
  for (int i = 0; i < 24; ++i) {
    const double angle = kTurn * (i + 0.5) / 24;
    a.bolt(hub * Vec3(236 * std::cos(angle), 236 * std::sin(angle), 46), hub.q * Vec3::UnitZ(), 14, true);
  }
  a.turned({{0, -150}, {60, -150}, {69.8, -140}, {69.8, 130}, {60, 142}, {52, 150}, {52, 164}, {46, 168}, {0, 168}},
           hub, 2);
  for (int i = 0; i < 6; ++i) {
    const double angle = kTurn * i / 6;
    a.bolt(hub * Vec3(32 * std::cos(angle), 32 * std::sin(angle), 168), hub.q * Vec3::UnitZ(), 8);
  }
}

/// Stator and rotor discs in the wheel's well, and the housing with its pistons.
void add_brake(Assembly& a, const Pose& hub) {
  for (int i = 0; i < 5; ++i) {
    const double z = -150 + 26. * i, r = i % 2 == 0 ? 236 : 224;
    a.add(plate(gear(i % 2 == 0 ? 36 : 18, r - 12, r), {circle(96, a.sides(96))}, z, z + 20), hub);
  }
  a.turned({{52, -300},
            {120, -300},
            {124, -296},
            {124, -240},
            {130, -236},
            {214, -236},
            {220, -224},
            {220, -176},
            {214, -170},
            {140, -168},
            {120, -160},
            {52, -158}},
           hub, 3);
  for (int i = 0; i < 9; ++i) {
    const double angle = kTurn * i / 9, z = -236, r = 176;
    const Pose at = hub * Pose{{r * std::cos(angle), r * std::sin(angle), z}, Quat::Identity()};
    a.turned({{0, -44}, {14, -44}, {18, -40}, {22, -30}, {22, -kSeam}, {0, -kSeam}}, at, 1);
  }
}

}  // namespace

void add_wheel(Assembly& a, const Pose& hub) {
  add_tyre(a, hub);
  add_rim(a, hub);
  add_brake(a, hub);
}

}  // namespace tact::shapes
