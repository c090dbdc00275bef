#include "contact/bake/worker/bake_parts.hpp"

#include <sys/resource.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/import.hpp"
#include "contact/bake/worker/shell_bake.hpp"
#include "fault/fault.hpp"
#include "file/sealed_file.hpp"
#include "file/whole_file.hpp"
#include "shapes/shapes.hpp"

namespace tact::contact {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

Mesh geometry(const BodySpec& body) {
  return body.shape.empty() ? import_mesh(body.mesh, body.unit) : make_shape(body.shape, body.shape_params);
}

Soup clean(const BodySpec& body) {
  Soup soup = clean_soup(geometry(body));
  if (soup.mesh.triangles.empty()) {
    throw SetupError(body_name(body) + ": all " + std::to_string(soup.report.triangles_read) +
                     " triangles are degenerate");
  }
  return soup;
}

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2g %%", 100 * fraction);
  return text;
}

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g mm", 1e3 * metres);
  return text;
}

json to_json(const SoupReport& r) {
  return {{"triangles_read", r.triangles_read},
          {"triangles_kept", r.triangles_kept},
          {"degenerate", r.degenerate},
          {"duplicates_same", r.duplicates_same},
          {"duplicates_opposite", r.duplicates_opposite},
          {"inner_walls", r.inner_walls},
          {"seam_vertices", r.seam_vertices},
          {"boundary_edges", r.boundary_edges},
          {"non_manifold_edges", r.non_manifold_edges},
          {"flipped_edges", r.flipped_edges},
          {"components", r.components},
          {"open_components", r.open_components},
          {"sheet_triangles", r.sheet_triangles},
          {"closed_parts", r.closed_parts},
          {"capped_holes", r.capped_holes},
          {"turned_triangles", r.turned_triangles}};
}

json to_json(const SolidReport& r) {
  return {{"solids", r.solids},
          {"cavities", r.cavities},
          {"inverted_parts", r.inverted_parts},
          {"swallowed_parts", r.swallowed_parts},
          {"guessed_cavities", r.guessed_cavities},
          {"overlaps", r.overlaps},
          {"self_crossing_parts", r.self_crossing_parts},
          {"crossing_triangles", r.crossing_triangles},
          {"buried_triangles", r.buried_triangles},
          {"parity_triangles", r.parity_triangles}};
}

json to_json(const std::vector<DoubtfulPlace>& places) {
  json list = json::array();
  for (const DoubtfulPlace& p : places) {
    list.push_back({{"low_m", {p.low_O.x(), p.low_O.y(), p.low_O.z()}},
                    {"high_m", {p.high_O.x(), p.high_O.y(), p.high_O.z()}},
                    {"blocks", p.blocks}});
  }
  return list;
}

json in_mm(const std::optional<double>& metres) { return metres ? json(1e3 * *metres) : json(); }

json to_json(const FieldReport& r) {
  return {{"resolution", r.resolution},
          {"voxel_m", r.voxel_m},
          {"cells", r.cells},
          {"blocks_stored", r.blocks_stored},
          {"bytes", r.bytes},
          {"regions", r.signs.components},
          {"leaking_regions", r.signs.leaking},
          {"voted_corners", r.signs.voted_corners},
          {"close_votes", r.signs.close_votes},
          {"doubtful_blocks", r.signs.doubtful_blocks},
          {"jumping_blocks", r.jumping_blocks},
          {"doubtful_places", to_json(r.quality.doubtful_places)},
          {"error_samples", r.quality.error_samples},
          {"error_largest_m", r.quality.error_samples > 0 ? json(r.quality.error_largest_m) : json()},
          {"error_rms_m", r.quality.error_samples > 0 ? json(r.quality.error_rms_m) : json()},
          {"sign_mismatches", r.quality.sign_mismatches},
          {"thinnest_wall_mm", in_mm(r.quality.thinnest_wall_m)},
          {"narrowest_gap_mm", in_mm(r.quality.narrowest_gap_m)},
          {"thinnest_wall_the_grid_honours_mm", 1e3 * honoured_m(r.voxel_m)},
          {"narrowest_gap_the_grid_honours_mm", 1e3 * honoured_m(r.voxel_m)},
          {"surface_without_inside", r.quality.surface_without_inside},
          {"surface_without_outside", r.quality.surface_without_outside}};
}

json to_json(const ShellReport& r) {
  return {{"points", r.points},
          {"feature_points", r.feature_points},
          {"thin_part_samples", r.thin_part_samples},
          {"area_m2", r.area_m2},
          {"volume_m3", r.volume_m3},
          {"mean_spacing_m", r.mean_spacing_m},
          {"largest_gap_m", r.largest_gap_m},
          {"samples", r.samples},
          {"buried_samples", r.buried_samples},
          {"samples_without_inside", r.samples_without_inside},
          {"level_sizes", r.level_sizes}};
}

