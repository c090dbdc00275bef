#include "lockstep/lockstep.hpp"

#include <cmath>

#include "fault/fault.hpp"

namespace tact::lockstep {
namespace {

using coupling::ContactReply;

constexpr double kReplyTakes_s = 50e-6;  // of a reply that is not late: only reported

coupling::DeviceOptions device_of(const Experiment& setup, const coupling::LoopConfig& config) {
  if (setup.session.machine.device != "simulated") {
    throw SetupError("device.driver: found \"" + setup.session.machine.device +
                     "\", expected \"simulated\": an experiment moves no arm");
  }
  coupling::DeviceOptions options = coupling::device_options(setup.session);
  if (!setup.motion_WM.time_s.empty()) options.hand_motion = setup.motion_WM;
  coupling::take_bodies(config, options);  // from poses of the mesh frame to those of the handle
  if (setup.hand) options.hand = *setup.hand;
  return options;
}

coupling::BodyModel model_of(const Experiment& setup, const contact::PipelineParams& params) {
  const contact::Pointshell& shell = *setup.bodies.shell;
  coupling::BodyModel bodies;
  bodies.X_TM = shell.X_TM;
  bodies.X_WO = setup.session.scene.X_WO;
  bodies.inertia_shape_m2 = shell.inertia_shape_m2;
  bodies.gyration_radius_m = shell.gyration_radius_m;
  bodies.tool_radius_m = shell.bounding_radius_m;
  bodies.voxel_m = setup.bodies.field.voxel_m();
  bodies.stiffness_n_per_m = params.stiffness_n_per_m;
  bodies.x_max_m = params.x_max_m;
  return bodies;
}

contact::PipelineParams params_of(const Experiment& setup) {
  return contact::pipeline_params(setup.session.scene.contact, setup.bodies.field.voxel_m(),
                                  setup.session.scene.coupling.mass_kg, 1);
}

const Experiment& checked(const Experiment& setup) {
  if (setup.delay_ticks < 0 || setup.delay_ticks > 100)
    throw SetupError("delay: found " + std::to_string(setup.delay_ticks) + ", expected 0 to 100 ticks");
  if (setup.replies.find_first_not_of("01") != std::string::npos)
    throw SetupError("replies: found \"" + setup.replies + "\", expected 1 and 0 only: 1 arrives, 0 is lost");
  return setup;
}

}  // namespace

Lockstep::Lockstep(const Experiment& setup)
    : setup_(checked(setup)),
      period_ns_(std::llround(1e9 / setup.session.machine.rate_hz)),
      params_(params_of(setup)),
      pipeline_(setup.bodies.field, setup.bodies.shell, static_cast<std::size_t>(setup.session.scene.contact.capacity),
                params_),
      config_(coupling::loop_config(setup.session, model_of(setup, params_))),
      mail_(std::make_unique<coupling::Mailboxes>()) {
  config_.status_period_s = 0;   // each tick
  config_.reply_wait_share = 0;  // one thread: nobody would answer meanwhile
  device_ = coupling::open_device(device_of(setup, config_));
  loop_ = std::make_unique<coupling::CouplingLoop>(config_, *device_, *mail_, nullptr);
}

const TickTrace& Lockstep::tick() {
  now_ns_ += period_ns_;
  loop_->step({ticks_++, now_ns_, now_ns_, period_ns_, 0});
  mail_->status.read(status_);
  serve();
  trace_.time_s = static_cast<double>(ticks_) / config_.rate_hz;
  trace_.X_WH = status_.X_WH;
  trace_.X_WT = status_.X_WT;
  trace_.V_WT = status_.V_WT;
  trace_.F_contact_W = status_.F_contact_W;
  trace_.F_coupling_W = status_.F_coupling_W;
  trace_.contact_count = static_cast<std::uint32_t>(answer_->contact_count);
  trace_.max_depth_m = answer_->max_depth_m;
  trace_.net_stiffness_n_per_m = status_.net_stiffness_n_per_m;
  trace_.port_energy_j = status_.stats.port_energy_j;
  trace_.faults = status_.faults;
  trace_.script_done = status_.script_done;
  trace_.live = status_.engaged;
  return trace_;
}

void Lockstep::run(double seconds) {
  for (auto n = std::llround(seconds * config_.rate_hz); n > 0; --n) tick();
}

bool Lockstep::run_script(double hold_s, const std::function<void(const TickTrace&)>& each) {
  // A person waits while haptics are not live: a session that never is would never end.
  constexpr double kPatience_s = 5;
  double waited_s = 0;
  const auto one = [&] {
    tick();
    if (each) each(trace_);
  };
  if (ticks_ == 0) one();
  while (!trace_.script_done && status_.script_time_s >= 0) {
    one();
    waited_s = trace_.live ? 0 : waited_s + 1 / config_.rate_hz;
    if (waited_s > kPatience_s) return false;
  }
  for (auto n = std::llround(hold_s * config_.rate_hz); n > 0; --n) one();
  return true;
}

void Lockstep::serve() {
  coupling::ToolSample sample;
  if (mail_->tool.read(sample)) under_way_.push_back(reply_to(sample));
  if (under_way_.size() <= static_cast<std::size_t>(setup_.delay_ticks)) return;
  const ContactReply& due = under_way_.front();
  const bool lost = !setup_.replies.empty() && setup_.replies[(due.pose_seq - 1) % setup_.replies.size()] == '0';
  if (!lost) mail_->reply.write(due);
  under_way_.pop_front();
}

ContactReply Lockstep::reply_to(const coupling::ToolSample& sample) {
  answer_ = &pipeline_.step({sample.X_WT, sample.V_WT, sample.X_WO, sample.V_WO});
  const contact::ContactResult& result = *answer_;
  ContactReply reply;
  reply.server_epoch = 1;
  reply.pose_seq = sample.seq;
  reply.pose_t_mono_ns = now_ns_;
  reply.received_mono_ns = now_ns_ + setup_.delay_ticks * period_ns_ + std::llround(kReplyTakes_s * 1e9);
  reply.X_WT = result.X_WT;
  reply.X_WO = result.X_WO;
  reply.F_W = result.response_W.F;
  reply.G = result.response_W.G;
  reply.K = result.response_W.K;
  reply.B = result.response_W.B;
  reply.contact_count = static_cast<std::uint32_t>(result.contact_count);
  reply.dropped = static_cast<std::uint32_t>(result.dropped);
  reply.status = result.status;
  reply.max_depth_m = result.max_depth_m;
  reply.clearance_m = result.clearance_m;
  reply.stiffness_n_per_m = result.stiffness_n_per_m;
  reply.x_max_m = result.x_max_m;
  reply.params_version = result.params_version;
  const contact::ContactBuffer& contacts = pipeline_.contacts();
  if (setup_.cap_follows_stiffness && contacts.size > 0) {
    double weights = 0;
    for (std::size_t i = 0; i < contacts.size; ++i) weights += contacts.weight[i];
    reply.stiffness_n_per_m *= weights / static_cast<double>(contacts.size);
  }
  return reply;
}

coupling::LoopStats Lockstep::stats() const {
  coupling::LoopStats stats = status_.stats;
  stats.duration_s = static_cast<double>(ticks_) / config_.rate_hz;
  stats.loop_jitter = stats.tick = stats.contact_compute = {};
  stats.page_faults = stats.allocations = 0;
  return stats;
}

void set_stiffness(SceneSpec& scene, double stiffness_n_per_m, double force_max_n, double voxel_m) {
  scene.contact.stiffness_n_per_m = stiffness_n_per_m;
  scene.contact.f_max_n = force_max_n;
  scene.contact.x_max_voxels = force_max_n / stiffness_n_per_m / voxel_m;
}

}  // namespace tact::lockstep
