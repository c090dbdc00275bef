#include "shapes/shapes.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <sstream>

#include "fault/fault.hpp"
#include "fault/nearest.hpp"
#include "shapes/alpha.hpp"
#include "shapes/solids.hpp"

namespace tact {
namespace {

using Values = std::map<std::string, double>;

struct Rule {
  std::function<bool(const Values&)> holds;
  std::string key, expected;
};

/// A shape: what users read, what must hold between its parameters, and how it is made.
struct Shape {
  ShapeInfo info;
  std::vector<Rule> rules;
  std::function<Mesh(const Values&)> make;
};

int count(const Values& v, const char* name) { return static_cast<int>(v.at(name)); }

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
            shapes::add_box(mesh, -half, half);
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
        shapes::add_box(mesh, {-v.at("approach_m"), -y, -plate}, {x, y, 0});
        shapes::add_box(mesh, {0, -y, gap}, {x, y, gap + plate});
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
          [](const Values& v) { return shapes::prism(count(v, "sides_count"), v.at("width_m"), v.at("height_m")); }};
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
              shapes::add_box(mesh, {x - thickness / 2, -length / 2, -v.at("height_m")},
                              {x + thickness / 2, length / 2, 0});
            };
            wall(-v.at("span_m") / 2, v.at("length_a_m"), v.at("thickness_a_m"));
            wall(v.at("span_m") / 2, v.at("length_b_m"), v.at("thickness_b_m"));
            return mesh;
          }};
}

shapes::Alpha alpha_of(const Values& v) {
  constexpr double kRadPerDeg = std::numbers::pi / 180;
  return {.diameter_m = v.at("diameter_m"),
          .gap_m = v.at("gap_m"),
          .crossing_half_rad = v.at("crossing_half_deg") * kRadPerDeg,
          .tip_half_rad = v.at("tip_half_deg") * kRadPerDeg,
          .strand_m = v.at("strand_m"),
          .leg_m = v.at("leg_m"),
          .side_radius_m = v.at("side_radius_m"),
          .tip_radius_m = v.at("tip_radius_m"),
          .pinch_m = v.at("pinch_m"),
          .pinch_length_m = v.at("pinch_length_m"),
          .sides = count(v, "sides_count")};
}

Shape alpha() {
  const auto at_least_half = [](const char* radius) {
    return [radius](const Values& v) { return v.at(radius) > v.at("diameter_m") / 2; };
  };
  return {{"alpha",
           "The alpha of the puzzle: a tube that crosses itself between two legs (-x) and a tapered loop (+x). Origin "
           "between the strands at the crossing, z across the gap.",
           {{"diameter_m", 0.0125, 1e-6, 1e3, "of the tube"},
            {"gap_m", 0.0144, 1e-6, 1e3, "between the strands at the crossing"},
            {"crossing_half_deg", 32, 10, 60, "half the angle at which strands cross"},
            {"tip_half_deg", 22.5, 10, 60, "half the angle at which flanks meet"},
            {"strand_m", 0.066, 1e-6, 1e3, "straight, from crossing to side bend"},
            {"leg_m", 0.098, 1e-6, 1e3, "straight, from crossing to free end"},
            {"side_radius_m", 0.025, 1e-6, 1e3, "of the side bends' centre line"},
            {"tip_radius_m", 0.0074, 1e-6, 1e3, "of the tip's centre line"},
            {"pinch_m", 0.007, 0, 1e3, "rise of the strands away from the crossing"},
            {"pinch_length_m", 0.04, 1e-6, 1e3, "distance from the crossing at which it is reached"},
            {"sides_count", 12, 3, 256, "of the tube's polygon; 84 triangles each"}}},
          {{at_least_half("side_radius_m"), "side_radius_m", "more than half of diameter_m"},
           {at_least_half("tip_radius_m"), "tip_radius_m", "more than half of diameter_m"},
           {[](const Values& v) { return v.at("pinch_length_m") < std::min(v.at("strand_m"), v.at("leg_m")); },
            "pinch_length_m", "less than strand_m and leg_m"},
           {[](const Values& v) { return alpha_of(v).flank_m() > 0; }, "strand_m", "a loop wide enough for its tip"}},
          [](const Values& v) { return alpha_of(v).mesh(); }};
}

const std::vector<Shape>& all() {
  static const std::vector<Shape> list{alpha(), box(), cone(), gap(), peg(), socket(), two_walls()};
  return list;
}

std::string shortest(double x) {
  std::ostringstream out;
  out << x;
  return out.str();
}

[[noreturn]] void refuse(const std::string& where, const std::string& found, const std::string& expected) {
  throw SetupError(where + ": found " + found + ", expected " + expected);
}

const Shape& find(const std::string& name) {
  std::vector<std::string> names;
  std::string expected = "one of";
  for (const auto& shape : all()) {
    if (shape.info.name == name) return shape;
    names.push_back(shape.info.name);
    expected += " " + shape.info.name;
  }
  if (const auto near = nearest(name, names)) expected += "; did you mean " + *near + "?";
  std::string found = "\"";
  found += name;
  refuse("shape", found + "\"", expected);
}

/// Defaults overlaid with what was given, checked.
Values complete(const Shape& shape, const Values& given) {
  const std::string where = "shape " + shape.info.name + ": ";
  Values values;
  std::vector<std::string> names;
  for (const auto& p : shape.info.params) {
    values[p.name] = p.value;
    names.push_back(p.name);
  }
  for (const auto& [name, value] : given) {
    const auto p = std::find_if(shape.info.params.begin(), shape.info.params.end(),
                                [&n = name](const ShapeParam& q) { return q.name == n; });
    if (p == shape.info.params.end()) {
      std::string expected = "one of";
      for (const auto& n : names) expected += " " + n;
      if (const auto near = nearest(name, names)) expected += "; did you mean " + *near + "?";
      refuse(where + name, "this unknown parameter", expected);
    }
    const bool whole = name.ends_with("_count");
    if (!(value >= p->lowest && value <= p->highest) || (whole && value != static_cast<int>(value))) {
      refuse(where + name, shortest(value),
             std::string(whole ? "a whole number from " : "a number from ") + shortest(p->lowest) + " to " +
                 shortest(p->highest) + " (" + p->meaning + ")");
    }
    values[name] = value;
  }
  for (const auto& rule : shape.rules) {
    if (!rule.holds(values)) refuse(where + rule.key, shortest(values.at(rule.key)), rule.expected);
  }
  return values;
}

}  // namespace

const std::vector<ShapeInfo>& all_shapes() {
  static const std::vector<ShapeInfo> infos = [] {
    std::vector<ShapeInfo> list;
    for (const auto& shape : all()) list.push_back(shape.info);
    return list;
  }();
  return infos;
}

void check_shape(const std::string& name, const std::map<std::string, double>& params) { complete(find(name), params); }

shapes::Alpha shapes::alpha_from(const std::map<std::string, double>& params) {
  return alpha_of(complete(find("alpha"), params));
}

Mesh make_shape(const std::string& name, const std::map<std::string, double>& params) {
  const Shape& shape = find(name);
  return shape.make(complete(shape, params));
}

}  // namespace tact
