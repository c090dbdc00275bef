#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.hpp"
#include "contact/bake/baked_scene.hpp"
#include "fault/fault.hpp"
#include "service/stop_signal.hpp"
#include "supervise/console.hpp"

namespace tact::cli {
namespace {

using contact::BakedBody;
using Json = nlohmann::ordered_json;

template <class... Args>
std::string text(const char* format, Args... args) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

void print(supervise::Console& console, const char* part, const BakedBody& body) {
  const std::string how = body.from_cache ? "from the cache, baked once in" : "baked in";
  console.line(text("%-9s %s %.2f s with %.0f MB; %.1f MB", part, how.c_str(), body.bake_seconds,
                    static_cast<double>(body.bake_peak_bytes) / 1e6, static_cast<double>(body.bytes) / 1e6));
  console.line(text("%-9s   %s", "", body.data.c_str()));
  console.line(text("%-9s   %s", "", body.report.c_str()));
  for (const auto& warning : body.warnings) console.line(text("%-9s   ! %s", "", warning.c_str()));
}

Json json_of(const BakedBody& body) {
  std::ifstream in(body.report);
  return {{"file", body.data.string()},
          {"from_cache", body.from_cache},
          {"bake_seconds", body.bake_seconds},
          {"bake_peak_bytes", body.bake_peak_bytes},
          {"bytes", body.bytes},
          {"warnings", body.warnings},
          {"report", Json::parse(in, nullptr, false)}};
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

std::string in_voxels(const std::optional<double>& length_m, double voxel_m) {
  return length_m ? text("%.4g voxels", *length_m / voxel_m) : "none found";
}

}  // namespace

int bake(const RunOptions& options, bool json) {
  const Session session = resolve(options);
  const StopSignal stop;
  supervise::Console console;
  const auto cache = cache_dir(session.machine);
  const auto begun = std::chrono::steady_clock::now();
  const contact::BakedScene baked = contact::ensure_baked(session.scene, cache, [&](const contact::BakeStep& step) {
    // Whatever takes longer than a second shows how far it is.
    if (!json && std::chrono::steady_clock::now() - begun > std::chrono::seconds{1})
      console.status(text("%-9s %3.0f %%  %s", step.part.c_str(), 100 * step.fraction, step.stage.c_str()));
    return !stop.requested();
  });
  if (json) {
    const Json report{{"scene", session.scene.name},
                      {"voxel_m", baked.voxel_m},
                      {"field_error_max_m", json_of(baked.field_error_max_m)},
                      {"field_error_rms_m", json_of(baked.field_error_rms_m)},
                      {"thinnest_wall_m", json_of(baked.thinnest_wall_m)},
                      {"narrowest_gap_m", json_of(baked.narrowest_gap_m)},
                      {"points", baked.points},
                      {"largest_gap_voxels", baked.largest_gap_voxels},
                      {"obstacle", json_of(baked.obstacle)},
                      {"tool", json_of(baked.tool)}};
    console.line(report.dump(2, ' ', false, Json::error_handler_t::replace));
    return 0;
  }
  console.line("Scene " + session.scene.name + text(": a voxel is %.4f mm", baked.voxel_m * 1e3));
  print(console, "obstacle", baked.obstacle);
  if (baked.field_error_max_m && baked.field_error_rms_m) {
    console.line(text("%-9s   field error: max %.4f, rms %.4f voxels", "", *baked.field_error_max_m / baked.voxel_m,
                      *baked.field_error_rms_m / baked.voxel_m));
  } else {
    console.line(text("%-9s   field error: not measured, no sample lies in a sound block", ""));
  }
  console.line(text("%-9s   thinnest wall: %s, narrowest gap: %s", "",
                    in_voxels(baked.thinnest_wall_m, baked.voxel_m).c_str(),
                    in_voxels(baked.narrowest_gap_m, baked.voxel_m).c_str()));
  print(console, "tool", baked.tool);
  console.line(text("%-9s   %zu points, largest gap %.2f voxels", "", baked.points, baked.largest_gap_voxels));
  return 0;
}

}  // namespace tact::cli
