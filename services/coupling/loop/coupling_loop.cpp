#include "coupling/loop/coupling_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "fault/fault.hpp"
#include "math/exp_log.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::coupling {
namespace {

/// Replies to poses older than this are history: the tool has been elsewhere since.
constexpr std::uint64_t kLagMax = 20;

/// Nothing a hand reaches is farther from the world's origin: beyond it arithmetic is no longer safe.
constexpr double kReach_m = 1000;

bool is_pose(const Pose& X) {
  return X.finite() && X.p.cwiseAbs().maxCoeff() < kReach_m && std::abs(X.q.squaredNorm() - 1) < 1e-3;
}

/// Nobody moves a handle faster. Where a device says so it is lying, or the hand was elsewhere meanwhile: after a time
/// in which it could have come there it is believed.
constexpr double kHandSpeed_m_per_s = 10, kHandSpeed_rad_per_s = 100;

bool within_reach(const Pose& from, const Pose& to, double seconds) {
  return (to.p - from.p).norm() <= kHandSpeed_m_per_s * seconds &&
         log_so3(to.q * from.q.conjugate()).norm() <= kHandSpeed_rad_per_s * seconds;
}

/// N/m: a million points at the stiffest a test presses. WrenchModel remembers K: what is finite but insane would hold
/// the tool for a second.
constexpr double kStiffest = 1e15;

bool is_finite(const ContactReply& r) {
  return r.F_W.vector().allFinite() && r.G.allFinite() && r.K.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kStiffest &&
         r.B.allFinite() && is_pose(r.X_WT) && std::isfinite(r.clearance_m) && std::isfinite(r.max_depth_m);
}

Wrench opposite(const Wrench& F) { return {-F.force, -F.torque}; }

GateLimits with_springs(GateLimits limits, const DeviceCapabilities& device) {
  if (device.mode == DeviceMode::pseudo_admittance) {
    limits.spring_n_per_m = device.spring_n_per_m;
    limits.spring_nm_per_rad = device.spring_nm_per_rad;
    limits.damper_n_s_per_m = device.damper_n_s_per_m;
    limits.damper_nm_s_per_rad = device.damper_nm_s_per_rad;
  }
  return limits;
}

/// Braking within a tick half of what would stop the felt body, yielding a fifth of the driver's spring.
PassivityController::Params passivity_params(const LoopConfig& config, const DeviceCapabilities& device) {
  PassivityController::Params params;
  params.rho_m = config.gyration_radius_m / config.mapping.scale;
  params.brake_max_n_s_per_m = 0.5 * config.mapping.scale * config.tool.mass_kg * config.rate_hz;
  if (device.spring_n_per_m > 0) params.yield_max_m_per_n = 0.2 / device.spring_n_per_m;
  return params;
}

}  // namespace

CouplingLoop::CouplingLoop(const LoopConfig& config, HapticDevice& device, Mailboxes& mail, TickQueue* records)
    : config_(config),
      h_(1 / config.rate_hz),
      mode_(device.capabilities().mode),
      device_(device),
      mail_(mail),
      records_(records),
      tool_(config.tool),
      strength_(config.parameters, tool_.mass(), tool_.inertia_T(), config.gyration_radius_m, config.force_max_n),
      motion_limit_{config.tool_radius_m},
      mapping_(config.mapping, config.X_WT_start),
      wrench_gate_(config.gate),
      set_point_gate_(with_springs(config.gate, device.capabilities())),
      passivity_(passivity_params(config, device.capabilities())),
      account_(config.rate_hz),
      kind_(config.parameters.kind),
      integrator_(config.parameters.integrator),
      sent_B_(device.last_set_point()),
      status_every_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(config.status_period_s * config.rate_hz))),
      status_in_(1),
      snapshot_every_(
          std::max<std::uint64_t>(1, static_cast<std::uint64_t>(TickQueue::kSnapshotPeriod_s * config.rate_hz))) {
  tool_.select(kind_, integrator_);
  tool_.reset(config.X_WT_start);
  passivity_.enable(config.parameters.passivity_controller);
  good_B_ = device.read();
  X_BH_last_ = good_B_.X_WH;
}

