#include "shapes/shape.hpp"
#include "shapes/thread.hpp"

namespace tact::shapes {
namespace {

const ShapeParam kDiameter{"diameter_m", 0.016, 1e-6, 1e3, "nominal, of the thread"};
const ShapeParam kPitch{"pitch_m", 0.002, 1e-7, 1e3, "of the thread, along z a turn"};
const ShapeParam kSides{"sides_count", 192, 12, 4092, "columns of triangles round the axis"};

Thread thread(const Values& v) {
  return {v.at("diameter_m"), v.at("pitch_m"), v.contains("allowance_m") ? v.at("allowance_m") : 0};
}

/// A scene file of three lines must not ask for terabytes: 4 million triangles.
constexpr double kMostColumns = 5e5;

std::vector<Rule> rules(const char* width, const char* length) {
  return {{[](const Values& v) { return thread(v).root_m() > 0.2 * v.at("diameter_m"); }, "pitch_m",
           "less: a core of a fifth of the diameter must remain"},
          {[width](const Values& v) { return v.at(width) > 1.01 * v.at("diameter_m"); }, width,
           "more than 1.01 diameter_m"},
          {[](const Values& v) { return static_cast<int>(v.at("sides_count")) % 12 == 0; }, "sides_count",
           "a multiple of 12: the hexagon's corners and the middles of its flats"},
          {[length](const Values& v) { return v.at(length) / v.at("pitch_m") * v.at("sides_count") <= kMostColumns; },
           length, "less: at most 500000 turns times sides_count"}};
}

Shape bolt() {
  return {{"bolt",
           "A hexagon bolt, M16 by default: right-handed ISO thread about z from its tip at z = 0 to z = length, then "
           "the head; a flat faces +x.",
           {kDiameter,
            kPitch,
            {"allowance_m", 38e-6, 0, 1, "off all diameters of the thread: the play in a nut (ISO 965-1: 6g)"},
            {"length_m", 0.03, 1e-6, 1e3, "of the thread"},
            {"head_width_m", 0.024, 1e-6, 1e3, "across flats"},
            {"head_height_m", 0.01, 1e-6, 1e3, "along z"},
            kSides}},
          rules("head_width_m", "length_m"),
          [](const Values& v) {
            return shapes::bolt(thread(v), v.at("length_m"), v.at("head_width_m"), v.at("head_height_m"),
                                static_cast<int>(v.at("sides_count")));
          }};
}

Shape nut() {
  return {
      {"nut",
       "A hexagon nut from z = 0 to z = height with the thread of a bolt: in one frame the two are screwed together. "
       "A flat faces +x.",
       {kDiameter,
        kPitch,
        {"width_m", 0.024, 1e-6, 1e3, "across flats"},
        {"height_m", 0.013, 1e-6, 1e3, "along z"},
        kSides}},
      rules("width_m", "height_m"),
      [](const Values& v) {
        return shapes::nut(thread(v), v.at("width_m"), v.at("height_m"), static_cast<int>(v.at("sides_count")));
      }};
}

}  // namespace

std::vector<Shape> fastener_shapes() { return {bolt(), nut()}; }

}  // namespace tact::shapes
