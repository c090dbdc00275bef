// Hydraulic lines and wires of the landing gear. All numbers are millimetres (Assembly).
#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"
#include "shapes/landing_gear.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;
const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();

/// Two hydraulic lines from the strut to the bogie, and wires across them between two terminal strips: a ladder that
/// leans as the actuator does when it is built in, with one wider step, the passage.
void add_ladder(Assembly& a, double passage, double wire) {
  const Vec3 middle = 1e3 * LandingGear::passage_centre();
  const Vec3 down = (LandingGear::lower_pin() - LandingGear::upper_pin()).normalized(), out = -LandingGear::approach();
  const auto at = [&](double along, double across, double outwards) -> Vec3 {
    return middle + along * down + across * kY + outwards * out;
  };
  constexpr double kLine = 8, kAcross = 98, kStep = 60, kTop = -640, kBottom = 250;
  const double radius = wire / 2, behind = -(kLine + radius + 6);  // the lines, seen from outside
  for (const double side : {-1.0, 1.0}) {
    const double y = side * kAcross;
    a.pipe({{140, y, 1730},
            {330, y, 1730},
            at(-720, y, behind),
            at(310, y, behind),
            {1010, y, 640},
            {880, y, 540},
            {764 + kSeam, y, 540}},
           90, kLine);
    const Pose strip = frame(at(kTop, side * 166, 0), down, out);
    a.add(bevelled(rounded(rectangle({-12, -7}, {12, 7}), 3, a.edge()), kBottom - kTop, 1), strip);
  }
  // The free height is measured along z: the actuator passes level.
  const double first = (passage + wire) / 2 / -down.z();
  int n = 0;
  const auto add_wire = [&](double along) {
    const Vec3 sway = (n++ % 2 == 0 ? 5 : -3) * kX;  // level: it leaves the free height as it is
    a.cable({at(along, -159 + kSeam, 0), at(along, -100, 0), at(along, -50, 0) + sway, at(along, 50, 0) - sway / 2,
             at(along, 100, 0), at(along, 159 - kSeam, 0)},
            radius);
    for (const double side : {-1.0, 1.0}) a.plug(at(along, side * 173, 0), side * kY, 8, 16);
  };
  for (double along = -first; along > kTop + 15; along -= kStep) add_wire(along);
  for (double along = first; along < kBottom - 15; along += kStep) add_wire(along);
}

void add_bundles(Assembly& a, double radius) {
  for (const double side : {-1.0, 1.0}) {  // down the strut and on to the brakes
    a.bundle({{-60, side * 210, 2470},
              {-50, side * 196, 2300},
              {-50, side * 190, 2000},
              {-70, side * 186, 1800},
              {-90, side * 190, 1600},
              {-70, side * 192, 1400},
              {-60, side * 215, 1200},
              {-40, side * 210, 1000},
              {60, side * 215, 800},
              {160, side * 218, 710},
              {195, side * 205, 655}},
             radius, 19, 0.006);
    a.bundle({{-140, side * 165, 1600},
              {-175, side * 165, 1480},
              {-215, side * 172, 1360},
              {-280, side * 182, 1160},
              {-310, side * 190, 960},
              {-300, side * 195, 800},
              {-290, side * 195, 690},
              {-290, side * 190, 655}},
             radius, 19, 0.006);
    a.bundle({{60, side * 215, 2460},
              {75, side * 200, 2300},
              {85, side * 190, 2080},
              {75, side * 180, 1900},
              {60, side * 180, 1800}},
             radius, 7, 0.01);
    for (int i = 0; i < 4; ++i) {  // lone wires beside the torsion links
      const double y = side * (104 + 9. * i);
      a.cable({{-150, y, 1440},
               {-230 - 8. * i, y, 1330},
               {-400 - 10. * i, y, 1140},
               {-520 - 10. * i, y, 940},
               {-420, y, 760},
               {-330, y, 660}},
              radius);
    }
  }
}

void add_brake_hoses(Assembly& a) {
  for (const double side : {-1.0, 1.0}) {
    for (const double across : {-1.0, 1.0}) {
      for (int i = 0; i < 3; ++i) {
        const double z = 640 + 16. * i, y = 20. * i;
        a.bellows({{side * (250 + 10. * i), across * (120 + y), z - 10},
                   {side * (300 + 10. * i), across * (130 + y), z + 60},
                   {side * (480 + 10. * i), across * (195 + y), z + 140},
                   {side * (640 + 10. * i), across * (205 + y), z + 130},
                   {side * (660 + 10. * i), across * (205 + y), 750.}},
                  50, 7, 1.2, 9);
      }
    }
  }
  // Pipes along the beam and up the strut.
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < 3; ++i) {
      const double y = side * (118 + 15. * i);
      a.pipe({{-600, y, 452. + 14 * i},
              {-190, y, 452. + 14 * i},
              {-170, side * (176 + 12. * i), 402. + 14 * i},
              {170, side * (176 + 12. * i), 402. + 14 * i},
              {190, y, 452. + 14 * i},
              {600, y, 452. + 14 * i}},
             24, 5);
      const double angle = side * (0.9 + 0.09 * i), r = 170;
      const Vec3 out(r * std::cos(angle), r * std::sin(angle), 0);
      a.pipe({out + 2430 * kZ, out + 1790 * kZ, 1.08 * out + 1760 * kZ, 1.08 * out + 1700 * kZ, out + 1670 * kZ,
              out + 1360 * kZ},
             16, 5);
    }
  }
}

}  // namespace

void add_gear_lines(Assembly& a, const LandingGear& gear) {
  add_ladder(a, gear.passage_m * 1e3, gear.wire_m * 1e3);
  add_bundles(a, gear.wire_m * 1e3 / 2);
  add_brake_hoses(a);
}

}  // namespace tact::shapes
