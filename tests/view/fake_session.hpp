#pragma once
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "field/field_builder.hpp"
#include "link/convert.hpp"
#include "link/endpoint.hpp"
#include "mesh/mesh.hpp"
#include "scene_builders.hpp"
#include "session/session.hpp"
#include "support/process.hpp"

namespace tact::view::testing {

/// The two services the view listens to, as far as it can tell: publishes a moving scene on the session's topics,
/// answers parameters, writes down what the view asks for. A session file to start tact-view with.
class FakeSession {
 public:
  FakeSession() {
    session.name = "view-" + std::to_string(getpid());
    session.id = 1;
    session.run_dir = scratch.path();
    session.machine.port = 0;
    session.machine.token = "secret-token";
    session.scene.name = "ring-and-peg";
    session.scene.obstacle.shape = session.scene.tool.shape = "box";
    save_mesh(merged(torus(0.06f, 0.02f), box({0.09f, 0.09f, 0.004f}, {0, 0, -0.03f})),
              scratch.path() / "obstacle.mesh");
    save_mesh(merged(box({0.025f, 0.025f, 0.06f}), box({0.06f, 0.008f, 0.008f}, {0, 0, 0.07f})),
              scratch.path() / "tool.mesh");
    const auto ring = [](const Vec3& p) { return torus_field(p, 0.06, 0.02); };
    save_field(sample_distance(make_grid(Vec3(-0.08, -0.08, -0.02), Vec3(0.08, 0.08, 0.02), 0.001), ring),
               scratch.path() / "ring.field", 7);
  }
  ~FakeSession() { stop(); }

  /// Writes the session file; then the topics come alive.
  void start() {
    save_session(session, file());
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::filesystem::path file() const { return scratch.path() / "session.toml"; }

  /// What the view sent so far.
  std::vector<wire::HandTarget> hands() const {
    const std::lock_guard lock(mutex_);
    return hands_;
  }
  std::vector<std::pair<std::string, std::string>> parameters() const {
    const std::lock_guard lock(mutex_);
    return parameters_;
  }

  test::ScratchDir scratch;
  Session session;

 private:
  void run() {
    const Participant participant(wire::Channel::session, session);
    Publisher<wire::SceneInfo> info_out(participant);
    Publisher<wire::ContactSet> contacts_out(participant);
    Publisher<wire::DeviceState> device_out(participant);
    Publisher<wire::ParameterAck> ack_out(participant);
    Subscriber<wire::HandTarget> hand_in(participant);
    Subscriber<wire::Parameter> parameter_in(participant);
    publish_info(info_out);
    const auto start = std::chrono::steady_clock::now();
    while (!stop_) {
      const double t = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      publish_motion(t, contacts_out, device_out);
      wire::HandTarget hand{};
      while (hand_in.take(hand)) {
        const std::lock_guard lock(mutex_);
        hands_.push_back(hand);
      }
      wire::Parameter parameter{};
      while (parameter_in.take(parameter)) answer(parameter, ack_out);
      std::this_thread::sleep_for(std::chrono::milliseconds(16));
    }
  }

  void publish_info(Publisher<wire::SceneInfo>& out) const {
    wire::SceneInfo message{};
    message.schema = wire::kSchema;
    message.server_epoch = 1;
    wire::set_text(message.scene, session.scene.name);
    wire::set_text(message.obstacle_mesh_path, (scratch.path() / "obstacle.mesh").string());
    wire::set_text(message.tool_mesh_path, (scratch.path() / "tool.mesh").string());
    wire::set_text(message.field_path, (scratch.path() / "ring.field").string());
    message.field_hash = 7;
    message.voxel_m = 0.001;
    message.points = 12345;
    to_wire(Pose{}, message.X_TM);
    to_wire(Pose{}, message.X_WO);
    message.tool_radius_m = 0.09;
    message.stiffness_n_per_m = 20000;
    message.x_max_m = 0.0005;
    wire::set_text(message.law, "potential");
    out.write(message);
  }

  void publish_motion(double t, Publisher<wire::ContactSet>& contacts_out, Publisher<wire::DeviceState>& device_out) {
    const double u = std::remainder(t, 2.0) < 0 ? 0.0 : 1.0;
    const ViewScene scene = ring_and_peg(t);
    std::vector<wire::Contact> contacts;
    for (const Contact& c : scene.contact_set.contacts) {
      wire::Contact out{};
      to_wire(c.p_W, out.p_W);
      to_wire(c.N_W, out.N_W);
      to_wire(c.N_W, out.grad_W);
      to_wire(c.force_W, out.force_W);
      out.depth_m = c.depth_m;
      out.weight = c.weight;
      contacts.push_back(out);
    }
    wire::ContactSet set{};
    set.schema = wire::kSchema;
    to_wire(scene.device.X_WT, set.X_WT);
    to_wire(Pose{}, set.X_WO);
    wire::set_text(set.law, law_);
    set.total_count = static_cast<std::uint32_t>(contacts.size());
    set.contacts._buffer = contacts.data();
    set.contacts._length = set.contacts._maximum = set.total_count;
    contacts_out.write(set);

    wire::DeviceState device{};
    device.schema = wire::kSchema;
    device.epoch = 1;
    device.tick = ++tick_;
    device.t_mono_ns = static_cast<std::int64_t>(1e9 * (100 + t));
    to_wire(scene.device.X_WH, device.X_WH);
    to_wire(scene.device.X_WT, device.X_WT);
    to_wire(scene.device.X_WM, device.X_WM);
    to_wire(Wrench{Vec3(0, 3 + 2 * std::sin(t), 4), Vec3(0.1, 0, 0.05 * std::sin(2 * t))}, device.F_contact_W);
    device.contact_count = 14 + static_cast<std::uint32_t>(10 * u);
    device.max_depth_m = 0.0003 + 0.0001 * std::sin(t);
    device.net_stiffness_n_per_m = 43210;
    device.force_max_n = 5.5 + 2 * std::sin(t);
    device.tick_us_max = 90 + 20 * std::sin(5 * t);
    device.round_trip_us = 41;
    device.script_time_s = t;
    device.engaged = true;
    device.faults = u > 0.5 ? 1u : 0u;
    device.faults_ever = 1u | 64u;
    wire::set_text(device.device, "simulated");
    wire::set_text(device.mode, "pseudo-admittance");
    device_out.write(device);
  }

  void answer(const wire::Parameter& asked, Publisher<wire::ParameterAck>& out) {
    {
      const std::lock_guard lock(mutex_);
      parameters_.emplace_back(asked.key, asked.value);
    }
    wire::ParameterAck ack{};
    ack.schema = wire::kSchema;
    ack.writer_id = asked.writer_id;
    ack.request_id = asked.request_id;
    wire::set_text(ack.service, asked.service);
    wire::set_text(ack.key, asked.key);
    wire::set_text(ack.value, asked.value);
    ack.accepted = std::string(asked.value) != "none";  // one refusal to look at
    if (!ack.accepted) wire::set_text(ack.message, "refused for the test");
    if (ack.accepted && std::string(asked.key) == "contact.law") law_ = asked.value;
    out.write(ack);
  }

  std::string law_ = "potential";
  std::uint64_t tick_ = 0;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  std::vector<wire::HandTarget> hands_;
  std::vector<std::pair<std::string, std::string>> parameters_;
  std::thread thread_;
};

}  // namespace tact::view::testing