std::vector<std::string> soup_warnings(const BodySpec& body, const SoupReport& r) {
  const std::string name = body_name(body) + ": ";
  std::vector<std::string> w;
  const auto n = [](std::size_t count) { return std::to_string(count); };
  if (r.degenerate > 0) w.push_back(name + n(r.degenerate) + " triangles without area were dropped");
  if (r.duplicates_same + r.duplicates_opposite > 0) {
    w.push_back(name + n(r.duplicates_same + r.duplicates_opposite) + " of " + n(r.triangles_read) +
                " triangles were coincident copies (" + n(r.duplicates_opposite) + " turned over) and were dropped");
  }
  if (r.inner_walls > 0) w.push_back(name + n(r.inner_walls) + " faces between touching solids were dropped");
  if (r.open_components > 0 && !(body.sheet_thickness_m > 0)) {
    w.push_back(name + n(r.open_components) + " of " + n(r.components) + " parts are open (" + n(r.boundary_edges) +
                " boundary edges): inside and outside were voted on; if they are sheets, set sheet_thickness_m");
  }
  if (r.seam_vertices > 0) {
    w.push_back(name + n(r.seam_vertices) + " corners along open seams were joined to their neighbours");
  }
  if (r.capped_holes > 0) {
    w.push_back(name + n(r.capped_holes) + " small holes were closed");
  }
  if (r.turned_triangles > 0) {
    w.push_back(name + n(r.turned_triangles) + " triangles faced the other way than their part and were turned over");
  }
  return w;
}

std::vector<std::string> solid_warnings(const BodySpec& body, const SolidReport& r) {
  const std::string name = body_name(body) + ": ";
  std::vector<std::string> w;
  const auto n = [](std::size_t count) { return std::to_string(count); };
  if (r.inverted_parts > 0) w.push_back(name + n(r.inverted_parts) + " closed parts faced inward and were turned over");
  if (r.overlaps > 0) {
    w.push_back(name + n(r.overlaps) + " pairs of parts interpenetrate or touch: the body is their union");
  }
  if (r.self_crossing_parts > 0) {
    w.push_back(name + n(r.self_crossing_parts) +
                " parts touch or pass through themselves: inside is where they wind at all");
  }
  if (r.swallowed_parts > 0) {
    w.push_back(name + n(r.swallowed_parts) +
                " parts lie wholly inside another and face as it does: taken as solid; turn them over for cavities");
  }
  if (r.guessed_cavities > 0) {
    w.push_back(name + n(r.guessed_cavities) +
                " parts lie wholly inside another and the file's orientation cannot be trusted: taken as cavities");
  }
  return w;
}

void write_report(const BakedFiles& files, json report, const char* part, const SceneSpec& scene, const BodySpec& body,
                  std::uint64_t key, Clock::time_point start, const Soup& soup,
                  const std::vector<std::string>& warnings) {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  report["schema"] = 1;
  report["part"] = part;
  report["scene"] = scene.name;
  report["body"] = body_name(body);
  report["content_hash"] = hex(key);
  report["sheet_thickness_m"] = body.sheet_thickness_m;
  report["seconds"] = std::chrono::duration<double>(Clock::now() - start).count();
  report["peak_memory_bytes"] = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  report["soup"] = to_json(soup.report);
  report["warnings"] = warnings;
  write_whole(files.report, report.dump(2) + '\n', {.synced = true});
}

constexpr int kFewestCells = 32, kFewestUnprovenCells = 256, kMostCells = 4096;

/// Why a bake whose samples meet an error bound does not prove it: "" when it does.
std::string missing_evidence(const FieldQuality& q) {
  constexpr std::size_t kFewestSamples = 1000;
  if (q.error_samples < kFewestSamples) {
    return "the error could be measured at only " + std::to_string(q.error_samples) + " of 20000 samples";
  }
  if (q.sign_mismatches > 0) {
    return std::to_string(q.sign_mismatches) + " samples have the wrong sign and are not in the error";
  }
  return "";
}

/// The field at the scene's number of cells, or at the number its error bound needs: errors are nearly proportional to
/// the voxel, so a coarse bake tells the number and the bake itself proves it. One that cannot prove it is no coarser
/// than the usual field, and warns.
FieldParts bake_to_order(const SceneSpec& scene, const Soup& soup, const StageProgress& progress, FieldReport& report) {
  const double bound_m = 1e-3 * scene.field_error_mm;
  const auto bake = [&](int cells) {
    report = {};
    return bake_field(soup, {cells, 4, scene.obstacle.sheet_thickness_m}, progress, report);
  };
  if (!(bound_m > 0)) return bake(scene.field_resolution);
  Eigen::AlignedBox3f box;
  for (const auto& v : soup.mesh.vertices) box.extend(v);
  const double size = static_cast<double>(box.sizes().maxCoeff());
  const auto clamped = [](double cells) {
    return static_cast<int>(std::clamp(std::ceil(cells), double{kFewestCells}, double{kMostCells} + 1));
  };
  int cells = clamped(size / (4 * bound_m));  // few voxels are less than a quarter of their side wrong
  for (;;) {
    if (cells > kMostCells) {
      throw SetupError(body_name(scene.obstacle) +
                       ": an error below obstacle.field_error_mm = " + std::to_string(scene.field_error_mm) +
                       " needs more than " + std::to_string(kMostCells) + " cells: allow more");
    }
    FieldParts parts = bake(cells);
    const double error = report.quality.error_largest_m;
    if (error <= bound_m) {
      if (cells >= kFewestUnprovenCells || missing_evidence(report.quality).empty()) return parts;
      cells = kFewestUnprovenCells;
      continue;
    }
    cells = std::max(cells + 1, clamped(1.03 * cells * error / bound_m));
  }
}

}  // namespace

