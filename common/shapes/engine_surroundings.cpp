// What stands about the engine. All numbers are millimetres (Assembly).
#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"
#include "shapes/engine.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;
const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();

/// Sheet metal with lightening holes: firewall and tray. The bay is as long as they are.
void add_sheets(Assembly& a) {
  std::vector<Outline> holes;
  for (int i = 0; i < 9; ++i) holes.push_back(circle(20, a.sides(20), {-340. + 100 * i, -200}));
  for (int i = 0; i < 10; ++i) holes.push_back(circle(8, a.sides(8), {-390. + 100 * i, -120}));
  holes.push_back(rounded(rectangle({-120, -60}, {60, 40}), 15, a.edge()));
  // In (x, z): thickness along -y.
  a.add(
      plate(rounded({{-400, -300}, {520, -300}, {520, 60}, {440, 120}, {-400, 120}}, 30, a.edge()), holes, -400, -398),
      frame(Vec3::Zero(), -kY, kX));
  for (int i = 0; i < 8; ++i) {  // beads of the firewall
    a.block({-300. + 70 * i, 392.5, 52}, {-290. + 70 * i, 398 - kSeam, 110}, 1, 4, 1.5);
  }
  std::vector<Outline> slots;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 2; ++j) {
      slots.push_back(rounded(rectangle({60. + 48 * i, -70. + 60 * j}, {90. + 48 * i, -40. + 60 * j}), 8, a.edge()));
    }
  }
  // Tray below the starter, two voxels thick, its rim turned up.
  a.add(plate(rounded(rectangle({24, -118}, {372, 48}), 12, a.edge()), slots, -282, -280.2), Pose{});
  a.block({24, -120, -282}, {372, -118 - kSeam, -268}, 1, 4, 0.3);
}

void add_rails(Assembly& a) {
  a.block({-400, -196, -352}, {520, -136, -294}, 0, 9, 3);
  a.block({-400, 330, -400}, {520, 388, -346}, 0, 9, 3);
  for (int i = 0; i < 9; ++i) {
    a.bolt({-360. + 100 * i, -166, -294}, kZ, 10);
    a.bolt({-310. + 100 * i, 359, -346}, kZ, 10);
  }
  a.block({428, -136 + kSeam, -350}, {464, 330 - kSeam, -312}, 1, 8, 3);
  // Engine mount: a rubber between two plates on the rail.
  for (const Vec3& at : {Vec3(-360, 359, -346 + kSeam), Vec3(340, 359, -346 + kSeam)}) {
    Outline rubber{{0, 0}, {26, 0}};
    for (int i = 0; i < 4; ++i) rubber.insert(rubber.end(), {{26, 2. + 9 * i}, {21, 5. + 9 * i}, {26, 9. + 9 * i}});
    rubber.insert(rubber.end(), {{26, 40}, {0, 40}});
    a.turned(rubber, frame(at, kZ), 0.8);
  }
}

/// Radiator of flat tubes between two tanks, fan in front of it.
void add_radiator(Assembly& a) {
  a.block({486, -236, -290}, {518, -206, 120}, 2, 8, 3);
  a.block({486, 306, -290}, {518, 336, 120}, 2, 8, 3);
  for (int i = 0; i < 20; ++i) {
    a.block({492, -206 + kSeam, -284. + 20 * i}, {512, 306 - kSeam, -280. + 20 * i}, 1, 1.9, 0.2);
  }
  a.turned({{0, 0.1}, {18, 0.1}, {12, 4}, {16, 6}, {16, 16}, {0, 18}}, frame({502, -221, 120}, kZ), 1);
  const Vec3 hub(448, 50, -96);
  a.turned({{0, 0}, {34, 0}, {38, 4}, {38, 22}, {30, 28}, {0, 30}}, frame(hub - 14 * kX, kX), 2);
  a.turned({{178, -14}, {186, -14}, {186, 20}, {181, 24}, {178, 20}}, frame(hub, kX), 0.8);
  for (int blade = 0; blade < 7; ++blade) {
    const double at = 2 * std::numbers::pi * blade / 7;
    const Vec3 out(0, std::cos(at), std::sin(at)), along(0, -std::sin(at), std::cos(at));
    std::vector<std::vector<Vec3>> rings;
    for (int i = 0; i <= 16; ++i) {  // a twisted blade, 2.4 mm thick
      const double r = 38.6 + (176.5 - 38.6) * i / 16, pitch = 0.95 - 0.028 * i, half = 13 + 0.9 * i;
      const Vec3 chord = std::cos(pitch) * kX + std::sin(pitch) * along, thick = out.cross(chord);
      std::vector<Vec3> ring;
      for (int k = 0; k < 24; ++k) {
        const double angle = 2 * std::numbers::pi * k / 24, c = std::cos(angle);
        ring.emplace_back(hub + r * out + half * c * chord + (1.2 * std::sin(angle) + 0.9 * (1 - c * c)) * thick);
      }
      rings.push_back(std::move(ring));
    }
    a.add(loft(rings));
  }
}

