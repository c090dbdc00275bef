// The engine itself. All numbers are millimetres (Assembly).
#include "shapes/engine.hpp"

#include <cmath>
#include <numbers>

#include "shapes/assembly.hpp"

namespace tact::shapes {
namespace {

constexpr double kSeam = Assembly::kSeam_mm;
const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();
const Vec3 kCrank(0, 160, -150);       // a point of the crankshaft's axis
const Vec3 kMouth(0, -20, -190);       // EngineBay::starter_mouth
const Vec3 kPassage(210, -40, 20);     // EngineBay::passage_centre
constexpr double kRoll_deg = 130;      // EngineBay::starter_roll_rad
constexpr double kRunner = 22;         // radius of an inlet pipe
constexpr double kCylinderPitch = 74;  // between inlet pipes, but for the passage

/// Outlines in the plane across the crankshaft are (y, z); this frame extrudes them along x.
Pose across_crank(double x) { return frame({x, 0, 0}, kX, kY); }

/// Inlet pipes' x: two and two, the passage between them.
std::array<double, 4> inlets(double passage_m) {
  const double half = passage_m * 1e3 / 2 + kRunner, x = kPassage.x();
  return {x - half - kCylinderPitch, x - half, x + half, x + half + kCylinderPitch};
}

void add_block(Assembly& a) {
  const Outline skirt{{66, -290},   {254, -290}, {254, -226}, {262, -210}, {262, -34},
                      {254, -20.1}, {66, -20.1}, {58, -34},   {58, -210},  {66, -226}};
  a.add(bevelled(rounded(skirt, 6, a.edge()), 380 - kSeam, 2.5), across_crank(kSeam));
  for (int i = 0; i < 9; ++i) {  // ribs and core plugs on the starter's side
    const double x = 30 + 40 * i;
    a.block({x - 2.5, 50, -204}, {x + 2.5, 58 - kSeam, -40}, 1, 2, 0.8);
    if (i % 2 == 0) continue;
    for (const double z : {-165.0, -85.0}) {
      a.turned({{0, 0}, {14, 0}, {14, 3}, {11, 3}, {10, 1.2}, {0, 1.2}}, frame({x + 20, 58 - kSeam, z}, -kY));
    }
  }
  for (int i = 0; i < 8; ++i) {  // the other side
    a.block({40 + 40. * i, 262 + kSeam, -204}, {45 + 40. * i, 270, -40}, 1, 2, 0.8);
  }
  // Oil pan and its flange.
  a.block({3, 60, -296}, {377, 260, -290 - kSeam}, 2, 12, 0.5);
  a.block({20, 84, -352}, {360, 236, -296 - kSeam}, 2, 25, 4);
  for (int i = 0; i < 12; ++i) {
    for (const double y : {71.0, 249.0}) a.bolt({16 + 31.6 * i, y, -296}, -kZ, 6);
  }
  a.bolt({60, 160, -352}, -kZ, 14);
}

void add_head(Assembly& a) {
  a.block({4, 62, -20}, {376, 258, 80}, 2, 8, 1.5);
  a.block({8, 70, 80 + kSeam}, {372, 250, 85}, 2, 14, 0.5);
  a.block({16, 86, 85 + kSeam}, {364, 234, 140}, 2, 26, 6);
  for (int i = 0; i < 8; ++i) {
    for (const double y : {77.5, 242.5}) a.bolt({30 + 45.7 * i, y, 85}, kZ, 5);
  }
  for (int i = 0; i < 11; ++i) {  // ribs of the cover, in two rows beside the coils
    for (const double y : {96.0, 188.0}) {
      a.block({40 + 30. * i, y, 140 + kSeam}, {43.5 + 30. * i, y + 36, 144}, 2, 1.5, 0.5);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const double x = 64 + 84. * i;
    a.block({x - 14, 142, 140 + kSeam}, {x + 14, 178, 158}, 2, 6, 1.5);
    a.plug({x, 160, 158}, kZ, 9, 16);
  }
  Outline cap{{0, 0}, {22, 0}, {22, 4}, {25, 6}, {25, 16}, {22, 19}, {9, 19}, {8, 16}, {0, 16}};
  a.turned(cap, frame({340, 210, 144.2}, kZ), 1);
}

void add_gearbox(Assembly& a) {
  // Front plate: round the crankshaft and round the starter's nose.
  const double roll = kRoll_deg * std::numbers::pi / 180;
  const Vec2 mouth(kMouth.y(), kMouth.z()), crank(kCrank.y(), kCrank.z()),
      ear = 46 * Vec2(std::cos(roll), std::sin(roll));
  a.add(plate(link(crank, 230, mouth, 62, a.edge()),
              {circle(27, a.sides(27), mouth), circle(4.6, 16, mouth + ear), circle(4.6, 16, mouth - ear),
               circle(40, a.sides(40), crank)},
              -12, -kSeam),
        across_crank(0));
  const Pose back = frame(kCrank, -kX, kY);  // z: towards the gearbox, from the plate's plane
  a.turned({{207, 12.1},
            {230, 12.1},
            {230, 22},
            {214, 22},
            {214, 60},
            {120, 190},
            {60, 190},
            {60, 183},
            {116, 183},
            {207, 57}},
           back, 2);
  for (int i = 0; i < 18; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / 18;
    const Vec3 out = back.q * Vec3(std::cos(angle), std::sin(angle), 0);
    // Outline in (along the axis, outwards): x of this frame is the box's axis, y outwards.
    a.add(plate({{66, 212}, {184, 126.7}, {186, 138}, {70, 224}}, {}, -2.5, 2.5), frame(kCrank, (-kX).cross(out), -kX));
    if (i % 2 == 0) a.bolt(kCrank - 22 * kX + 222.5 * out, -kX, 5);
  }
  a.add(plate(gear(118, 163.4, 167.4), {circle(147, 118)}, 32, 44), back);
  a.turned({{0, 14}, {60, 14}, {64, 26}, {120, 30}, {146.8, 30}, {146.8, 45}, {130, 47}, {60, 50}, {0, 50}}, back, 2);
  Outline ribbed{{0, 190.2}, {100, 190.2}};
  for (int i = 0; i < 11; ++i) {
    const double z = 198 + 17 * i, r = 116 - 1.2 * i;
    ribbed.insert(ribbed.end(), {{r, z}, {r + 9, z + 1.5}, {r + 9, z + 5}, {r, z + 6.5}});
  }
  ribbed.insert(ribbed.end(), {{96, 388}, {40, 396}, {0, 396}});
  a.turned(ribbed, back);
  // Drive shafts with their boots.
  for (const double side : {-1.0, 1.0}) {
    const Vec3 out = side * kY, at(-300, 160 + side * 126, -150);
    a.turned({{0, 0}, {48, 0}, {48, 10}, {40, 18}, {0, 18}}, frame(at, out), 2);
    a.bellows({at + 18.2 * out, at + 92 * out}, 1, 27, 9, 12);
    a.bar(at + 92.2 * out, at + (side < 0 ? 250. : 92 + 2.) * out, 13);
  }
}

void add_belt_drive(Assembly& a) {
  struct Pulley {
    Vec2 at;
    double radius;
    bool nut;
  };
  const Pulley pulleys[] = {
      {{160, -150}, 74, true}, {{292, -196}, 52, true}, {{306, 52}, 33, true}, {{136, 24}, 56, true}};
  Outline around, within;
  for (const Pulley& p : pulleys) {
    const Vec3 at(0, p.at.x(), p.at.y());
    Outline profile{{0, 392}, {p.radius - 20, 392}, {p.radius - 14, 386}, {p.radius, 386}};
    for (int i = 0; i < 6; ++i) {  // grooves
      const double z = 388 + 3.6 * i;
      profile.insert(profile.end(), {{p.radius, z}, {p.radius - 2.5, z + 1.8}, {p.radius, z + 3}});
    }
    profile.insert(profile.end(), {{p.radius, 412}, {p.radius - 14, 412}, {p.radius - 20, 402}, {0, 402}});
    a.turned(profile, frame(at, kX));
    if (p.nut) a.bolt(at + 402 * kX, kX, p.radius > 40 ? 14 : 8, true);
    a.bar(at + (380 + kSeam) * kX, at + (392 - kSeam) * kX, p.radius * 0.4);
    const int n = std::max(160, a.sides(p.radius));
    for (const Vec2& q : circle(p.radius + 0.5, n, p.at)) within.push_back(q);
    for (const Vec2& q : circle(p.radius + 5, n, p.at)) around.push_back(q);
  }
  a.add(plate(convex_hull(around), {convex_hull(within)}, 388, 410), across_crank(0));
  // Alternator and compressor behind their pulleys, beside the block on the exhaust side.
  for (const auto& [at, radius, back] :
       {std::tuple{Vec3(380, 306, 52), 44., 60.}, std::tuple{Vec3(380, 292 + 34, -196), 46., 120.}}) {
    Outline body{{0, 0.1}, {radius * 0.4, 0.1}, {radius - 8, 5}, {radius, 12}};
    for (double z = 14; z < back - 18; z += 7) {
      body.insert(body.end(), {{radius, z}, {radius - 3, z + 1}, {radius - 3, z + 4}, {radius, z + 5}});
    }
    body.insert(body.end(), {{radius, back - 12}, {radius - 10, back}, {0, back}});
    a.turned(body, frame(at - kSeam * kX, -kX), 0.6);
    for (int i = 0; i < 3; ++i) {
      const double angle = 0.4 + 2 * std::numbers::pi * i / 3;
      a.bolt(at + Vec3(-back - kSeam, (radius - 20) * std::cos(angle), (radius - 20) * std::sin(angle)), -kX, 6);
    }
  }
}

void add_inlet(Assembly& a, double passage_m) {
  for (const double x : inlets(passage_m)) {
    const Pose port = frame({x, 62 - kSeam, 20}, -kY, kX);
    a.add(plate(link({-30, -12}, 11, {30, 12}, 11, a.edge()), {}, 0, 0.8), port);  // gasket
    a.add(plate(convex_hull([&] {
                  Outline all = link({-29, -12}, 10, {29, 12}, 10, a.edge());
                  for (const Vec2& p : circle(kRunner + 4, a.sides(kRunner))) all.push_back(p);
                  return all;
                }()),
                {}, 0.9, 7),
          port);
    a.bolt(port * Vec3(-29, -12, 7), -kY, 6, true);
    a.bolt(port * Vec3(29, 12, 7), -kY, 6, true);
    a.pipe({{x, 54.8, 20}, {x, -70, 20}, {x, -108, 130}, {x, -159.8, 130}}, 46, kRunner);
    a.turned({{kRunner + 0.2, 0}, {kRunner + 3, 0}, {kRunner + 3, 9}, {kRunner + 0.2, 9}}, frame({x, -139, 130}, -kY),
             0.8);
  }
  // Plenum and throttle.
  a.block({30, -250, 88}, {390, -160, 172}, 0, 26, 5);
  for (int i = 0; i < 12; ++i) a.block({52. + 28 * i, -236, 172 + kSeam}, {56. + 28 * i, -174, 177}, 2, 1.5, 0.6);
  for (int i = 0; i < 10; ++i) a.block({52. + 34 * i, -255, 104}, {56. + 34 * i, -250 - kSeam, 156}, 1, 1.5, 0.6);
  a.turned({{0, 0.1}, {44, 0.1}, {44, 8}, {35, 10}, {35, 40}, {38, 42}, {38, 50}, {0, 50}}, frame({30, -205, 130}, -kX),
           1.5);
  a.block({-14, -160, 112}, {20, -142, 150}, 1, 5, 1.5);
  // Fuel rail with injectors.
  a.bar({40, 34, 80}, {384, 34, 80}, 8);
  for (const double x : inlets(passage_m)) {
    a.bar({x, 38.3, 72.8}, {x, 48.4, 55.7}, 5);
    a.plug({x, 34, 88}, kZ, 6, 15);
  }
}

void add_exhaust(Assembly& a) {
  const Vec3 collector(166, 316, -150);
  for (int i = 0; i < 4; ++i) {
    const double x = 58 + 72. * i, to = collector.x() + (i - 1.5) * 37;
    const Pose port = frame({x, 258 + kSeam, 24}, kY, kX);
    a.add(plate(convex_hull([&] {
                  Outline all = link({-25, 0}, 9, {25, 0}, 9, a.edge());
                  for (const Vec2& p : circle(21, a.sides(21))) all.push_back(p);
                  return all;
                }()),
                {}, 0, 7),
          port);
    a.bolt(port * Vec3(-25, 0, 7), kY, 6, true);
    a.bolt(port * Vec3(25, 0, 7), kY, 6, true);
    a.pipe({{x, 265.2, 24}, {x, 304, 24}, {to, collector.y(), -70}, {to, collector.y(), -129.8}}, 26, 16);
  }
  a.block({collector.x() - 80, 296, -168}, {collector.x() + 80, 336, -130}, 2, 12, 3);
  a.pipe({{166, 316, -168.2}, {166, 316, -215}, {120, 316, -268}, {20, 316, -268}}, 30, 18);
  // Heat shield: a bent sheet, two voxels thick.
  const auto bent = [](int i) { return 352 - 40 * std::pow(std::cos(0.065 * i), 8) + 0.02 * i * i; };
  Outline sheet;
  for (int i = 0; i <= 24; ++i) sheet.emplace_back(bent(i), 70 - 8.6 * i);
  for (int i = 24; i >= 0; --i) sheet.emplace_back(bent(i) + 1.8, 70.5 - 8.6 * i);
  a.add(plate(sheet, {}, 24, 250), across_crank(0));
}

}  // namespace

Vec3 EngineBay::passage_centre() { return 1e-3 * kPassage; }
Vec3 EngineBay::starter_mouth() { return 1e-3 * kMouth; }
double EngineBay::starter_roll_rad() { return kRoll_deg * std::numbers::pi / 180; }

void add_engine(Assembly& a, const EngineBay& bay) {
  add_block(a);
  add_head(a);
  add_gearbox(a);
  add_belt_drive(a);
  add_inlet(a, bay.passage_m);
  add_exhaust(a);
}

Mesh EngineBay::mesh() const {
  Assembly a(edge_m * 1e3);
  add_engine(a, *this);
  add_surroundings(a, *this);
  add_lines(a, *this);
  return a.take();
}

}  // namespace tact::shapes
