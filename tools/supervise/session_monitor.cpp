#include "supervise/session_monitor.hpp"

#include <time.h>

#include <sstream>
#include <utility>

namespace tact::supervise {
namespace {

// CLOCK_MONOTONIC, as t_mono_ns on the wire.
std::int64_t now_ns() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

constexpr std::size_t kSamples = 60 * 3600;  // an hour at 60 Hz; then every other one is dropped

Pose pose_of(const geometry_msgs_msg_dds__Pose_& X) {
  return {{X.position.x, X.position.y, X.position.z},
          Quat(X.orientation.w, X.orientation.x, X.orientation.y, X.orientation.z)};
}

}  // namespace

SessionMonitor::SessionMonitor(const Session& session)
    : session_(session),
      participant_(wire::Channel::session, session),
      health_(participant_),
      device_subscriber_(participant_),
      stats_subscriber_(participant_),
      scene_subscriber_(participant_),
      goal_(session.scene.goal_X_WM, session.scene.goal_distance_mm, session.scene.goal_angle_deg) {}

void SessionMonitor::poll(std::int64_t timeout_ns) {
  device_subscriber_.wait(timeout_ns);
  health_.poll();
  while (scene_subscriber_.take(scene_incoming_)) {
    std::swap(static_cast<wire::SceneInfo&>(scene_), static_cast<wire::SceneInfo&>(scene_incoming_));
    scene_known_ = true;
  }
  for (wire::SessionStats stats; stats_subscriber_.take(stats);) {
    if (stats.schema == wire::kSchema) stats_.see(stats);
  }
  for (wire::DeviceState state; device_subscriber_.take(state);) {
    if (state.schema == wire::kSchema) see(state);
  }
  const auto coupling = health_.alive("coupling"), contact = health_.alive("contact");
  if (coupling && contact && coupling->shared_memory_proven && contact->shared_memory_proven) proven_ = true;
  if (begun() && ended_ns_ == 0) {
    for (const auto& health : {coupling, contact, health_.alive("view")}) {
      if (health) faults_.see(elapsed_s(), health->service, health->faults);
    }
  }
}

void SessionMonitor::see(const wire::DeviceState& state) {
  device_ = state;
  if (!begun() || ended_ns_ != 0) return;
  // A coupling that was restarted plays its script again: done is done.
  script_done_ |= state.script_done;
  if (state.engaged) goal_.see(pose_of(state.X_WM));
  faults_.see(elapsed_s(), "coupling", state.faults);
  const double voxel_m = scene_known_ ? scene_.voxel_m : 0;
  samples_.push_back({static_cast<double>(state.t_mono_ns - begun_ns_) * 1e-9, state.force_max_n,
                      voxel_m > 0 ? state.max_depth_m / voxel_m : 0, state.tick_us_max, state.contact_count});
  if (samples_.size() == kSamples) {
    for (std::size_t i = 0; i < kSamples / 2; ++i) samples_[i] = samples_[2 * i];
    samples_.resize(kSamples / 2);
  }
}

void SessionMonitor::begin() { begun_ns_ = now_ns(); }

void SessionMonitor::end() { ended_ns_ = now_ns(); }

double SessionMonitor::elapsed_s() const {
  if (!begun()) return 0;
  return static_cast<double>((ended_ns_ != 0 ? ended_ns_ : now_ns()) - begun_ns_) * 1e-9;
}

report::SessionReport SessionMonitor::report() const {
  report::SessionReport r;
  r.session = session_.name;
  r.scene = session_.scene.name;
  r.script = session_.run.script;
  r.device = session_.machine.device;
  r.mode = session_.machine.mode;
  r.coupling = session_.scene.coupling.kind;
  r.transport = session_.machine.transport;
  r.saturation = session_.scene.coupling.saturation;
  r.law = session_.scene.contact.law;
  r.stiffness_n_per_m = session_.scene.contact.stiffness_n_per_m;
  r.rate_hz = session_.machine.rate_hz;
  r.duration_s = elapsed_s();
  r.shared_memory_proven = proven_;
  r.stats = stats_.total();
  if (scene_known_) {
    r.law = scene_.law;
    r.stiffness_n_per_m = scene_.stiffness_n_per_m;
    r.voxel_m = scene_.voxel_m;
    std::istringstream notes(scene_.notes);
    for (std::string note; std::getline(notes, note);) r.notes.push_back(note);
    for (std::uint32_t i = 0; i < scene_.loaded._length; ++i) {
      const auto& part = scene_.loaded._buffer[i];
      r.loaded.push_back({part.what, part.seconds, part.bytes});
    }
  }
  r.goal_reached = goal_.reached();
  r.goal_distance_mm = goal_.distance_mm();
  r.goal_angle_deg = goal_.angle_deg();
  r.faults = faults_.events();
  return r;
}

}  // namespace tact::supervise
