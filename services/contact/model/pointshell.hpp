#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Points with unit inward normals on the surface of the tool, in T (origin at the centre of mass), as a hierarchy of
/// nested levels: a node *is* a point, and its sphere, centred at the point, bounds all points below it.
/// Structure of arrays, breadth-first: level l occupies [level_begin[l], level_begin[l+1]), children of a node are
/// contiguous in the next level. A point of level l appears once, at its own level only; the shell is all nodes.
/// Points keep rest and current arrays so that a deformable tool can refit; a rigid tool has current == rest.
struct Pointshell {
  std::vector<Eigen::Vector3f> position_T;  ///< m
  std::vector<Eigen::Vector3f> normal_T;    ///< unit, inward
  std::vector<float> radius_m;              ///< bounds every descendant; 0 for a leaf
  std::vector<std::uint32_t> child_begin;   ///< index of the first child; children end at child_end
  std::vector<std::uint32_t> child_end;
  std::vector<std::uint32_t> level_begin;  ///< size levels + 1
  std::vector<float> area_m2;              ///< surface each point stands for

  Pose X_TM;                                 ///< mesh frame in T
  Mat3 inertia_shape_m2 = Mat3::Identity();  ///< inertia of unit mass about To in T, from inside samples
  double gyration_radius_m = 0;              ///< sqrt(trace(inertia_shape) / 3): torque cap F_max * this
  double bounding_radius_m = 0;              ///< farthest point from To
  double spacing_m = 0;                      ///< largest gap of the coverage report
  std::uint64_t content_hash = 0;

  std::size_t size() const { return position_T.size(); }
};

/// Checksummed file, as DistanceField. Throw SetupError with file and reason.
void save_pointshell(const Pointshell& shell, const std::filesystem::path& path);
Pointshell load_pointshell(const std::filesystem::path& path, std::uint64_t expected_hash = 0);

}  // namespace tact::contact
