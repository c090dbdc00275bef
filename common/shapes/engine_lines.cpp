// Hoses and cables of the engine bay. All numbers are millimetres (Assembly).
#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"
#include "shapes/engine.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;
const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();

/// Cables side by side along the open side of the starter's place: what a straight pull must not pass.
void add_loom(Assembly& a, double radius) {
  constexpr double kY0 = -152, kFrom = 10, kTo = 376;
  for (const double x : {kFrom - 6, kTo + 6}) {
    a.block({x - 6, kY0 - 7, -294 + kSeam}, {x + 6, kY0 + 7, -28}, 2, 3, 1);
  }
  for (int i = 0; i < 9; ++i) {
    const double z = -46 - 28. * i, sway = i % 2 == 0 ? 3 : -3;
    a.cable({{kFrom + kSeam, kY0, z},
             {kFrom + 60, kY0 + sway, z - 2},
             {(kFrom + kTo) / 2, kY0 - sway, z + 2},
             {kTo - 60, kY0 + sway, z - 2},
             {kTo - kSeam, kY0, z}},
            radius);
  }
}

void add_harness(Assembly& a, double radius) {
  // From the fuses over the gearbox and along the head to the fan.
  a.bundle({{-258, 92, 100},
            {-190, 100, 140},
            {-100, 70, 160},
            {-10, 50, 134},
            {100, 47, 126},
            {200, 48, 124},
            {300, 47, 126},
            {372, 48, 122}},
           radius, 19, 0.012);
  // From the fuses down to the gearbox.
  a.bundle({{-258, 76, 52}, {-225, 92, 30}, {-200, 120, 6}, {-222, 170, -8}, {-240, 190, -14}}, radius, 7, 0.02);
  // Along the firewall.
  a.bundle({{-110, 382, 20}, {-60, 380, 30}, {100, 382, 26}, {260, 380, 30}, {420, 380, 10}, {480, 370, -40}}, radius,
           19, 0.012);
  for (int i = 0; i < 4; ++i) {  // to the coils
    const double x = 64 + 84. * i;
    a.cable(
        {{x, 160, 175}, {x + 3, 156, 190}, {x + 12, 130, 192}, {x + 18, 96, 168}, {x + 20, 76, 140}, {x + 22, 68, 128}},
        radius);
  }
  for (int i = 0; i < 5; ++i) {  // from the fuses' plugs
    const double y = -36 + 21. * i;
    a.cable({{-241, y, 64},
             {-228, y, 64},
             {-206 + 4. * i, y + 8, 50},
             {-200 + 6. * i, y + 20, 20},
             {-198 + 7. * i, 60 + 6. * i, 2}},
            radius);
  }
}

void add_hoses(Assembly& a) {
  // Intake, coolant, heater.
  a.bellows({{-20.4, -205, 130}, {-71.6, -205, 130}}, 1, 36, 6, 8.5);
  a.bellows(
      {{384, 150, 112}, {420, 150, 112}, {452, 60, 180}, {440, -90, 180}, {436, -221, 60}, {486 - kSeam, -221, 60}}, 40,
      16, 2.5, 9);
  a.pipe({{-60, -143, -10}, {140, -143, -10}, {200, -146, -4}, {420, -143, -10}, {450, -143, -40}, {450, -150, -120}},
         30, 9);
  a.pipe({{-40, 340, 112}, {60, 352, 122}, {200, 354, 122}, {390, 352, 122}, {430, 352, 60}, {470, 352, 20}}, 26, 9);
  for (int i = 0; i < 3; ++i) {  // brake and fuel lines along the firewall and the rail
    a.pipe({{-308. + 9 * i, 212, 20},
            {-308. + 9 * i, 170. + 9 * i, 20},
            {-180. - 9 * i, 170. + 9 * i, 20},
            {-180. - 9 * i, 386, 20},
            {-180. - 9 * i, 386, 64. + 10 * i},
            {500, 386, 64. + 10 * i}},
           14, 2.4);
    a.pipe({{-390, -202 - 7. * i, -300},
            {-200, -202 - 7. * i, -300},
            {-150, -202 - 7. * i, -270},
            {480, -202 - 7. * i, -270}},
           20, 2.4);
  }
  // Battery cables.
  a.cable({{-264, -103, 120}, {-264, -85, 122}, {-250, -76, 100}, {-226, -74, 20}, {-210, -60, -20}, {-190, -30, -30}},
          6);
  a.cable(
      {{-372, -103, 120}, {-372, -84, 122}, {-376, -78, 60}, {-380, -76, -60}, {-380, -90, -200}, {-380, -150, -270}},
      6);
  // Dipstick.
  a.pipe({{352, 255.5, 81}, {352, 262, 120}, {350, 280, 180}}, 20, 3);
}

}  // namespace

void add_lines(Assembly& a, const EngineBay& bay) {
  add_loom(a, bay.cable_m * 1e3 / 2);
  add_harness(a, bay.cable_m * 1e3 / 2);
  add_hoses(a);
}

}  // namespace tact::shapes