void bake_obstacle(const SceneSpec& scene, const BakedFiles& files, std::uint64_t key, const StageProgress& progress) {
  const auto start = Clock::now();
  const BodySpec& body = scene.obstacle;
  if (progress && !progress("reading", 0)) throw Cancelled();
  const Soup soup = clean(body);
  FieldReport r;
  const FieldParts parts = bake_to_order(scene, soup, progress, r);
  save_mesh(soup.mesh, files.mesh);
  save_field(parts, files.data, key);

  std::vector<std::string> warnings = soup_warnings(body, soup.report);
  for (std::string& w : solid_warnings(body, r.solids)) warnings.push_back(std::move(w));
  const std::string name = body_name(body) + ": ";
  if (r.signs.doubtful_blocks > 0) {
    warnings.push_back(name + "inside and outside are uncertain in " + std::to_string(r.signs.doubtful_blocks) +
                       " of " + std::to_string(r.blocks_stored) + " blocks of the field" +
                       (scene.field_error_mm > 0 ? "; there obstacle.field_error_mm promises nothing" : ""));
  }
  if (r.jumping_blocks > 0) {
    warnings.push_back(name + "the sign changes without a surface in " + std::to_string(r.jumping_blocks) + " blocks");
  }
  if (r.quality.sign_mismatches > 0) {
    warnings.push_back(name + "the sign differs from an independent vote at " +
                       std::to_string(r.quality.sign_mismatches) + " of " + std::to_string(r.quality.error_samples) +
                       " random samples");
  }
  if (const std::string missing = missing_evidence(r.quality); scene.field_error_mm > 0 && !missing.empty()) {
    warnings.push_back(name + "obstacle.field_error_mm is NOT proven: " + missing +
                       "; repair the mesh, or set sheet_thickness_m if its open parts are sheets");
  }
  if (const auto& wall = r.quality.thinnest_wall_m; wall && *wall < r.voxel_m) {
    warnings.push_back(name + "its thinnest wall found is " + millimetres(*wall) + ", less than a voxel of " +
                       millimetres(r.voxel_m) + ": the field may show no inside there");
  }
  if (const auto& gap = r.quality.narrowest_gap_m; gap && *gap < r.voxel_m) {
    warnings.push_back(name + "its narrowest gap found is " + millimetres(*gap) + ", less than a voxel of " +
                       millimetres(r.voxel_m) + ": the field may show no way through");
  }
  if (r.quality.surface_without_inside > 0.005) {
    warnings.push_back(name + percent(r.quality.surface_without_inside) +
                       " of the surface has no inside that the grid can hold: walls thinner than " +
                       millimetres(r.voxel_m) + ", or sheets (set sheet_thickness_m)");
  }
  if (r.quality.surface_without_outside > 0.005) {
    warnings.push_back(name + percent(r.quality.surface_without_outside) +
                       " of the surface has no outside that the grid can hold: gaps narrower than " +
                       millimetres(r.voxel_m));
  }
  write_report(files, {{"field", to_json(r)}, {"solids", to_json(r.solids)}}, "obstacle", scene, body, key, start, soup,
               warnings);
}

void bake_tool(const SceneSpec& scene, double spacing_m, const BakedFiles& files, std::uint64_t key,
               const StageProgress& progress) {
  const auto start = Clock::now();
  const BodySpec& body = scene.tool;
  if (progress && !progress("reading", 0)) throw Cancelled();
  const Soup soup = clean(body);
  ShellReport r;
  Pointshell shell;
  try {
    shell = bake_shell(soup, {scene.points, scene.levels, body.sheet_thickness_m, spacing_m}, progress, r);
  } catch (const SetupError& error) {
    throw SetupError(body_name(body) + ": " + error.what());
  }
  shell.content_hash = key;
  save_mesh(soup.mesh, files.mesh);
  save_pointshell(shell, files.data);

  std::vector<std::string> warnings = soup_warnings(body, soup.report);
  for (std::string& w : solid_warnings(body, r.solids)) warnings.push_back(std::move(w));
  const std::string name = body_name(body) + ": ";
  const auto share = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(r.samples); };
  if (r.samples_without_inside > 0) {
    warnings.push_back(
        name + percent(share(r.samples_without_inside)) +
        " of the surface has no inside; its normals are those of the file: if it is a sheet, set sheet_thickness_m");
  }
  if (r.buried_samples > 0) {
    warnings.push_back(name + percent(share(r.buried_samples)) +
                       " of the surface lies inside the body and got no points");
  }
  write_report(files, {{"shell", to_json(r)}, {"solids", to_json(r.solids)}}, "tool", scene, body, key, start, soup,
               warnings);
}

}  // namespace tact::contact
