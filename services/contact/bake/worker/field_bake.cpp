#include "contact/bake/worker/field_bake.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "contact/bake/worker/block_distances.hpp"
#include "contact/bake/worker/parallel.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
};

Box box_of(const Mesh& mesh) {
  Box box;
  for (const auto& v : mesh.vertices) {
    box.low = box.low.cwiseMin(v.cast<double>());
    box.high = box.high.cwiseMax(v.cast<double>());
  }
  return box;
}

/// Distance of every block's centre; decides which blocks are stored. Rows in parallel: along a row the last distance
/// bounds the next.
void coarse_distances(FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  const FieldGrid& grid = parts.grid;
  const double block_m = kBlockCells * grid.voxel_m, half_diagonal = std::sqrt(3.0) / 2 * block_m;
  const double reach = grid.range_m() + half_diagonal;
  const int nx = grid.blocks[0], ny = grid.blocks[1], nz = grid.blocks[2];
  std::vector<std::uint8_t> stored(grid.block_count(), 0);
  parallel_stage("far field", static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), progress,
                 [&](std::size_t row) {
                   const int y = static_cast<int>(row) % ny, z = static_cast<int>(row) / ny;
                   double solid = kInfinity, sheet = kInfinity;
                   for (int x = 0; x < nx; ++x) {
                     const Vec3 centre = grid.block_centre_O(x, y, z);
                     const std::size_t i = grid.block_index(x, y, z);
                     solid = split.solid.distance(centre, solid + 1.001 * block_m);
                     sheet = split.sheets.distance(centre, sheet + 1.001 * block_m);
                     const double plate = sheet - split.half_thickness_m;
                     const double d = std::min(solid, std::fabs(plate));
                     CoarseEntry& entry = parts.coarse[i];
                     entry.centre_distance_m = static_cast<float>(d * (1 - 1e-6));
                     if (plate < 0) entry.slot_and_flags |= CoarseEntry::kInside;  // of a thick plate
                     stored[i] = d <= reach;
                   }
                 });
  std::size_t slots = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i]) parts.coarse[i].slot_and_flags = static_cast<std::uint32_t>(slots++);
  }
  parts.blocks.resize(slots);
}

template <class Body>  ///< body(slot, x, y, z)
void for_each_stored(const char* stage, FieldParts& parts, const StageProgress& progress, const Body& body) {
  const FieldGrid& grid = parts.grid;
  std::vector<std::array<int, 3>> at(parts.blocks.size());
  for (int z = 0; z < grid.blocks[2]; ++z) {
    for (int y = 0; y < grid.blocks[1]; ++y) {
      for (int x = 0; x < grid.blocks[0]; ++x) {
        const CoarseEntry& entry = parts.coarse[grid.block_index(x, y, z)];
        if (entry.stored()) at[entry.slot()] = {x, y, z};
      }
    }
  }
  parallel_stage(stage, at.size(), progress,
                 [&](std::size_t slot) { body(slot, at[slot][0], at[slot][1], at[slot][2]); });
}

/// Unsigned distances of all stored corners to the solid part.
void solid_distances(FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  const double limit = parts.grid.range_m() * (1 + 1e-6);
  tbb::enumerable_thread_specific<BlockDistances> scratch([&] { return BlockDistances(split.solid, parts.grid); });
  for_each_stored("distances", parts, progress, [&](std::size_t slot, int x, int y, int z) {
    std::array<float, kBlockValues> values;
    scratch.local().compute(x, y, z, limit, values);
    quantise(parts.grid, values, parts.blocks[slot]);
  });
}

/// Signed values become the least of solid and plates.
void add_sheets(FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  const double half = split.half_thickness_m, range = parts.grid.range_m();
  const double step = range / 32767;
  tbb::enumerable_thread_specific<BlockDistances> scratch([&] { return BlockDistances(split.sheets, parts.grid); });
  for_each_stored("sheets", parts, progress, [&](std::size_t slot, int x, int y, int z) {
    std::array<float, kBlockValues> values;
    scratch.local().compute(x, y, z, (range + half) * (1 + 1e-6), values);
    FieldBlock& block = parts.blocks[slot];
    for (std::size_t i = 0; i < kBlockValues; ++i) {
      values[i] = static_cast<float>(std::min(step * block.q[i], static_cast<double>(values[i]) - half));
    }
    quantise(parts.grid, values, block);
  });
}

