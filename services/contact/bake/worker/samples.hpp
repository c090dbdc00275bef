#pragma once
#include <cstdint>
#include <vector>

#include "contact/bake/worker/field_bake.hpp"

namespace tact::contact {

/// Oriented points on the outside of a body, in its mesh frame: first those by area, then those that thin parts need
/// besides, then those on features.
struct SurfaceSamples {
  std::vector<Vec3> position;
  std::vector<Vec3> apart;               ///< position, moved outward where the body is thinner than the spacing, until
                                         ///< its two faces are a spacing apart: what is to be spread
  std::vector<Vec3> normal;              ///< unit, inward
  std::vector<std::uint8_t> on_feature;  ///< on a sharp edge or a corner
  std::size_t by_area = 0, on_thin_parts = 0;
  double area_m2 = 0;         ///< of the exposed surface: each of the samples by area stands for an equal part
  std::size_t buried = 0;     ///< samples dropped: inside the body, on neither side of its surface
  std::size_t no_inside = 0;  ///< samples with outside on both sides (lone sheets): the file's orientation kept
};

/// `count` random samples, uniform by area, and further ones along sharp edges (30 degrees and more, open rims) every
/// `spacing_m`, corners included, and wherever a part thinner than that has none within half of it. Which side is
/// inside is asked of the body itself (Inside::vote), never of the triangles' orientation; the orientation decides only
/// where both sides are outside. Plates get samples on both faces.
SurfaceSamples sample_surface(const Soup& soup, const SplitSoup& split, std::size_t count, double spacing_m,
                              const StageProgress& progress);

/// Spacing of `count` points in hexagonal packing on `area_m2`, and the other way round.
double packing_spacing(double area_m2, std::size_t count);
std::size_t packing_count(double area_m2, double spacing_m);

double area_of(const Mesh& mesh);

/// Order of elimination (Yuksel, "Sample Elimination for Generating Poisson Disk Sample Sets", 2015): indices of
/// `points` such that the first n of them, for any n <= count, are well spread; `count` of them (or all). `preferred`
/// points are the last to be dropped.
std::vector<std::uint32_t> spread_order(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& preferred,
                                        std::size_t count, double area_m2, const StageProgress& progress);

}  // namespace tact::contact
