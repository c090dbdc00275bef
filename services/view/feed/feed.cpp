#include "view/feed/feed.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "link/convert.hpp"
#include "link/endpoint.hpp"
#include "link/health.hpp"

namespace tact::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kContactsFresh = std::chrono::milliseconds(500);
constexpr double kNever = -1;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

float strip_value(double v) { return std::isfinite(v) ? static_cast<float>(v) : 0.0f; }

SceneInfo scene_info(const wire::SceneInfo& in, bool saturation, const std::string& coupling) {
  SceneInfo out;
  out.name = in.scene;
  out.server_epoch = in.server_epoch;
  out.field_path = in.field_path;
  out.obstacle_mesh_path = in.obstacle_mesh_path;
  out.tool_mesh_path = in.tool_mesh_path;
  out.field_hash = in.field_hash;
  out.voxel_m = in.voxel_m;
  out.points = in.points;
  out.X_TM = from_wire(in.X_TM);
  out.X_WO = from_wire(in.X_WO);
  out.tool_radius_m = in.tool_radius_m;
  out.law = in.law;
  out.stiffness_n_per_m = in.stiffness_n_per_m;
  out.x_max_m = in.x_max_m;
  out.saturation = saturation;
  out.coupling = coupling;
  return out;
}

DeviceState device_state(const wire::DeviceState& in) {
  DeviceState out;
  out.epoch = in.epoch;
  out.tick = in.tick;
  out.X_WH = from_wire(in.X_WH);
  out.X_WT = from_wire(in.X_WT);
  out.X_WM = from_wire(in.X_WM);
  out.F_contact_W = from_wire(in.F_contact_W);
  out.F_hand_W = from_wire(in.F_hand_W);
  out.contact_count = in.contact_count;
  out.max_depth_m = in.max_depth_m;
  out.net_stiffness_n_per_m = in.net_stiffness_n_per_m;
  out.tick_us_max = in.tick_us_max;
  out.round_trip_us = in.round_trip_us;
  out.script_time_s = in.script_time_s;
  out.script_done = in.script_done;
  out.engaged = in.engaged;
  out.capped = in.capped;
  out.faults = in.faults;
  out.faults_ever = in.faults_ever;
  out.device = in.device;
  out.mode = in.mode;
  return out;
}

ContactSet contact_set(const wire::ContactSet& in) {
  ContactSet out;
  out.pose_seq = in.pose_seq;
  out.X_WT = from_wire(in.X_WT);
  out.X_WO = from_wire(in.X_WO);
  out.F_W = from_wire(in.F_W);
  out.total_count = in.total_count;
  out.contacts.reserve(in.contacts._length);
  for (std::uint32_t i = 0; i < in.contacts._length; ++i) {
    const wire::Contact& c = in.contacts._buffer[i];
    Contact contact{from_wire(c.p_W), from_wire(c.N_W), from_wire(c.force_W), c.depth_m, c.weight};
    if (contact.p_W.allFinite() && contact.N_W.allFinite() && contact.force_W.allFinite())
      out.contacts.push_back(contact);
  }
  return out;
}

}  // namespace

struct Feed::Wire {
  explicit Wire(const Session& s)
      : session(s),
        participant(wire::Channel::session, session),
        scene_info(participant),
        contact_set(participant),
        device_state(participant),
        parameter_ack(participant),
        hand_target(participant),
        parameter(participant),
        health(participant, "view", "udp"),
        monitor(participant) {}

  Session session;
  Participant participant;
  Subscriber<wire::SceneInfo> scene_info;
  Subscriber<wire::ContactSet> contact_set;
  Subscriber<wire::DeviceState> device_state;
  Subscriber<wire::ParameterAck> parameter_ack;
  Publisher<wire::HandTarget> hand_target;
  Publisher<wire::Parameter> parameter;
  HealthReporter health;
  HealthMonitor monitor;

  const std::uint64_t writer_id = process_epoch();
  std::uint64_t hand_seq = 0;
  Clock::time_point contacts_at{}, device_at{};
  std::vector<ParameterAnswer> answers;

