// The landing gear but for its lines. All numbers are millimetres (Assembly).
#include "shapes/landing_gear.hpp"

#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;
const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();
const Vec3 kUpperPin(230, 0, 1250), kLowerPin(560, 0, 690);
constexpr double kAxle = 700, kAxleHeight = 520;  // of the wheels from the middle, above ground

/// Outlines in (x, z); this frame extrudes them along -y.
const Pose kSide = frame(Vec3::Zero(), -kY, kX);

void add_strut(Assembly& a) {
  // Cylinder with its collars; piston below.
  a.turned({{0, 1150},   {160, 1150}, {172, 1162}, {172, 1318}, {164, 1330}, {152, 1340}, {150, 1350},
            {150, 1690}, {165, 1704}, {165, 1756}, {150, 1770}, {150, 2080}, {158, 2086}, {158, 2110},
            {150, 2116}, {150, 2460}, {178, 2484}, {178, 2548}, {170, 2560}, {0, 2560}},
           Pose{}, 2);
  a.turned({{0, 640.1},
            {112, 640.1},
            {112, 690},
            {104, 700},
            {95, 704},
            {95, 1120},
            {130, 1122},
            {134, 1126},
            {134, 1146},
            {130, 1150 - kSeam},
            {0, 1150 - kSeam}},
           Pose{}, 2);
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * std::numbers::pi * i / 24;
    if (std::abs(std::sin(angle)) > 0.45)
      a.bolt({172 * std::cos(angle), 172 * std::sin(angle), 1190}, {std::cos(angle), std::sin(angle), 0}, 10);
  }
  // Trunnion across the top, with its bearings, and the charging valve.
  a.block({-170, -170, 2560 + kSeam}, {170, 170, 2590}, 2, 40, 4);
  for (const double side : {-1.0, 1.0}) {
    a.turned({{0, 0.1},
              {86, 0.1},
              {86, 420},
              {100, 424},
              {112, 430},
              {112, 500},
              {106, 508},
              {70, 508},
              {70, 600},
              {60, 612},
              {0, 612}},
             frame({0, 0, 2680}, side * kY), 3);
    for (int i = 0; i < 12; ++i) {
      const double angle = 2 * std::numbers::pi * i / 12;
      a.bolt({90 * std::cos(angle), side * 508, 2680 + 90 * std::sin(angle)}, side * kY, 9);
    }
  }
  a.turned({{0, 2767},
            {80, 2767},
            {84, 2772},
            {84, 2790},
            {60, 2800},
            {50, 2812},
            {50, 2836},
            {20, 2840},
            {16, 2844},
            {16, 2866},
            {12, 2870},
            {0, 2870}},
           Pose{}, 2);
}

void add_bogie(Assembly& a) {
  a.block({-120, -130, 396}, {120, 130, 640}, 1, 60, 8);
  for (const double side : {-1.0, 1.0}) {
    a.turned({{0, 120.1},
              {120, 120.1},
              {120, 150},
              {106, 170},
              {104, 180},
              {104, 560},
              {110, 572},
              {110, 600},
              {96, 639.9},
              {0, 639.9}},
             frame({0, 0, kAxleHeight}, side * kX, kZ), 3);
    a.block({side * 640 - (side < 0 ? 124 : 0), -110, 416}, {side * 640 + (side < 0 ? 0 : 124), 110, 624}, 1, 50, 6);
    for (const double across : {-1.0, 1.0}) {
      a.bar({side * kAxle, across * (110 + kSeam), kAxleHeight}, {side * kAxle, across * 339, kAxleHeight}, 51.5);
      add_wheel(a, frame({side * kAxle, across * 490, kAxleHeight}, across * kY, kZ));
    }
    a.bolt({side * 764, 50, 520}, side * kX, 30);
    a.bolt({side * 764, -50, 520}, side * kX, 30);
  }
  a.bar({0, 130 + kSeam, 520}, {0, 165, 520}, 70);
  a.bar({0, -165, 520}, {0, -130 - kSeam, 520}, 70);
}

