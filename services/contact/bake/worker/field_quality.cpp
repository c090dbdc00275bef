#include "contact/bake/worker/field_quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "contact/bake/worker/opposite_face.hpp"
#include "contact/bake/worker/parallel.hpp"
#include "contact/bake/worker/union_find.hpp"

namespace tact::contact {
namespace {

void measure_error(const FieldParts& parts, const DistanceField& field, const SplitSoup& split,
                   const StageProgress& progress, FieldQuality& report) {
  std::vector<std::array<int, 3>> blocks;
  for (int z = 0; z < parts.grid.blocks[2]; ++z) {
    for (int y = 0; y < parts.grid.blocks[1]; ++y) {
      for (int x = 0; x < parts.grid.blocks[0]; ++x) {
        const CoarseEntry& entry = parts.coarse[parts.grid.block_index(x, y, z)];
        if (entry.stored() && !entry.doubtful()) blocks.push_back({x, y, z});
      }
    }
  }
  if (blocks.empty()) return;
  constexpr std::size_t kSamples = 20000;
  std::vector<float> errors(kSamples, std::numeric_limits<float>::quiet_NaN());
  std::atomic<std::size_t> mismatches = 0;
  parallel_stage("error", kSamples, progress, [&](std::size_t i) {
    std::mt19937 random(static_cast<unsigned>(i));
    std::uniform_real_distribution<double> cell(0, kBlockCells);
    const auto& b = blocks[std::uniform_int_distribution<std::size_t>(0, blocks.size() - 1)(random)];
    const Vec3 p = parts.grid.corner_O(kBlockCells * b[0], kBlockCells * b[1], kBlockCells * b[2]) +
                   parts.grid.voxel_m * Vec3(cell(random), cell(random), cell(random));
    const auto sample = field.sample(p);
    if (!sample.in_band) return;
    const double exact = split.signed_distance(p);
    if (std::fabs(exact) > 0.1 * parts.grid.voxel_m && (exact < 0) != (sample.value_m < 0) &&
        std::fabs(exact - sample.value_m) > parts.grid.voxel_m) {
      ++mismatches;
      return;
    }
    errors[i] = static_cast<float>(std::fabs(exact - sample.value_m));
  });
  double squares = 0;
  for (const float e : errors) {
    if (std::isnan(e)) continue;
    ++report.error_samples;
    report.error_largest_m = std::max(report.error_largest_m, static_cast<double>(e));
    squares += static_cast<double>(e) * static_cast<double>(e);
  }
  if (report.error_samples > 0) report.error_rms_m = std::sqrt(squares / static_cast<double>(report.error_samples));
  report.sign_mismatches = mismatches;
}

/// A random place on a triangle.
Vec3 place_on(const Surface& surface, std::uint32_t t, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  double u = unit(random), v = unit(random);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Triangle& triangle = surface.triangle(t);
  return surface.middle() + Vec3(triangle.corner[0]) + u * Vec3(triangle.edge[0]) - v * Vec3(triangle.edge[2]);
}

/// Not so flat that its normal is noise of the corners' rounding.
bool has_normal(const Surface& surface, std::uint32_t t) {
  const Triangle& triangle = surface.triangle(t);
  double longest = 0;
  for (const auto& edge : triangle.edge) longest = std::max(longest, Vec3(edge).norm());
  return Vec3(triangle.normal).norm() > 1e-5 * surface.size() * longest;
}

/// Random points of the boundary that have no inside, or no outside, near them.
void measure_thinness(const SplitSoup& split, const DistanceField& field, FieldQuality& quality) {
  std::vector<double> area;
  for (const Surface* surface : {&split.solid, &split.sheets}) {
    for (std::uint32_t t = 0; t < surface->size_in_triangles(); ++t) {
      const Triangle& triangle = surface->triangle(t);
      area.push_back(Vec3(triangle.normal[0], triangle.normal[1], triangle.normal[2]).norm());
    }
  }
  std::discrete_distribution<std::uint32_t> pick(area.begin(), area.end());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kSamples = 5000;
  const std::uint32_t solids = split.solid.size_in_triangles();
  const double h = field.voxel_m();
  int no_inside = 0, no_outside = 0;
  for (int i = 0; i < kSamples; ++i) {
    const std::uint32_t t = pick(random);
    const bool plate = t >= solids;
    const Surface& surface = plate ? split.sheets : split.solid;
    const Triangle& triangle = surface.triangle(plate ? t - solids : t);
    Vec3 p = place_on(surface, plate ? t - solids : t, random);
    const Vec3 n = Vec3(triangle.normal).normalized();
    if (plate) p += split.half_thickness_m * (unit(random) < 0.5 ? n : -n);
    bool inside = false, outside = false;
    for (const double s : {-1.5, -1.0, -0.6, -0.3, 0.3, 0.6, 1.0, 1.5}) {
      const double value = field.sample(p + s * h * n).value_m;
      inside = inside || value < -0.01 * h;
      outside = outside || value > 0.01 * h;
    }
    no_inside += inside ? 0 : 1;
    no_outside += outside ? 0 : 1;
  }
  quality.surface_without_inside = static_cast<double>(no_inside) / kSamples;
  quality.surface_without_outside = static_cast<double>(no_outside) / kSamples;
}

/// The thinnest wall and the narrowest gap seen from samples: half of them anywhere by area, half spread over the
/// triangles, so that a thin part is seen however small its share of the surface.
void measure_walls(const SplitSoup& split, const StageProgress& progress, FieldQuality& quality) {
  constexpr std::size_t kSamples = 8000;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::mutex mutex;
  double wall = split.sheets.empty() ? kInfinity : 2 * split.half_thickness_m, gap = kInfinity;
  const auto room_m = [&](const Vec3& p, const Vec3& outward) {  // to the next solid or plate
    const double to_solid = opposite_face_m(split.solid, p, outward),
                 to_plate = opposite_face_m(split.sheets, p, outward) - split.half_thickness_m;
    return to_plate > 0 ? std::min(to_solid, to_plate) : to_solid;
  };
  const auto see = [&](const Surface& surface, auto&& look) {
    const std::uint32_t n = surface.size_in_triangles();
    if (n == 0) return;
    std::vector<double> area;  // of the triangles so far
    for (std::uint32_t t = 0; t < n; ++t) {
      area.push_back((t > 0 ? area.back() : 0) + Vec3(surface.triangle(t).normal).norm());
    }
    parallel_stage("walls and gaps", kSamples, progress, [&](std::size_t i) {
      std::mt19937 random(static_cast<unsigned>(i));
      const double at = area.back() * std::uniform_real_distribution<double>(0, 1)(random);
      const auto by_area =
          std::min<std::ptrdiff_t>(std::upper_bound(area.begin(), area.end(), at) - area.begin(), n - 1);
      const std::uint32_t t =
          static_cast<std::uint32_t>(i % 2 == 0 ? by_area : static_cast<std::ptrdiff_t>(i * n / kSamples));
      if (!has_normal(surface, t)) return;
      const auto [wall_here, gap_here] =
          look(place_on(surface, t, random), Vec3(Vec3(surface.triangle(t).normal).normalized()));
      const std::lock_guard lock(mutex);
      wall = std::min(wall, wall_here);
      gap = std::min(gap, gap_here);
    });
  };
  see(split.solid, [&](const Vec3& p, const Vec3& n) {
    const double step = 2e-5 * split.solid.size();
    const bool along = split.inside.vote(p + step * n).inside, against = split.inside.vote(p - step * n).inside;
    if (along == against) return std::pair(kInfinity, kInfinity);  // a lone sheet, or buried
    const Vec3 inward = along ? n : Vec3(-n);
    return std::pair(opposite_face_m(split.solid, p, inward), room_m(p, -inward));
  });
  see(split.sheets, [&](const Vec3& p, const Vec3& n) {
    double room = kInfinity;
    for (const Vec3& outward : {n, Vec3(-n)}) {
      const double there = room_m(p, outward) - split.half_thickness_m;
      if (there > 0) room = std::min(room, there);
    }
    return std::pair(kInfinity, room);
  });
  if (wall < kInfinity) quality.thinnest_wall_m = wall;
  if (gap < kInfinity) quality.narrowest_gap_m = gap;
}

std::vector<DoubtfulPlace> find_doubtful_places(const FieldParts& parts) {
  const FieldGrid& grid = parts.grid;
  std::vector<std::array<int, 3>> at;
  std::map<std::size_t, std::uint32_t> number;  // by block index
  UnionFind sets(parts.coarse.size());          // of numbers; there are at most so many
  for (int z = 0; z < grid.blocks[2]; ++z) {
    for (int y = 0; y < grid.blocks[1]; ++y) {
      for (int x = 0; x < grid.blocks[0]; ++x) {
        if (!parts.coarse[grid.block_index(x, y, z)].doubtful()) continue;
        const auto mine = static_cast<std::uint32_t>(at.size());
        number[grid.block_index(x, y, z)] = mine;
        at.push_back({x, y, z});
        for (int k = 0; k < 13; ++k) {  // the neighbours that came before
          const int nx = x + k % 3 - 1, ny = y + k / 3 % 3 - 1, nz = z + k / 9 - 1;
          if (nx < 0 || ny < 0 || nz < 0 || nx >= grid.blocks[0] || ny >= grid.blocks[1]) continue;
          const auto it = number.find(grid.block_index(nx, ny, nz));
          if (it != number.end()) sets.join(mine, it->second);
        }
      }
    }
  }
  std::map<std::uint32_t, DoubtfulPlace> places;
  for (std::uint32_t i = 0; i < at.size(); ++i) {
    const Vec3 low = grid.corner_O(kBlockCells * at[i][0], kBlockCells * at[i][1], kBlockCells * at[i][2]);
    const Vec3 high = low + Vec3::Constant(kBlockCells * grid.voxel_m);
    DoubtfulPlace& place = places.try_emplace(sets.find(i), DoubtfulPlace{low, high, 0}).first->second;
    place.low_O = place.low_O.cwiseMin(low);
    place.high_O = place.high_O.cwiseMax(high);
    ++place.blocks;
  }
  std::vector<DoubtfulPlace> sorted;
  for (const auto& [root, place] : places) sorted.push_back(place);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const DoubtfulPlace& a, const DoubtfulPlace& b) { return a.blocks > b.blocks; });
  constexpr std::size_t kMost = 20;
  sorted.resize(std::min(kMost, sorted.size()));
  return sorted;
}

}  // namespace

FieldQuality judge_field(const FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  FieldQuality quality;
  const DistanceField field = view_field(parts);
  measure_error(parts, field, split, progress, quality);
  measure_thinness(split, field, quality);
  measure_walls(split, progress, quality);
  quality.doubtful_places = find_doubtful_places(parts);
  return quality;
}

}  // namespace tact::contact
