#include "shapes/shapes.hpp"

#include <algorithm>
#include <sstream>

#include "fault/fault.hpp"
#include "fault/nearest.hpp"
#include "shapes/shape.hpp"

namespace tact {
namespace {

using shapes::Shape;
using shapes::Values;

const std::vector<Shape>& all() {
  static const std::vector<Shape> list = [] {
    std::vector<Shape> shapes;
    for (auto&& group :
         {shapes::simple_shapes(), shapes::puzzle_shapes(), shapes::fastener_shapes(), shapes::machine_shapes()}) {
      shapes.insert(shapes.end(), group.begin(), group.end());
    }
    std::sort(shapes.begin(), shapes.end(), [](const Shape& a, const Shape& b) { return a.info.name < b.info.name; });
    return shapes;
  }();
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

shapes::Values shapes::complete_values(const std::string& name, const Values& given) {
  return complete(find(name), given);
}

Mesh make_shape(const std::string& name, const std::map<std::string, double>& params) {
  const Shape& shape = find(name);
  return shape.make(complete(shape, params));
}

}  // namespace tact