/// Lugs for the actuator: the forks' cheeks pass on both sides of them.
void add_lugs(Assembly& a) {
  const auto lug = [&](const Vec3& pin, const std::vector<Vec2>& feet) {
    Outline points = circle(30, a.sides(30), {pin.x(), pin.z()});
    points.insert(points.end(), feet.begin(), feet.end());
    Mesh mesh = plate(convex_hull(points), {circle(15, a.sides(15), {pin.x(), pin.z()})}, -18, 18);
    a.add(mesh, kSide);
  };
  lug(kUpperPin, {{172 + kSeam, 1168}, {172 + kSeam, 1256}});
  lug(kLowerPin, {{424, 624 + kSeam}, {524, 624 + kSeam}});
}

/// Torsion links behind the strut, drag brace and side braces.
void add_links(Assembly& a) {
  const Vec2 upper(-226, 1230), apex(-470, 960), lower(-190, 702);
  const auto plate_between = [&](const Vec2& p, double rp, const Vec2& q, double rq, double from, double to) {
    const Vec2 middle = 0.55 * p + 0.45 * q;
    for (const double side : {-1.0, 1.0}) {
      const double low = side < 0 ? -to : from;
      a.add(plate(link(p, rp, q, rq, a.edge()),
                  {circle(rp * 0.5, a.sides(rp * 0.5), p), circle(rq * 0.5, a.sides(rq * 0.5), q),
                   circle(rp * 0.62, a.sides(rp * 0.62), middle)},
                  low, low + to - from),
            kSide);
    }
  };
  plate_between(upper, 46, apex, 36, 62, 86);
  plate_between(lower, 50, apex, 36, 34, 58);
  for (const Vec2& pin : {upper, apex, lower}) a.bar({pin.x(), -100, pin.y()}, {pin.x(), 100, pin.y()}, 15);
  for (const double side : {-1.0, 1.0}) {  // their lugs
    Outline upper_lug = circle(40, a.sides(40), upper), lower_lug = circle(44, a.sides(44), lower);
    upper_lug.insert(upper_lug.end(), {{-172.5, 1180}, {-172.5, 1290}});
    lower_lug.insert(lower_lug.end(), {{-112.5, 650}, {-112.5, 688}});
    a.add(plate(convex_hull(upper_lug), {circle(15.4, a.sides(15.4), upper)}, side < 0 ? -60 : 24, side < 0 ? -24 : 60),
          kSide);
    a.add(plate(convex_hull(lower_lug), {circle(15.4, a.sides(15.4), lower)}, side < 0 ? -32 : 8, side < 0 ? -8 : 32),
          kSide);
    // Side braces from the middle collar to the trunnion.
    const Vec3 from(0, side * 230, 1764), to(0, side * 462, 2562);
    const Vec3 way = (to - from).normalized();
    a.bar(from + 10 * way, to - 6 * way, 34);
    a.turned({{34.2, 0}, {46, 0}, {46, 40}, {34.2, 40}}, frame(from + 0.5 * (to - from), way), 3);
    a.block({-50, side < 0 ? -280. : 165 + kSeam, 1700}, {50, side < 0 ? -165 - kSeam : 280., 1760}, 2, 14, 3);
  }
  for (const double side : {-1.0, 1.0}) {  // drag brace
    const Vec3 from(-212, side * 74, 1780), to(-1040, side * 240, 2600);
    const Vec3 way = (to - from).normalized();
    a.block({-250, side * 74 - 30, 1690}, {-166, side * 74 + 30, 1756}, 1, 16, 3);
    a.bar(from + 10 * way, to - kSeam * way, 40);
    for (const double at : {0.2, 0.5, 0.8}) {
      a.turned({{40.2, 0}, {50, 0}, {50, 36}, {40.2, 36}}, frame(from + at * (to - from), way), 3);
    }
    a.turned({{0, 0}, {60, 0}, {64, 6}, {64, 30}, {0, 30}}, frame(to, way), 2);
  }
  a.bar({-612, -103, 2180}, {-612, 103, 2180}, 24);
}

}  // namespace

Vec3 LandingGear::upper_pin() { return 1e-3 * kUpperPin; }
Vec3 LandingGear::lower_pin() { return 1e-3 * kLowerPin; }
Vec3 LandingGear::passage_centre() { return {0.95, 0, 1.03}; }
Vec3 LandingGear::approach() { return kY.cross(kLowerPin - kUpperPin).normalized(); }

Mesh LandingGear::mesh() const {
  Assembly a(edge_m * 1e3);
  add_strut(a);
  add_bogie(a);
  add_lugs(a);
  add_links(a);
  add_gear_lines(a, *this);
  return a.take();
}

}  // namespace tact::shapes
