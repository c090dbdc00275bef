// What the supervisor tells a person: progress, what was loaded, one status line, the report.
#include <cstdio>
#include <fstream>

#include "fault/fault.hpp"
#include "supervise/supervisor.hpp"

namespace tact::supervise {
namespace {

using namespace std::chrono_literals;

constexpr auto kRefresh = 100ms;
constexpr auto kShortEnough = 2s;  // loading for less needs no progress line

template <class... Args>
std::string text(const char* format, Args... args) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

}  // namespace

void Supervisor::show() {
  const auto now = Clock::now();
  if (now < next_show_) return;
  next_show_ = now + kRefresh;
  if (!url_shown_ && session_.machine.view) {
    std::ifstream file(run_dir_.path() / "view_url");  // tact-view writes it once it listens
    if (std::string url; std::getline(file, url) && !url.empty()) {
      url_shown_ = true;
      console_.line("Open " + url);
    }
  }
  if (monitor_->begun()) {
    console_.status(status_line());
    return;
  }
  const auto contact = monitor_->alive("contact");
  if (!contact || contact->phase != wire::kLoading) return;
  if (now - loading_since_ < kShortEnough) return;
  const std::string percent = contact->progress >= 0 ? text("%3.0f %%  ", 100 * contact->progress) : std::string();
  console_.status("loading  " + percent + contact->detail);
}

std::string Supervisor::status_line() const {
  std::string line = text("%7.1f s  ", monitor_->elapsed_s());
  const auto coupling = monitor_->alive("coupling");
  const bool active = coupling && coupling->phase == wire::kActive && !roudi_watch_.lost();
  line += !coupling ? "no coupling" : active ? "active" : "degraded";
  if (const auto& d = monitor_->device()) {
    if (d->script_time_s >= 0) line += d->script_done ? "  script done" : text("  script %.1f s", d->script_time_s);
    const double voxel_m = monitor_->scene() != nullptr ? monitor_->scene()->voxel_m : 0;
    line += text(" | %3u contacts  %.2f voxels deep  %5.2f N", d->contact_count,
                 voxel_m > 0 ? d->max_depth_m / voxel_m : 0.0, d->force_max_n);
    line += text(" | tick %.0f us  round trip %.0f us", d->tick_us_max, d->round_trip_us);
    if (d->faults != 0) line += " | " + fault_names(d->faults);
  }
  return line;
}

void Supervisor::announce() {
  const wire::SceneInfo& scene = *monitor_->scene();
  std::string title = "Session " + session_.name + ": scene " + session_.scene.name;
  if (!session_.scene.title.empty()) title += ", " + session_.scene.title;
  console_.line(title);
  console_.line(
      text("  law %s at %.0f N/m; a voxel is %.3f mm; ", scene.law, scene.stiffness_n_per_m, scene.voxel_m * 1e3) +
      session_.machine.device + " device, " + session_.machine.mode + text(", %.0f Hz, ", session_.machine.rate_hz) +
      (!shm()                             ? "UDP"
       : monitor_->shared_memory_proven() ? "shared memory, proven"
                                          : "shared memory"));
  for (const auto& part : monitor_->report().loaded) {
    console_.line(text("  loaded %-36s %6.2f s %8.1f MB", part.what.c_str(), part.seconds,
                       static_cast<double>(part.bytes) / 1e6));
  }
  for (const auto& note : monitor_->report().notes) console_.line("  ! " + note);
  next_measure_ = {};
  measure();
  std::string memory;
  for (const auto& s : services_) {
    memory += (memory.empty() ? "" : ", ") + s->name + text(" %.0f MB", s->use.resident_mb);
  }
  console_.line("  memory " + memory);
  console_.line("  logs   " + run_dir_.path().string());
}

void Supervisor::write_report() {
  report::SessionReport report = monitor_->report();
  for (const auto& s : services_) {
    double lived_s = s->lived_s;
    if (s->child) lived_s += std::chrono::duration<double>(Clock::now() - s->started).count();
    const double cpu_s = s->earlier_cpu_s + s->use.cpu_s;
    report.services.push_back({s->name, lived_s > 0 ? 100 * cpu_s / lived_s : 0, s->peak_mb, s->restarts});
  }
  console_.line(report::to_table(report));
  if (!session_.run.report.empty()) {
    std::ofstream out(session_.run.report);
    out << report::to_json(report) << std::flush;
    if (!out)
      throw SetupError("run.report: " + session_.run.report.string() + " could not be written: is the disk full?");
    console_.line("Report: " + session_.run.report.string());
    keep_flight_records();
  }
  std::filesystem::path plot = session_.run.plot;
  if (plot.empty() && !session_.run.report.empty())
    plot = std::filesystem::path(session_.run.report).replace_extension(".png");
  if (plot.empty()) return;
  try {
    report::write_plot(session_.name + ": " + report.scene + " " + report.script + ", law " + report.law,
                       monitor_->samples(), plot);
    console_.line("Plot: " + plot.string());
  } catch (const SetupError& e) {
    console_.line(std::string("! no plot: ") + e.what());
  }
}

void Supervisor::keep_flight_records() {
  for (const auto& entry : std::filesystem::directory_iterator(run_dir_.path())) {
    const std::string name = entry.path().filename();
    if (name.rfind("flight-", 0) != 0) continue;
    auto kept = session_.run.report;
    kept.replace_filename(session_.run.report.stem().string() + "-" + name);
    std::error_code error;
    std::filesystem::copy_file(entry.path(), kept, std::filesystem::copy_options::overwrite_existing, error);
    console_.line(error ? "! " + kept.string() + ": " + error.message() : "Flight record of a fault: " + kept.string());
  }
}

}  // namespace tact::supervise