void add_boxes(Assembly& a) {
  // Battery on its tray, with terminals.
  a.block({-398, -258, -46}, {-238, -92, -40}, 2, 8, 1);
  a.block({-394, -254, -40 + kSeam}, {-242, -96, 92}, 2, 6, 2);
  a.block({-396, -256, 92 + kSeam}, {-240, -94, 112}, 2, 8, 3);
  for (const double x : {-372.0, -264.0}) {
    a.turned({{0, 0.1}, {9, 0.1}, {8, 16}, {0, 16}}, frame({x, -120, 112}, kZ), 0.8);
    a.turned({{9.4, 3}, {15, 3}, {15, 12}, {9.4, 12}}, frame({x, -120, 112}, kZ), 0.8);
  }
  for (int i = 0; i < 6; ++i) {
    a.turned({{0, 0.1}, {10, 0.1}, {10, 3}, {4, 4}, {0, 4}}, frame({-375. + 23 * i, -200, 112}, kZ), 0.5);
  }
  // Air box, ribbed, with clips.
  a.block({-226, -256, 50}, {-72, -124, 120}, 2, 16, 3);
  a.block({-226, -256, 120 + kSeam}, {-72, -124, 196}, 2, 16, 6);
  for (int i = 0; i < 9; ++i) a.block({-208. + 15 * i, -242, 196 + kSeam}, {-204. + 15 * i, -138, 201}, 2, 1.5, 0.6);
  for (int i = 0; i < 4; ++i) a.block({-206. + 36 * i, -124 + kSeam, 106}, {-192. + 36 * i, -120, 136}, 1, 2, 0.6);
  // Fuses, with plugs along the side.
  a.block({-398, -52, 40}, {-262, 64, 88}, 2, 8, 2);
  a.block({-394, -48, 88 + kSeam}, {-266, 60, 112}, 2, 10, 4);
  for (int i = 0; i < 5; ++i) a.plug({-262, -36. + 21 * i, 64}, kX, 8, 20);
  // Brake booster and master cylinder before the firewall.
  const Pose booster = frame({-296, 391, 40}, -kY);
  a.turned({{0, 0}, {60, 0}, {80, 22}, {84, 26}, {84, 36}, {80, 40}, {70, 66}, {40, 84}, {0, 84}}, booster, 4);
  a.turned({{0, 84.2}, {22, 84.2}, {22, 92}, {17, 94}, {17, 170}, {12, 178}, {0, 178}}, booster, 1.5);
  a.block({-324, 222, 58}, {-268, 292, 100}, 2, 10, 4);
  a.turned({{0, 0.1}, {16, 0.1}, {17, 4}, {17, 14}, {0, 15}}, frame({-296, 257, 100}, kZ), 1);
  // Coolant and washer bottles.
  a.turned({{0, 0}, {52, 0}, {58, 14}, {58, 74}, {50, 92}, {22, 104}, {22, 110}, {0, 110}}, frame({452, 240, 130}, kZ),
           6);
  a.turned({{0, 110.2}, {27, 110.2}, {27, 124}, {20, 128}, {0, 128}}, frame({452, 240, 130}, kZ), 1.5);
  // Strut tower, domed, with its nuts.
  const Pose tower = frame({-150, 316, 44}, kZ);
  a.turned({{0, 0}, {66, 0}, {66, 4}, {60, 8}, {50, 92}, {40, 100}, {0, 100}}, tower, 4);
  a.bolt({-150, 316, 144}, kZ, 20, true);
  for (int i = 0; i < 3; ++i) {
    const double angle = 0.6 + 2 * std::numbers::pi * i / 3;
    a.bolt({-150 + 31 * std::cos(angle), 316 + 31 * std::sin(angle), 144}, kZ, 8, true);
  }
}

}  // namespace

void add_surroundings(Assembly& a, const EngineBay&) {
  add_sheets(a);
  add_rails(a);
  add_radiator(a);
  add_boxes(a);
}

}  // namespace tact::shapes
