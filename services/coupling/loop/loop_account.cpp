#include "coupling/loop/loop_account.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "rt/alloc_guard.hpp"
#include "rt/realtime.hpp"

namespace tact::coupling {
namespace {

/// Balance: the resultant is below this fraction of the saturation.
constexpr double kQuasiStatic = 0.1;

double largest_eigenvalue(const Mat3& K) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(K, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(2);
}

void raise(double& maximum, double value) { maximum = std::max(maximum, value); }

}  // namespace

LoopAccount::LoopAccount(double rate_hz) { status_.stats.rate_hz = rate_hz; }

void LoopAccount::reply(const ContactReply& reply, const Wrench& F_coupling_W, double force_max,
                        double torque_max) noexcept {
  LoopStats& stats = status_.stats;
  status_.round_trip_ns = reply.received_mono_ns - reply.pose_t_mono_ns;
  stats.round_trip.add(status_.round_trip_ns);
  stats.contact_compute.add(reply.compute_ns);

  ++replies_;
  contacts_ += reply.contact_count;
  stats.contacts_mean = static_cast<double>(contacts_) / static_cast<double>(replies_);
  stats.contacts_max = std::max(stats.contacts_max, reply.contact_count);

  raise(status_.max_depth_m, reply.max_depth_m);
  raise(stats.penetration_max_m, reply.max_depth_m);
  const bool balanced = (reply.F_W.force + F_coupling_W.force).norm() < kQuasiStatic * force_max &&
                        (reply.F_W.torque + F_coupling_W.torque).norm() < kQuasiStatic * torque_max;
  if (balanced) raise(stats.penetration_quasi_static_max_m, reply.max_depth_m);

  const double force = reply.F_W.force.norm();
  raise(status_.force_max_n, force);
  raise(stats.force_max_n, force);
  raise(stats.torque_max_nm, reply.F_W.torque.norm());
  if (reply.contact_count > 0) raise(stats.pull_max_n, F_coupling_W.force.norm());
  if (any_reply_ && (force > 0 || last_force_.squaredNorm() > 0)) {
    const double step = (reply.F_W.force - last_force_).norm();
    raise(stats.force_step_max_n, step);
    step_squares_ += step * step;
    stats.force_step_rms_n = std::sqrt(step_squares_ / static_cast<double>(++steps_));
  }
  any_reply_ = true;
  last_force_ = reply.F_W.force;

  status_.net_stiffness_n_per_m = reply.contact_count > 0 ? largest_eigenvalue(reply.K.topLeftCorner<3, 3>()) : 0;
  raise(stats.net_stiffness_max_n_per_m, status_.net_stiffness_n_per_m);
}

void LoopAccount::port(const PassivityController& passivity) noexcept {
  LoopStats& stats = status_.stats;
  stats.port_energy_j = passivity.energy_j();
  stats.passivity_ticks = passivity.activity().ticks;
  stats.passivity_dissipated_j = passivity.activity().dissipated_j;
}

void LoopAccount::equilibrium(double residual_n) noexcept {
  raise(status_.stats.static_residual_max_n, residual_n);
  if (!(residual_n <= ToolIntegrator::kStaticResidual_n)) ++status_.stats.static_unsolved_ticks;
}

void LoopAccount::tick(const rt::Tick& tick, std::int64_t end_ns, WrenchModel::Phase phase,
                       std::uint32_t faults) noexcept {
  LoopStats& stats = status_.stats;
  if (stats.ticks == 0) {
    first_ns_ = tick.woke_ns;
    first_page_faults_ = rt::thread_page_faults();
    first_allocations_ = rt::rt_allocations();
  }
  ++stats.ticks;
  stats.missed_ticks += tick.skipped;
  stats.duration_s = static_cast<double>(end_ns - first_ns_) * 1e-9;
  switch (phase) {
    case WrenchModel::Phase::waiting:
      break;
    case WrenchModel::Phase::fresh:
      ++stats.wrench_fresh;
      break;
    case WrenchModel::Phase::late:
      ++stats.wrench_late;
      break;
    case WrenchModel::Phase::fading:
    case WrenchModel::Phase::stale:
      ++stats.wrench_stale;
      break;
  }
  const std::int64_t tick_ns = end_ns - tick.woke_ns;
  stats.loop_jitter.add(tick.woke_ns - tick.due_ns);
  stats.tick.add(tick_ns);
  status_.tick_ns_max = std::max(status_.tick_ns_max, tick_ns);
  status_.faults |= faults;
  stats.faults_ever |= faults;
  stats.allocations = rt::rt_allocations() - first_allocations_;
  status_.tick = tick.index;
  status_.t_mono_ns = end_ns;
}

void LoopAccount::count_page_faults() noexcept {
  status_.stats.page_faults = rt::thread_page_faults() - first_page_faults_;
}

void LoopAccount::published() noexcept {
  status_.max_depth_m = status_.force_max_n = 0;
  status_.tick_ns_max = 0;
  status_.faults = 0;
}

}  // namespace tact::coupling
