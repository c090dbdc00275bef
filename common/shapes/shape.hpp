#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "shapes/shapes.hpp"

namespace tact::shapes {

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

/// A shape's defaults overlaid with what was given, checked. Throws as make_shape.
Values complete_values(const std::string& name, const Values& given);

std::vector<Shape> simple_shapes();    ///< bodies of a few faces
std::vector<Shape> puzzle_shapes();    ///< the alpha
std::vector<Shape> fastener_shapes();  ///< bolt and nut
std::vector<Shape> machine_shapes();   ///< engine bay, landing gear, and what is put into them

}  // namespace tact::shapes
