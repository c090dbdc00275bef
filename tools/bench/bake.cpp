// Mesh to field, against OpenVDB's meshToVolume: time, peak memory, error, and the sign on meshes as CAD exports them.
#include "bench/bake.hpp"

#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <tuple>

#include "bench/band_points.hpp"
#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/peers/openvdb_peer.hpp"
#include "bench/scene.hpp"
#include "contact/bake/worker/field_bake.hpp"
#include "fault/fault.hpp"
#include "session/session.hpp"

namespace tact::bench {
namespace {

using Json = nlohmann::json;
constexpr double kBand = 4;  // voxels

/// The lattice that bake_field uses.
FieldGrid lattice(const Mesh& mesh, int cells) {
  Vec3 low = mesh.vertices.front().cast<double>(), high = low;
  for (const auto& v : mesh.vertices) {
    low = low.cwiseMin(v.cast<double>());
    high = high.cwiseMax(v.cast<double>());
  }
  return make_grid(low, high, (high - low).maxCoeff() / cells, kBand);
}

DistanceField bake_ours(const Mesh& mesh, int cells, contact::FieldReport& found) {
  return make_field(
      contact::bake_field(contact::clean_soup(mesh), {.resolution = cells, .band_voxels = kBand}, {}, found));
}

double peak_mb() {
  rusage use{};
  ::getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) / 1e3;
}

/// One word for the shell.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

Json run_child(const std::string& who, const std::string& scene, int cells) {
  const std::string command =
      quoted(libexec_dir() / "tact-bench") + " --bake-child " + who + " " + quoted(scene) + " " + std::to_string(cells);
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  for (int c; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  const bool good = pipe != nullptr && ::pclose(pipe) == 0;
  const Json json = Json::parse(text, nullptr, false);
  if (!good || json.is_discarded()) throw SetupError("bake of " + scene + " by " + who + " failed: " + text);
  return json;
}

/// A closed mesh spoiled.
struct Spoiled {
  const char* how;
  Mesh mesh;
};

std::vector<Spoiled> spoil(const Mesh& clean) {
  std::mt19937 rng(26);
  Mesh doubled = clean, flipped = clean, unwelded, holes = clean;
  for (const auto& t : clean.triangles) doubled.triangles.push_back({t[0], t[2], t[1]});
  for (auto& t : flipped.triangles) {
    if (rng() % 2 == 0) std::swap(t[1], t[2]);
  }
  for (const auto& t : clean.triangles) {
    const auto base = static_cast<std::uint32_t>(unwelded.vertices.size());
    for (const auto v : t) unwelded.vertices.push_back(clean.vertices[v]);
    unwelded.triangles.push_back({base, base + 1, base + 2});
  }
  holes.triangles.clear();
  for (const auto& t : clean.triangles) {
    if (rng() % 50 != 0) holes.triangles.push_back(t);
  }
  return {{"clean", clean},
          {"unwelded", unwelded},
          {"each triangle in both orientations", doubled},
          {"every second triangle flipped", flipped},
          {"one triangle in 50 missing", holes}};
}

void signs(const Effort& effort, Report& report) {
  const int cells = effort.quick ? 128 : 256;
  const Mesh clean = load_scene_by_name("alpha").obstacle_O;
  const FieldGrid grid = lattice(clean, cells);
  const auto truth = contact::split_soup(contact::clean_soup(clean), 0);
  std::mt19937 rng(27);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  std::vector<double> exact;
  // Half near the surface, half anywhere in the box; farther than a voxel, where nobody may err.
  const auto near = points_near(clean, 3 * grid.voxel_m, effort.scaled(20000), 28);
  for (std::size_t i = 0; i < 2 * near.size(); ++i) {
    const Vec3 size = kBlockCells * grid.voxel_m * Vec3(grid.blocks[0], grid.blocks[1], grid.blocks[2]);
    const Vec3 p =
        i % 2 == 0 ? near[i / 2] : Vec3(grid.min_O + size.cwiseProduct(Vec3(unit(rng), unit(rng), unit(rng))));
    const double d = truth.signed_distance(p);
    if (std::fabs(d) > grid.voxel_m) points.push_back(p), exact.push_back(d);
  }
  std::vector<Report::Row> rows;
  for (const auto& [how, mesh] : spoil(clean)) {
    contact::FieldReport found;
    const DistanceField ours = bake_ours(mesh, cells, found);
    const VdbField theirs(mesh, grid.min_O, grid.voxel_m, kBand);
    std::vector<float> values(points.size());
    theirs.sample(points, values);
    double wrong = 0, unsaid = 0, their_wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto s = ours.sample(points[i]);
      const bool bad = (s.value_m < 0) != (exact[i] < 0);
      wrong += bad;
      unsaid += bad && !s.doubtful;
      their_wrong += (values[i] < 0) != (exact[i] < 0);
    }
    const double percent = 100 / static_cast<double>(points.size());
    rows.push_back({how, number(percent * wrong), number(percent * unsaid), number(percent * their_wrong)});
  }
  report.say("Sign at " + std::to_string(points.size()) + " points farther than a voxel from alpha's surface, " +
             std::to_string(cells) + " cells: percent wrong; of Tact also percent wrong and not declared doubtful.");
  report.table({"mesh", "Tact wrong, %", "and unsaid, %", "OpenVDB wrong, %"}, rows);
}

}  // namespace

