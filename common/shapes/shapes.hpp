#pragma once
#include <map>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace tact {

/// A number that a shape is made from. Metres, degrees where the name ends in _deg, a count where it ends in _count.
struct ShapeParam {
  std::string name;
  double value;            ///< default
  double lowest, highest;  ///< allowed
  std::string meaning;
};

struct ShapeInfo {
  std::string name;
  std::string meaning;
  std::vector<ShapeParam> params;
};

/// All shapes there are, with their parameters.
const std::vector<ShapeInfo>& all_shapes();

/// The closed surface of a shape, oriented outward, each edge shared by exactly two triangles; metres, in its own mesh
/// frame (stated by `meaning`). Parameters that are not given have their defaults. Throws SetupError "shape box:
/// size_m: found ..., expected ..." on an unknown shape or parameter, and on values that make no such solid.
Mesh make_shape(const std::string& name, const std::map<std::string, double>& params);

/// The same checks without making the mesh.
void check_shape(const std::string& name, const std::map<std::string, double>& params);

}  // namespace tact
