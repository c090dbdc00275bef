// Shapes of a few faces: the hard cases, one by one.
#include <cmath>
#include <numbers>

#include "shapes/shape.hpp"
#include "shapes/solids.hpp"

namespace tact::shapes {
namespace {

/// A bar along y of a section (x, z).
Mesh bar_along_y(const Outline& section, double length) {
  Mesh mesh;
  append(mesh, plate(section, {}, -length / 2, length / 2), frame(Vec3::Zero(), -Vec3::UnitY(), Vec3::UnitX()));
  return mesh;
}

int count(const Values& v, const char* name) { return static_cast<int>(v.at(name)); }

double angle(const Values& v, const char* name) { return v.at(name) * std::numbers::pi / 180; }

Shape box() {
  return {{"box",
           "A box centred at the origin.",
           {{"size_x_m", 0.1, 1e-6, 1e3, "length along x"},
            {"size_y_m", 0.1, 1e-6, 1e3, "length along y"},
            {"size_z_m", 0.1, 1e-6, 1e3, "length along z"}}},
          {},
          [](const Values& v) {
            Mesh mesh;
            const Vec3 half = Vec3(v.at("size_x_m"), v.at("size_y_m"), v.at("size_z_m")) / 2;
            add_box(mesh, -half, half);
            return mesh;
          }};
}

Shape cone() {
  return {{"cone",
           "A cone with its base in z = 0, axis z, tip at z = height.",
           {{"radius_m", 0.03, 1e-6, 1e3, "of the base"},
            {"height_m", 0.04, 1e-6, 1e3, "tip above base"},
            {"sides_count", 64, 3, 4096, "sides of the base polygon"}}},
          {},
          [](const Values& v) { return shapes::cone(count(v, "sides_count"), v.at("radius_m"), v.at("height_m")); }};
}

Shape gap() {
  return {
      {"gap",
       "Two parallel plates, floor below z = 0 and ceiling above z = gap, from x = 0 to x = length; the floor begins "
       "earlier, at x = -approach. y is centred.",
       {{"gap_m", 0.04, 1e-6, 1e3, "between floor and ceiling"},
        {"length_m", 0.08, 1e-6, 1e3, "of the gap along x"},
        {"approach_m", 0.08, 0, 1e3, "floor in front of the gap"},
        {"width_m", 0.1, 1e-6, 1e3, "along y"},
        {"plate_m", 0.01, 1e-6, 1e3, "thickness of both plates"}}},
      {},
      [](const Values& v) {
        Mesh mesh;
        const double y = v.at("width_m") / 2, x = v.at("length_m"), gap = v.at("gap_m"), plate = v.at("plate_m");
        add_box(mesh, {-v.at("approach_m"), -y, -plate}, {x, y, 0});
        add_box(mesh, {0, -y, gap}, {x, y, gap + plate});
        return mesh;
      }};
}

Shape peg() {
  return {{"peg",
           "A prism standing on z = 0, axis z; 4 sides make a square peg, 64 a round one. A flat side faces +x.",
           {{"width_m", 0.02, 1e-6, 1e3, "across flats"},
            {"height_m", 0.05, 1e-6, 1e3, "along z"},
            {"sides_count", 4, 3, 4096, "sides of the polygon"}}},
          {},
          [](const Values& v) { return prism(count(v, "sides_count"), v.at("width_m"), v.at("height_m")); }};
}

Shape socket() {
  return {{"socket",
           "A block with a blind hole for a peg: bottom of the hole z = 0, mouth z = depth, block down to z = -floor.",
           {{"hole_width_m", 0.021, 1e-6, 1e3, "across flats"},
            {"block_width_m", 0.05, 1e-6, 1e3, "across flats"},
            {"depth_m", 0.03, 1e-6, 1e3, "of the hole"},
            {"floor_m", 0.01, 1e-6, 1e3, "of the block under the hole"},
            {"sides_count", 4, 3, 4096, "sides of both polygons"}}},
          {{[](const Values& v) { return v.at("block_width_m") > v.at("hole_width_m"); }, "block_width_m",
            "more than hole_width_m"}},
          [](const Values& v) {
            return shapes::socket(count(v, "sides_count"), v.at("hole_width_m"), v.at("block_width_m"), v.at("depth_m"),
                                  v.at("floor_m"));
          }};
}

Shape two_walls() {
  return {{"two-walls",
           "Two thin walls that rise to z = 0 at x = -span/2 (wall a) and x = +span/2 (wall b). Their tops "
           "have the areas length times thickness.",
           {{"span_m", 0.08, 1e-6, 1e3, "between the middles of the walls, along x"},
            {"length_a_m", 0.1, 1e-6, 1e3, "of wall a along y"},
            {"thickness_a_m", 0.01, 1e-6, 1e3, "of wall a along x"},
            {"length_b_m", 0.007, 1e-6, 1e3, "of wall b along y"},
            {"thickness_b_m", 0.002, 1e-6, 1e3, "of wall b along x"},
            {"height_m", 0.03, 1e-6, 1e3, "of both walls"}}},
          {{[](const Values& v) { return v.at("span_m") > (v.at("thickness_a_m") + v.at("thickness_b_m")) / 2; },
            "span_m", "walls that do not touch"}},
          [](const Values& v) {
            Mesh mesh;
            const auto wall = [&](double x, double length, double thickness) {
              add_box(mesh, {x - thickness / 2, -length / 2, -v.at("height_m")}, {x + thickness / 2, length / 2, 0});
            };
            wall(-v.at("span_m") / 2, v.at("length_a_m"), v.at("thickness_a_m"));
            wall(v.at("span_m") / 2, v.at("length_b_m"), v.at("thickness_b_m"));
            return mesh;
          }};
}

Shape groove() {
  return {
      {"groove",
       "A block with a V groove along y, open upwards: its bottom line is z = 0, its walls meet there, the rims lie "
       "in z = depth.",
       {{"half_angle_deg", 15, 1, 80, "of a wall from the vertical"},
        {"depth_m", 0.04, 1e-6, 1e3, "of the groove"},
        {"length_m", 0.04, 1e-6, 1e3, "along y"},
        {"wall_m", 0.02, 1e-6, 1e3, "beside and below the groove"}}},
      {},
      [](const Values& v) {
        const double depth = v.at("depth_m"), half = depth * std::tan(angle(v, "half_angle_deg")),
                     side = half + v.at("wall_m"), floor = -v.at("wall_m");
        return bar_along_y(
            {{-side, floor}, {side, floor}, {side, depth}, {half, depth}, {0, 0}, {-half, depth}, {-side, depth}},
            v.at("length_m"));
      }};
}

Shape wedge() {
  return {
      {"wedge",
       "A bar along y with a wedge for a nose, pointing down: its sides would meet in the line z = 0, and are cut off "
       "at z = blunt.",
       {{"half_angle_deg", 15, 1, 80, "of a side from the vertical"},
        {"nose_m", 0.03, 1e-6, 1e3, "height of the wedge above z = 0"},
        {"blunt_m", 0.006, 0, 1e3, "of it cut off"},
        {"shank_m", 0.03, 1e-6, 1e3, "height of the bar above the wedge"},
        {"length_m", 0.03, 1e-6, 1e3, "along y"}}},
      {{[](const Values& v) { return v.at("blunt_m") < v.at("nose_m"); }, "blunt_m", "less than nose_m"}},
      [](const Values& v) {
        const double slope = std::tan(angle(v, "half_angle_deg")), low = v.at("blunt_m"), nose = v.at("nose_m"),
                     top = nose + v.at("shank_m");
        Outline section{{nose * slope, nose}, {nose * slope, top}, {-nose * slope, top}, {-nose * slope, nose}};
        if (low > 0) section.emplace_back(-low * slope, low);
        section.emplace_back(low * slope, low);
        return bar_along_y(section, v.at("length_m"));
      }};
}

}  // namespace

std::vector<Shape> simple_shapes() { return {box(), cone(), gap(), groove(), peg(), socket(), two_walls(), wedge()}; }

}  // namespace tact::shapes