int bake_child(const std::string& who, const std::string& name, int cells) {
  const LoadedScene scene = load_scene_by_name(name, [](SceneSpec& spec) { spec.field_resolution = 64; });
  const Mesh& mesh = scene.obstacle_O;
  const FieldGrid grid = lattice(mesh, cells);
  const auto points = points_near(mesh, 3 * grid.voxel_m, 20000, 29);
  std::vector<float> values(points.size());
  Json out;
  const double before_mb = peak_mb();
  if (who == "tact") {
    contact::FieldReport found;
    DistanceField field;
    out["seconds"] = seconds_of([&] { field = bake_ours(mesh, cells, found); });
    out["peak_mb"] = peak_mb() - before_mb;
    out["bytes"] = field.bytes();
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = static_cast<float>(field.sample(points[i]).value_m);
  } else {
    const auto begin = std::chrono::steady_clock::now();
    const VdbField field(mesh, grid.min_O, grid.voxel_m, kBand);
    out["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out["peak_mb"] = peak_mb() - before_mb;
    out["bytes"] = field.bytes();
    field.sample(points, values);
  }
  const auto exact = contact::split_soup(contact::clean_soup(mesh), 0);
  double largest = 0, square = 0, count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = exact.signed_distance(points[i]);
    if (std::fabs(d) > 3 * grid.voxel_m) continue;
    const double e = (static_cast<double>(values[i]) - d) / grid.voxel_m;
    largest = std::max(largest, std::fabs(e));
    square += e * e;
    ++count;
  }
  out["largest"] = largest;
  out["rms"] = std::sqrt(square / count);
  std::printf("%s\n", out.dump().c_str());
  return 0;
}

void bench_bake(const Effort& effort, Report& report) {
  report.say("Field of a scene's obstacle, against meshToVolume of OpenVDB " + std::string(VdbField::version()) +
             ": the same mesh, band of 4 voxels each way, all cores; each bake in a process of its own, best of " +
             std::string(effort.quick ? "1" : "3") +
             ", taking turns. Tact's time includes cleaning the soup, settling signs and measuring its own "
             "error. Errors in voxels, against exact distances.");
  std::vector<std::string> scenes{"alpha"};
  for (const auto& file : scene_files()) {
    if (file.stem() == "engine" && !effort.quick) scenes.push_back("engine");
  }
  const std::vector<int> sizes = effort.quick ? std::vector{256} : std::vector{256, 512, 1024};
  std::vector<Report::Row> rows;
  std::vector<std::tuple<std::string, Json, Json>> at_largest;
  for (const std::string& scene : scenes) {
    for (const int cells : sizes) {
      Json ours, theirs;
      for (int round = 0; round < (effort.quick ? 1 : 3); ++round) {
        const Json a = run_child("tact", scene, cells), b = run_child("openvdb", scene, cells);
        if (ours.is_null() || a["seconds"] < ours["seconds"]) ours = a;
        if (theirs.is_null() || b["seconds"] < theirs["seconds"]) theirs = b;
      }
      const auto add = [&](const char* who, const Json& j) {
        rows.push_back({scene, std::to_string(cells), who, number(j["seconds"]), number(j["peak_mb"]),
                        number(1e-6 * j["bytes"].get<double>()), number(j["largest"]), number(j["rms"])});
      };
      add("Tact", ours);
      add("OpenVDB", theirs);
      if (cells == sizes.back()) at_largest.emplace_back(scene, ours, theirs);
    }
  }
  report.times({"obstacle", "cells", "by", "seconds", "peak, MB", "field, MB", "largest error", "rms"}, rows);
  for (const auto& [scene, ours, theirs] : at_largest) {
    const auto ratio = [&, &a = ours, &b = theirs](const char* key) {
      return a[key].get<double>() / b[key].get<double>();
    };
    const std::string at = scene + ", " + std::to_string(sizes.back()) + " cells, Tact / OpenVDB: ";
    report.bar(at + "time", ratio("seconds"), "", false, 2);
    report.bar(at + "rms error", ratio("rms"), "", false, 1);
    report.bar(at + "memory served", ratio("bytes"), "", false, 1);
  }
  signs(effort, report);
}

}  // namespace tact::bench
