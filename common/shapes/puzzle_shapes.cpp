#include <algorithm>
#include <numbers>

#include "shapes/alpha.hpp"
#include "shapes/shape.hpp"

namespace tact::shapes {
namespace {

Alpha alpha_of(const Values& v) {
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
          .sides = static_cast<int>(v.at("sides_count"))};
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

}  // namespace

Alpha alpha_from(const Values& params) { return alpha_of(complete_values("alpha", params)); }

std::vector<Shape> puzzle_shapes() { return {alpha()}; }

}  // namespace tact::shapes