rt::Next CouplingLoop::step(const rt::Tick& tick) noexcept {
  const rt::RtSection guard;
  faults_ = 0;
  take_parameters();
  take_hand_target();
  const DeviceReading device = read_device(tick);  // X_WH, V_WH, F_hand
  if (!direct_now()) take_reply();                 // F + G x at X_n, or its stale reaction
  record_.resting = resting_.load(std::memory_order_relaxed);
  const bool may_act = device.engaged && device.trusted && !record_.resting;
  strength_.advance(wrench_, may_act, tool_.F_coupling_W(), h_);
  integrate(device);  // X_{n+1}
  publish();          // the moment it is integrated
  if (direct_now()) {
    take_reply();  // at X_{n+1}: it is the handle's pose now
    if (!calm()) tool_.pass_on(contact_.F_W);
  }
  send(device);  // through the gate
  close_tick(tick, device);
  return rt::Next::again;
}

bool CouplingLoop::calm() const noexcept { return strength_.strength() == 0; }

void CouplingLoop::take_parameters() noexcept {
  switched_ = false;
  record_.has_parameters = mail_.parameters.read(record_.parameters);
  if (!record_.has_parameters) return;
  const LoopParameters& parameters = record_.parameters;
  strength_.set(parameters);
  passivity_.enable(parameters.passivity_controller);
  switched_ = parameters.kind != kind_ || parameters.integrator != integrator_;
  kind_ = parameters.kind;
  integrator_ = parameters.integrator;
  if (switched_) tool_.select(kind_, integrator_);
}

void CouplingLoop::take_hand_target() noexcept {
  HandTargetSample hand;
  if (mail_.hand.read(hand)) {
    const bool usable = is_pose(hand.X_WM) && !device_.capabilities().real;
    cue_.hold = hand.hold && usable;
    if (usable) {
      cue_.X_WH_target = mapping_.to_device(Pose{hand.X_WM.p, hand.X_WM.q.normalized()} * config_.X_TM.inverse());
    }
  }
  cue_.live = strength_.strength() >= 1 && ramped_;
  device_.cue(cue_);
}

DeviceReading CouplingLoop::read_device(const rt::Tick& tick) noexcept {
  const DeviceReading reading = record_.reading = device_.read();
  faults_ |= reading.faults;
  since_good_ += 1 + tick.skipped;
  const bool sound =
      is_pose(reading.X_WH) && reading.V_WH.vector().allFinite() && reading.F_hand_W.vector().allFinite();
  if (!sound) raise(Fault::not_finite);
  if (sound && within_reach(good_B_.X_WH, reading.X_WH, static_cast<double>(since_good_) * h_)) {
    if (reading.trusted) since_good_ = 0;
    good_B_ = reading;
    return hand_ = mapping_.read(reading);
  }
  raise(Fault::device_data);
  DeviceReading held = good_B_;  // where it was, at rest, no hand
  held.trusted = false;
  held.V_WH = {};
  held.F_hand_W = {};
  return mapping_.read(held);
}

/// The newest reply there is; where the wrench of this very pose is needed, it is waited for within its budget. Calm
/// nobody feels it: any reply that came meanwhile ends that.
bool CouplingLoop::newest_reply(ContactReply& reply) noexcept {
  bool any = mail_.reply.read(reply);
  if (!direct_now() || calm()) return any;
  const std::int64_t end_ns =
      rt::monotonic_ns() + static_cast<std::int64_t>(std::min(config_.reply_wait_share, 0.4) * h_ * 1e9);
  while (!(any && reply.pose_seq >= seq_)) {
    const std::int64_t left_ns = end_ns - rt::monotonic_ns();
    if (left_ns <= 0) break;
    mail_.reply_ready.wait(left_ns);
    any |= mail_.reply.read(reply);
  }
  return any;
}

void CouplingLoop::take_reply() noexcept {
  const ContactReply& reply = record_.reply;
  bool fresh = record_.has_reply = newest_reply(record_.reply);
  if (fresh && (!is_finite(reply) || (reply.status & kReplyPoseInvalid) != 0)) {
    raise(Fault::not_finite);
    fresh = false;
  }
  if (fresh && (reply.pose_seq > seq_ || reply.pose_seq <= reply_.pose_seq || seq_ - reply.pose_seq > kLagMax)) {
    fresh = false;
  }
  if (fresh) {
    if (reply_.server_epoch != 0 && reply.server_epoch != reply_.server_epoch) raise(Fault::peer_restarted);
    reply_ = reply;
    clearance_m_ = reply.clearance_m;
    strength_.set_force_max(reply.stiffness_n_per_m * reply.x_max_m);
    const ContactLinearisation linear{reply.X_WT, reply.F_W, reply.G, reply.K, reply.B};
    wrench_.begin_tick(&linear);
    account_.reply(reply, tool_.F_coupling_W(), strength_.force_max(), strength_.torque_max());
  } else {
    wrench_.begin_tick(nullptr);
  }
  contact_ = wrench_.at(tool_.tool().X_W, seq_ - reply_.pose_seq);

  if (reply_.status & kReplyOverflow) raise(Fault::contacts_full);
  if (reply_.status & kReplySignDoubtful) raise(Fault::sign_doubtful);
  if (reply_.status & kReplyPastMidSurface) raise(Fault::past_mid_surface);
  if (reply_.status & kReplyBeyondBand) raise(Fault::beyond_band);
  switch (wrench_.phase()) {
    case WrenchModel::Phase::waiting:
    case WrenchModel::Phase::fresh:
      break;
    case WrenchModel::Phase::late:
    case WrenchModel::Phase::fading:
      raise(Fault::wrench_late);
      break;
    case WrenchModel::Phase::stale:
      raise(Fault::wrench_stale);
      break;
  }
}