  wire::Message<wire::SceneInfo> info_message;
  wire::Message<wire::ContactSet> set_message;
  wire::DeviceState device_message{};
  wire::ParameterAck ack_message{};
};

Feed::Feed(const Session& session) : wire_(std::make_unique<Wire>(session)) {}
Feed::~Feed() = default;

void Feed::poll(SharedScene& shared, std::int64_t timeout_ns) {
  Wire& w = *wire_;
  w.device_state.wait(timeout_ns);
  w.monitor.poll();
  shared.update([&](ViewScene& scene) {
    if (w.scene_info.take_newest(w.info_message)) {
      const bool saturation = scene.info.name.empty() ? w.session.scene.coupling.saturation : scene.info.saturation;
      const std::string coupling = scene.info.name.empty() ? w.session.scene.coupling.kind : scene.info.coupling;
      scene.info = scene_info(w.info_message, saturation, coupling);
      if (scene.age_s < 0) {  // no device yet: the part waits where the scene puts it
        scene.device.X_WM = w.session.scene.start_X_WM;
        scene.device.X_WT = scene.device.X_WH = scene.device.X_WM * scene.info.X_TM.inverse();
      }
    }
    if (w.contact_set.take_newest(w.set_message)) {
      scene.contact_set = contact_set(w.set_message);
      if (w.set_message.law[0] != '\0') scene.info.law = w.set_message.law;
      w.contacts_at = Clock::now();
    } else if (!scene.contact_set.contacts.empty() && Clock::now() - w.contacts_at > kContactsFresh) {
      scene.contact_set.contacts.clear();
      scene.contact_set.total_count = 0;
    }
    while (w.device_state.take(w.device_message)) {
      const DeviceState state = device_state(w.device_message);
      if (!state.X_WM.finite() || !state.X_WT.finite() || !state.X_WH.finite()) continue;
      scene.device = state;
      scene.history.add({1e-9 * static_cast<double>(w.device_message.t_mono_ns),
                         strip_value(w.device_message.force_max_n), strip_value(state.F_contact_W.torque.norm()),
                         static_cast<float>(state.contact_count), strip_value(1e3 * state.max_depth_m),
                         strip_value(state.tick_us_max)});
      w.device_at = Clock::now();
    }
    scene.age_s = w.device_at == Clock::time_point{} ? kNever : seconds_since(w.device_at);

    scene.health.clear();
    for (const char* service : {"contact", "coupling", "view"}) {
      if (const auto h = w.monitor.alive(service))
        scene.health.push_back({service, phase_name(h->phase), h->detail, h->progress, h->faults});
    }
    while (w.parameter_ack.take(w.ack_message)) {
      const wire::ParameterAck& ack = w.ack_message;
      const std::string key = ack.key, value = ack.value;
      if (ack.accepted && key == "coupling.saturation") scene.info.saturation = value == "true" || value == "on";
      if (ack.accepted && key == "coupling.kind") scene.info.coupling = value;
      if (ack.accepted && key == "contact.law") scene.info.law = value;
      if (ack.accepted && key == "contact.stiffness_n_per_m") scene.info.stiffness_n_per_m = std::atof(value.c_str());
      if (ack.writer_id == w.writer_id) w.answers.push_back({ack.request_id, key, value, ack.accepted, ack.message});
    }
  });
}

std::vector<ParameterAnswer> Feed::take_answers() { return std::exchange(wire_->answers, {}); }

void Feed::publish(const HandCommand& hand) {
  wire::HandTarget message{};
  message.schema = wire::kSchema;
  message.writer_id = wire_->writer_id;
  message.seq = ++wire_->hand_seq;
  to_wire(hand.X_WM, message.X_WM);
  message.hold = hand.hold;
  wire_->hand_target.write(message);
}

void Feed::publish(const ParameterRequest& request) {
  wire::Parameter message{};
  message.schema = wire::kSchema;
  message.writer_id = wire_->writer_id;
  message.request_id = request.request_id;
  wire::set_text(message.service, request.service);
  wire::set_text(message.key, request.key);
  wire::set_text(message.value, request.value);
  wire_->parameter.write(message);
}

void Feed::say(const std::string& detail) { wire_->health.phase(wire::kActive, detail); }

}  // namespace tact::view
