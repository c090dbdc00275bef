#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fault/fault.hpp"
#include "report/session_report.hpp"
#include "rt/histogram.hpp"

namespace tact::report {
namespace {

void add(Histogram& sum, const Histogram& more) {
  for (std::size_t b = 0; b < std::size(sum.counts); ++b) sum.counts[b] += more.counts[b];
  sum.n += more.n;
  sum.max_us = std::max(sum.max_us, more.max_us);
}

void add(Stats& sum, const Stats& more) {
  const auto before = static_cast<double>(sum.ticks), added = static_cast<double>(more.ticks);
  const double all = before + added;
  if (all > 0) {
    sum.contacts_mean = (sum.contacts_mean * before + more.contacts_mean * added) / all;
    const auto square = [](double x) { return x * x; };
    sum.force_step_rms_n =
        std::sqrt((square(sum.force_step_rms_n) * before + square(more.force_step_rms_n) * added) / all);
  }
  sum.duration_s += more.duration_s;
  sum.ticks += more.ticks;
  sum.missed_ticks += more.missed_ticks;
  sum.wrench_fresh += more.wrench_fresh;
  sum.wrench_late += more.wrench_late;
  sum.wrench_stale += more.wrench_stale;
  add(sum.loop_jitter, more.loop_jitter);
  add(sum.tick, more.tick);
  add(sum.round_trip, more.round_trip);
  add(sum.contact_compute, more.contact_compute);
  sum.contacts_max = std::max(sum.contacts_max, more.contacts_max);
  const auto raise = [&](double Stats::*field) { sum.*field = std::max(sum.*field, more.*field); };
  raise(&Stats::penetration_quasi_static_max_m);
  raise(&Stats::penetration_max_m);
  raise(&Stats::force_max_n);
  raise(&Stats::torque_max_nm);
  raise(&Stats::pull_max_n);
  raise(&Stats::force_step_max_n);
  raise(&Stats::net_stiffness_max_n_per_m);
  sum.port_energy_j += more.port_energy_j;
  sum.passivity_ticks += more.passivity_ticks;
  sum.passivity_dissipated_j += more.passivity_dissipated_j;
  raise(&Stats::static_residual_max_n);
  sum.static_unsolved_ticks += more.static_unsolved_ticks;
  sum.faults_ever |= more.faults_ever;
  sum.page_faults += more.page_faults;
  // The newest epoch's, as the map is in order of epochs.
  sum.epoch = more.epoch;
  sum.rate_hz = more.rate_hz;
  sum.X_WM = more.X_WM;
}

}  // namespace

Percentiles percentiles(const Histogram& histogram) {
  static_assert(std::size(Histogram{}.counts) == rt::Histogram::kBuckets);
  rt::Histogram h;
  std::copy(std::begin(histogram.counts), std::end(histogram.counts), h.counts.begin());
  h.n = histogram.n;
  h.max_ns = histogram.max_us * 1e3;
  const auto us = [&](double p) { return h.percentile_ns(p) * 1e-3; };
  return {us(0.5), us(0.99), us(0.999), histogram.max_us};
}

Stats StatsByEpoch::total() const {
  Stats sum{};
  for (const auto& [epoch, stats] : newest_) add(sum, stats);
  return sum;
}

GoalWatch::GoalWatch(std::optional<Pose> goal_X_WM, double tolerance_mm, double tolerance_deg)
    : goal_(std::move(goal_X_WM)),
      tolerance_mm_(tolerance_mm),
      tolerance_deg_(tolerance_deg),
      share_(std::numeric_limits<double>::infinity()) {}

void GoalWatch::see(const Pose& X_WM) {
  if (!goal_) return;
  const double distance_mm = (X_WM.p - goal_->p).norm() * 1e3;
  const double angle_deg = X_WM.q.angularDistance(goal_->q) * 180 / std::numbers::pi;
  const double share = std::max(distance_mm / tolerance_mm_, angle_deg / tolerance_deg_);
  if (share < share_) {
    share_ = share;
    distance_mm_ = distance_mm;
    angle_deg_ = angle_deg;
  }
}

void FaultLog::note(double time_s, const std::string& name, const std::string& detail) {
  if (events_.size() == kCapacity) return;
  if (events_.size() + 1 == kCapacity) {
    events_.push_back({time_s, "list_full", "later faults are not listed"});
    return;
  }
  events_.push_back({time_s, name, detail});
}

void FaultLog::see(double time_s, const std::string& service, std::uint32_t bits) {
  std::uint32_t& last = last_bits_[service];
  const std::uint32_t rising = bits & ~last;
  last = bits;
  for (std::uint32_t b = 1; b != 0; b <<= 1) {
    if ((rising & b) == 0) continue;
    const std::string name = fault_names(b);
    const auto [seen, first] = last_time_s_.try_emplace(service + "/" + name, time_s);
    if (!first && time_s - seen->second < 1) continue;
    seen->second = time_s;
    note(time_s, name, "reported by " + service);
  }
}

}  // namespace tact::report