void CouplingLoop::integrate(const DeviceReading& device) noexcept {
  motion_cut_ = false;
  if (calm()) {
    tool_.reset(tool_.tool().X_W, device.X_WH);
    return;
  }
  const Pose X_before = tool_.tool().X_W;
  if (direct_now()) {
    tool_.follow(BodyState{device.X_WH, device.V_WH}, h_);
  } else if (mode_ == DeviceMode::impedance) {
    tool_.step(BodyState{device.X_WH, device.V_WH}, contact_, strength_.gains(), strength_.tool_damping(), h_);
  } else {
    tool_.step(device.F_hand_W, contact_, strength_.gains(), strength_.tool_damping(), h_);
  }
  BodyState next = tool_.tool();
  if (!is_pose(next.X_W) || !next.V_W.vector().allFinite() || !is_pose(tool_.handle().X_W)) {
    raise(Fault::not_finite);  // huge but finite gradients overflow the solve: stand where we were
    tool_.reset(X_before, device.X_WH);
    return;
  }
  motion_cut_ =
      motion_limit_.apply(wrench_.X_WT_answered(), X_before, next, std::max(0.5 * config_.voxel_m, clearance_m_));
  if (motion_cut_) {
    tool_.set_tool(next);
    raise(Fault::motion_capped);
  } else if (kind_ == CouplingKind::quasi_static) {
    account_.equilibrium(tool_.static_residual_n());
  }
}

void CouplingLoop::publish() noexcept {
  ToolSample sample;
  sample.seq = ++seq_;
  sample.t_mono_ns = rt::monotonic_ns();
  sample.step_ns = static_cast<std::int64_t>(std::llround(h_ * 1e9));
  sample.flags = (seq_ == 1 ? kToolReset : 0) | (calm() ? kToolQueryOnly : 0);
  sample.X_WT = tool_.tool().X_W;
  sample.V_WT = tool_.tool().V_W;
  sample.X_WO = config_.X_WO;
  mail_.tool.write(sample);
  mail_.tool_ready.ring();
}

Wrench CouplingLoop::blended(const Wrench& F_W) noexcept {
  if (calm()) {
    bump_.setZero();
  } else if (switched_) {
    bump_ = F_wanted_W_.vector() - F_W.vector();
  } else {
    bump_ *= std::exp(-h_ / kBlend_s);
  }
  return F_wanted_W_ = Wrench::from(F_W.vector() + bump_);
}

void CouplingLoop::send(const DeviceReading& device) noexcept {
  GateReport report;
  const Pose X_BH = good_B_.X_WH;
  if (mode_ == DeviceMode::impedance) {
    passivity_.observe(F_sent_B_.vector().dot(displacement(X_BH_last_, X_BH)));
    const double part = direct_now() ? strength_.strength() : 1;  // a virtual coupling has it in its wrench
    const Wrench F_W = blended(Wrench::from(-part * tool_.F_coupling_W().vector()));
    const Wrench F_B = passivity_.braked(mapping_.to_device(F_W), mapping_.to_device(device.V_WH), h_);
    F_sent_B_ = wrench_gate_.limit(F_B, device.engaged, h_);
    device_.write(F_sent_B_);
    F_sent_W_ = mapping_.to_world(F_sent_B_);
    report = wrench_gate_.report();
    ramped_ = wrench_gate_.ramped();
  } else {
    const Pose X_last = sent_B_.X_W;
    Pose X_wanted = mapping_.to_device(tool_.handle().X_W);
    const Twist V_wanted = mapping_.to_device(tool_.handle().V_W);
    const Wrench F_hand_B = mapping_.to_device(device.F_hand_W);
    const Vec6 give = passivity_.yielding(F_hand_B, displacement(X_last, X_wanted));
    const bool yields = !give.isZero();
    if (yields) X_wanted = displaced(X_wanted, give);
    set_point_gate_.limit(X_wanted, V_wanted, X_BH, device.engaged, h_, sent_B_.X_W, sent_B_.V_W);
    device_.write(sent_B_);
    report = set_point_gate_.report();
    ramped_ = set_point_gate_.ramped();
    if (yields || report.limited || report.not_finite) {  // the body is where we sent it
      tool_.set_handle({mapping_.to_world(sent_B_.X_W), mapping_.to_world(sent_B_.V_W)});
    }
    F_sent_W_ = opposite(tool_.F_coupling_W());
    passivity_.observe(-F_hand_B.vector().dot(displacement(X_last, sent_B_.X_W)));
  }
  X_BH_last_ = X_BH;
  account_.port(passivity_);
  if (report.limited) raise(Fault::gate_limited);
  if (report.not_finite) raise(Fault::not_finite);
}