void measure_error(const FieldParts& parts, const DistanceField& field, const SplitSoup& split,
                   const StageProgress& progress, FieldReport& report) {
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

/// Random points of the surface that have no inside near them.
double fraction_without_inside(const Mesh& mesh, const DistanceField& field) {
  std::vector<double> area;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[t[0]];
    area.push_back(static_cast<double>((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm()));
  }
  std::discrete_distribution<std::size_t> pick(area.begin(), area.end());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kSamples = 5000;
  int lost = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto& t = mesh.triangles[pick(random)];
    const Vec3 a = mesh.vertices[t[0]].cast<double>(), ab = mesh.vertices[t[1]].cast<double>() - a,
               ac = mesh.vertices[t[2]].cast<double>() - a;
    double u = unit(random), v = unit(random);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vec3 p = a + u * ab + v * ac, n = ab.cross(ac).normalized();
    bool found = false;
    for (const double s : {-1.5, -1.0, -0.6, -0.3, 0.3, 0.6, 1.0, 1.5}) {
      found = found || field.sample(p + s * field.voxel_m() * n).value_m < -0.01 * field.voxel_m();
    }
    lost += found ? 0 : 1;
  }
  return static_cast<double>(lost) / kSamples;
}

}  // namespace

double SplitSoup::signed_distance(const Vec3& p) const {
  const double solid_m = solid.distance(p, kInfinity);
  const double signed_solid = solid.vote(p).inside ? -solid_m : solid_m;
  return std::min(signed_solid, sheets.distance(p, kInfinity) - half_thickness_m);
}

SplitSoup split_soup(const Soup& soup, double sheet_thickness_m) {
  if (!(sheet_thickness_m > 0)) return {Surface(soup.mesh), Surface(Mesh{}), 0};
  Mesh solid{soup.mesh.vertices, {}}, sheets{soup.mesh.vertices, {}};
  for (std::size_t t = 0; t < soup.mesh.triangles.size(); ++t) {
    (soup.open[t] ? sheets : solid).triangles.push_back(soup.mesh.triangles[t]);
  }
  const double half = sheets.triangles.empty() ? 0 : 0.5 * sheet_thickness_m;
  return {Surface(solid), Surface(sheets), half};
}

FieldParts bake_field(const Soup& soup, const FieldOptions& options, const StageProgress& progress,
                      FieldReport& report) {
  const SplitSoup split = split_soup(soup, options.sheet_thickness_m);
  const Box box = box_of(soup.mesh);
  const Vec3 margin = Vec3::Constant(split.half_thickness_m);
  FieldParts parts;
  parts.grid = make_grid(box.low - margin, box.high + margin, (box.high - box.low).maxCoeff() / options.resolution,
                         options.band_voxels);
  parts.coarse.resize(parts.grid.block_count());

  coarse_distances(parts, split, progress);
  solid_distances(parts, split, progress);
  report.signs = settle_signs(parts, split.solid, progress);
  if (!split.sheets.empty()) add_sheets(parts, split, progress);
  const FieldTally tally = finish(parts);

  report.voxel_m = parts.grid.voxel_m;
  for (std::size_t i = 0; i < 3; ++i) report.cells[i] = kBlockCells * parts.grid.blocks[i];
  report.blocks_stored = tally.stored;
  report.bytes = parts.blocks.size() * sizeof(FieldBlock) + parts.coarse.size() * sizeof(CoarseEntry);
  report.jumping_blocks = tally.jumps;
  const DistanceField field = view_field(parts);
  measure_error(parts, field, split, progress, report);
  report.surface_without_inside = fraction_without_inside(soup.mesh, field);
  return parts;
}

}  // namespace tact::contact
