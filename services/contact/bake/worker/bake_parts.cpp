#include "contact/bake/worker/bake_parts.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/import.hpp"
#include "contact/bake/worker/shell_bake.hpp"
#include "fault/fault.hpp"
#include "file/sealed_file.hpp"
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

json to_json(const SoupReport& r) {
  return {{"triangles_read", r.triangles_read},
          {"triangles_kept", r.triangles_kept},
          {"degenerate", r.degenerate},
          {"duplicates_same", r.duplicates_same},
          {"duplicates_opposite", r.duplicates_opposite},
          {"inner_walls", r.inner_walls},
          {"boundary_edges", r.boundary_edges},
          {"non_manifold_edges", r.non_manifold_edges},
          {"flipped_edges", r.flipped_edges},
          {"components", r.components},
          {"open_components", r.open_components},
          {"sheet_triangles", r.sheet_triangles}};
}

json to_json(const FieldReport& r) {
  return {{"voxel_m", r.voxel_m},
          {"cells", r.cells},
          {"blocks_stored", r.blocks_stored},
          {"bytes", r.bytes},
          {"regions", r.signs.components},
          {"leaking_regions", r.signs.leaking},
          {"voted_corners", r.signs.voted_corners},
          {"close_votes", r.signs.close_votes},
          {"doubtful_blocks", r.signs.doubtful_blocks},
          {"jumping_blocks", r.jumping_blocks},
          {"error_samples", r.error_samples},
          {"error_largest_m", r.error_largest_m},
          {"error_rms_m", r.error_rms_m},
          {"sign_mismatches", r.sign_mismatches},
          {"surface_without_inside", r.surface_without_inside}};
}

json to_json(const ShellReport& r) {
  return {{"points", r.points},
          {"feature_points", r.feature_points},
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
  const std::filesystem::path temporary = files.report.string() + "." + std::to_string(::getpid());
  {
    std::ofstream file(temporary);
    file << report.dump(2) << '\n';
    if (!file.flush()) throw SetupError(files.report.string() + ": cannot write: free some space or set cache.dir");
  }
  std::filesystem::rename(temporary, files.report);
}

}  // namespace

void bake_obstacle(const SceneSpec& scene, const BakedFiles& files, std::uint64_t key, const StageProgress& progress) {
  const auto start = Clock::now();
  const BodySpec& body = scene.obstacle;
  if (progress && !progress("reading", 0)) throw Cancelled();
  const Soup soup = clean(body);
  FieldReport r;
  const FieldParts parts = bake_field(soup, {scene.field_resolution, 4, body.sheet_thickness_m}, progress, r);
  save_mesh(soup.mesh, files.mesh);
  save_field(parts, files.data, key);

  std::vector<std::string> warnings = soup_warnings(body, soup.report);
  const std::string name = body_name(body) + ": ";
  if (r.signs.doubtful_blocks > 0) {
    warnings.push_back(name + "inside and outside are uncertain in " + std::to_string(r.signs.doubtful_blocks) +
                       " of " + std::to_string(r.blocks_stored) + " blocks of the field");
  }
  if (r.jumping_blocks > 0) {
    warnings.push_back(name + "the sign changes without a surface in " + std::to_string(r.jumping_blocks) + " blocks");
  }
  if (r.sign_mismatches > 0) {
    warnings.push_back(name + "the sign differs from an independent vote at " + std::to_string(r.sign_mismatches) +
                       " of " + std::to_string(r.error_samples) + " random samples");
  }
  if (r.surface_without_inside > 0.005) {
    warnings.push_back(name + percent(r.surface_without_inside) +
                       " of the surface has no inside that the grid can hold: walls thinner than " +
                       std::to_string(1e3 * r.voxel_m) + " mm, or sheets (set sheet_thickness_m)");
  }
  write_report(files, {{"field", to_json(r)}}, "obstacle", scene, body, key, start, soup, warnings);
}

void bake_tool(const SceneSpec& scene, const BakedFiles& files, std::uint64_t key, const StageProgress& progress) {
  const auto start = Clock::now();
  const BodySpec& body = scene.tool;
  if (progress && !progress("reading", 0)) throw Cancelled();
  const Soup soup = clean(body);
  ShellReport r;
  Pointshell shell;
  try {
    shell = bake_shell(soup, {scene.points, scene.levels, body.sheet_thickness_m}, progress, r);
  } catch (const SetupError& error) {
    throw SetupError(body_name(body) + ": " + error.what());
  }
  shell.content_hash = key;
  save_mesh(soup.mesh, files.mesh);
  save_pointshell(shell, files.data);

  std::vector<std::string> warnings = soup_warnings(body, soup.report);
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
  write_report(files, {{"shell", to_json(r)}}, "tool", scene, body, key, start, soup, warnings);
}

}  // namespace tact::contact