void CouplingLoop::close_tick(const rt::Tick& tick, const DeviceReading& device) noexcept {
  if (tick.skipped > 0) raise(Fault::deadline_missed);
  const std::int64_t end_ns = rt::monotonic_ns();
  account_.tick(tick, end_ns, wrench_.phase(), faults_);

  if (records_ != nullptr) record(tick, end_ns, device);
  if (--status_in_ == 0) {
    status_in_ = status_every_;
    account_.count_page_faults();
    publish_status();
  }
  progress_.fetch_add(1, std::memory_order_relaxed);
}

void CouplingLoop::record(const rt::Tick& tick, std::int64_t end_ns, const DeviceReading& device) noexcept {
  record_.tick = tick;
  record_.pose_seq = seq_;
  record_.reply_seq = reply_.pose_seq;
  record_.wrench_age_ticks = wrench_.age_ticks();
  record_.faults = faults_;
  record_.contact_count = reply_.contact_count;
  record_.live = cue_.live;
  record_.X_WH = device.X_WH;
  record_.tool = tool_.tool();
  record_.F_contact_W = contact_.F_W;
  record_.F_coupling_W = tool_.F_coupling_W();
  record_.F_sent_W = F_sent_W_;
  record_.sent = sent_B_;
  record_.max_depth_m = reply_.max_depth_m;
  record_.tick_ns = end_ns - tick.woke_ns;
  if (--snapshot_in_ == 0) {
    snapshot_in_ = snapshot_every_;
    save(snapshot_);
    snapshot_.tick = tick.index;
    records_->snapshots.push(snapshot_);
  }
  records_->ticks.push(record_);
}

void CouplingLoop::save(LoopSnapshot& out) const noexcept {
  std::size_t size = 0;
  each_state(*this, [&](const auto& member) {
    static_assert(std::is_trivially_destructible_v<std::remove_cvref_t<decltype(member)>>, "bytes are all there is");
    if (size + sizeof member <= LoopSnapshot::kCapacity) {
      std::memcpy(out.bytes.data() + size, static_cast<const void*>(&member), sizeof member);
    }
    size += sizeof member;
  });
  out.size = size <= LoopSnapshot::kCapacity ? static_cast<std::uint32_t>(size) : 0;  // 0: restore() refuses it
}

bool CouplingLoop::restore(const LoopSnapshot& snapshot) noexcept {
  std::size_t size = 0;
  each_state(*this, [&](const auto& member) { size += sizeof member; });
  if (snapshot.size != size) return false;
  size = 0;
  each_state(*this, [&](auto& member) {
    std::memcpy(static_cast<void*>(&member), snapshot.bytes.data() + size, sizeof member);
    size += sizeof member;
  });
  return true;
}

void CouplingLoop::publish_status() noexcept {
  LoopStatus& status = account_.status();
  status.X_WH = hand_.X_WH;
  status.V_WH = hand_.V_WH;
  status.X_WT = tool_.tool().X_W;
  status.V_WT = tool_.tool().V_W;
  status.X_WM = status.X_WT * config_.X_TM;
  status.F_contact_W = contact_.F_W;
  status.F_coupling_W = tool_.F_coupling_W();
  status.F_hand_W = hand_.F_hand_W;
  status.contact_count = calm() ? 0 : reply_.contact_count;
  status.script_time_s = hand_.script_time_s;
  status.script_done = hand_.script_done;
  status.engaged = hand_.engaged && ramped_ && strength_.strength() >= 1;
  status.capped = motion_cut_ || tool_.saturated();
  status.parameters_version = strength_.parameters_version();
  mail_.status.write(status);
  account_.published();
}

}  // namespace tact::coupling
