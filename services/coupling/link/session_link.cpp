#include "coupling/link/session_link.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "coupling/link/contact_link.hpp"
#include "coupling/link/messages.hpp"
#include "coupling/loop/session_config.hpp"
#include "fault/fault.hpp"
#include "link/convert.hpp"

namespace tact::coupling {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr milliseconds kStatePeriod{16};
constexpr milliseconds kStatsPeriod{500};
constexpr seconds kHandSilence{1};
constexpr seconds kLoopAnswer{1};
constexpr std::uint32_t kLoopFaults = ~ContactLink::kFaults;

/// Scene keys that may change while the loop runs.
constexpr std::array kLive{"coupling.kind",
                           "coupling.integrator",
                           "coupling.passivity_controller",
                           "coupling.saturation",
                           "coupling.stiffness_n_per_m",
                           "coupling.damping_ratio",
                           "coupling.stiffness_nm_per_rad",
                           "coupling.torque_max_nm"};

}  // namespace

using tact::from_wire;

SessionLink::SessionLink(const Session& session, const Participant& low, HealthReporter& health, Mailboxes& mail)
    : session_(session),
      health_(health),
      mail_(mail),
      real_device_(session.machine.device == "virtuose"),
      state_(low),
      stats_(low),
      acks_(low),
      hands_(low),
      requests_(low),
      scenes_(low),
      scene_(session.scene) {}

std::optional<SceneModel> SessionLink::wait_scene(milliseconds limit) {
  wire::Message<wire::SceneInfo> info;
  if (!scenes_.wait(std::chrono::nanoseconds{limit}.count()) || !scenes_.take_newest(info)) return std::nullopt;
  SceneModel scene = scene_model(info);
  const SceneIdentity first = first_scene(session_.run_dir, scene.identity);
  if (scene.identity != first) {
    refuse_scene(health_, scene.identity, first);
    return std::nullopt;
  }
  health_.set_faults(bit(Fault::scene_changed), 0);
  return scene;
}

void SessionLink::start(const LoopParameters& in_force) {
  parameters_ = in_force;
  thread_ = std::thread([this] { run(); });
}

void SessionLink::stop() {
  if (!thread_.joinable()) return;
  stop_ = true;
  thread_.join();
  if (mail_.status.read(status_)) any_status_ = true;
  publish_state();
  publish_stats();
}

void SessionLink::run() {
  auto next_state = steady_clock::now(), next_stats = next_state;
  while (!stop_) {
    take_hand();
    take_parameters();
    if (mail_.status.read(status_)) any_status_ = true;
    acknowledge();
    publish_state();
    if (steady_clock::now() >= next_stats) {
      publish_stats();
      next_stats += kStatsPeriod;
    }
    next_state += kStatePeriod;
    std::this_thread::sleep_until(next_state);
  }
}

void SessionLink::publish_state() {
  if (!any_status_) return;
  wire::DeviceState out;
  to_wire(status_, process_epoch(), session_.machine.device.c_str(), session_.machine.mode.c_str(), out);
  health_.set_faults(kLoopFaults, status_.faults);
  state_.write(out);
}

void SessionLink::publish_stats() {
  if (!any_status_) return;
  wire::SessionStats out;
  to_wire(status_.stats, process_epoch(), status_.X_WM, out);
  stats_.write(out);
}

void SessionLink::take_hand() {
  wire::HandTarget hand;
  const bool heard = hands_.take_newest(hand);
  if (heard) hand_heard_ = steady_clock::now();
  const bool refused = real_device_ && status_.engaged;
  const bool silent = steady_clock::now() - hand_heard_ > kHandSilence;
  if (heard && !refused) {
    const Pose X_WM = from_wire(hand.X_WM);
    const bool hold = hand.hold && X_WM.finite() && X_WM.q.norm() > 0.5;
    mail_.hand.write({hold ? Pose{X_WM.p, X_WM.q.normalized()} : status_.X_WM, hold});
    holding_ = hold;
  } else if (holding_ && (refused || silent)) {
    mail_.hand.write({status_.X_WM, false});
    holding_ = false;
  }
}

void SessionLink::take_parameters() {
  for (wire::Parameter request; requests_.take(request);) {
    if (std::strcmp(request.service, "coupling") != 0) continue;
    wire::ParameterAck ack{};
    ack.schema = wire::kSchema;
    ack.writer_id = request.writer_id;
    ack.request_id = request.request_id;
    wire::set_text(ack.service, "coupling");
    wire::set_text(ack.key, request.key);
    wire::set_text(ack.value, request.value);
    ack.params_version = parameters_.version;
    try {
      if (std::find_if(kLive.begin(), kLive.end(), [&](const char* k) { return !std::strcmp(k, request.key); }) ==
          kLive.end()) {
        throw SetupError(std::string(request.key) + ": cannot be changed while coupling runs; change the scene file");
      }
      SceneSpec next = scene_;
      set_scene_key(next, request.key, request.value);
      check_coupling(next.coupling, session_.machine);
      scene_ = std::move(next);
      const std::uint64_t version = parameters_.version + 1;
      parameters_ = loop_parameters(scene_.coupling);
      ack.params_version = parameters_.version = version;
      mail_.parameters.write(parameters_);
      pending_.push_back({ack, steady_clock::now()});
    } catch (const SetupError& e) {
      wire::set_text(ack.message, e.what());
      acks_.write(ack);
    }
  }
}

void SessionLink::acknowledge() {
  std::erase_if(pending_, [this](Pending& p) {
    const bool in_force = status_.parameters_version >= p.ack.params_version;
    const bool late = steady_clock::now() - p.since > kLoopAnswer;
    if (!in_force && !late) return false;
    p.ack.accepted = in_force;
    if (!in_force) wire::set_text(p.ack.message, "the device loop did not take it within a second: is it running?");
    acks_.write(p.ack);
    return true;
  });
}

}  // namespace tact::coupling
