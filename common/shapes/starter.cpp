// The starter motor. All numbers are millimetres (Assembly).
#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"
#include "shapes/engine.hpp"

namespace tact::shapes {

Mesh Starter::mesh() const {
  constexpr double kBody = kRadius_m * 1e3, kSolenoid = 24, kOffset = kBody + kSolenoid + 1.2;
  Assembly a(edge_m * 1e3);
  const Vec3 x = Vec3::UnitX(), z = Vec3::UnitZ();
  const Pose axis = frame(Vec3::Zero(), x, z);  // lathe: z along the shaft
  // Body, drive housing, nose and shaft are one turned piece; the flange sits in a groove of it.
  a.turned(
      {{0, -168},     {14, -168},   {15, -162},       {30, -162},       {34, -157},   {34, -148},   {kBody - 1, -147},
       {kBody, -145}, {kBody, -60}, {kBody - 1, -59}, {kBody - 1, -56}, {kBody, -55}, {kBody, -24}, {32, -16},
       {29, -9.9},    {26, -9.9},   {26, 0},          {24, 1},          {24, 9},      {20, 11},     {12, 11},
       {9, 13},       {9, 44},      {8, 45},          {0, 45}},
      axis, 0.6);
  Outline flange = link({-50, 0}, 10, {50, 0}, 10, edge_m * 1e3);
  for (const Vec2& p : circle(36, a.sides(36))) flange.push_back(p);
  a.add(plate(convex_hull(flange), {circle(26.1, a.sides(26)), circle(4.6, 20, {46, 0}), circle(4.6, 20, {-46, 0})}, -9,
              0),
        axis);
  a.add(plate(gear(10, 11, 15), {circle(9.1, 40)}, 19, 39), axis);
  // Through bolts of the cap.
  for (const double angle : {0.8, 2.4, 3.9, 5.5}) {
    a.bolt({-162, 22 * std::sin(angle), 22 * std::cos(angle)}, -x, 4);
  }
  // Solenoid with its cap, terminals and the strap to the body.
  const Vec3 s = kOffset * z;
  a.turned({{0, -104},
            {17, -104},
            {20, -101},
            {20, -92},
            {kSolenoid, -91},
            {kSolenoid, -26},
            {22, -20},
            {15, -9.2},
            {0, -9.2}},
           frame(s, x, z), 0.6);
  a.bolt(s + Vec3(-104, 9, 6), -x, 6, true);
  a.bolt(s + Vec3(-104, -9, 6), -x, 6, true);
  a.plug(s + Vec3(-104, 0, -9), -x, 4, 9);
  a.cable({s + Vec3(-108.4, -9, -6), s + Vec3(-122, -9, -8), s + Vec3(-130, -6, -16), Vec3(-134, -4, kBody + 2.6)},
          2.2);
  return a.take();
}

}  // namespace tact::shapes
