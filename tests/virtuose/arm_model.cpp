#include "virtuose/arm_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/exp_log.hpp"

namespace tact::standin {
namespace {

constexpr double kMass = 1.2, kInertia = 0.0045, kFriction = 2, kAngularFriction = 0.02;
constexpr double kHandSpring = 800, kHandDamper = 60, kHandAngularSpring = 8, kHandAngularDamper = 0.4;
constexpr double kHandTorque = 2;
constexpr int kSubsteps = 4;

Vec3 at_most(const Vec3& v, double m) {
  const double norm = v.norm();
  return norm > m ? Vec3(v * (m / norm)) : v;
}

Pose pose_of(const float* v) { return {Vec3(v[0], v[1], v[2]), Quat(v[6], v[3], v[4], v[5]).normalized()}; }

/// Physiological tremor: some hundredths of a millimetre around 9 Hz.
Vec3 tremor(double t) {
  const double w = 2 * std::numbers::pi * 9;
  return 3e-5 * Vec3(std::sin(w * t), std::sin(1.13 * w * t + 1), std::sin(0.91 * w * t + 2));
}

}  // namespace

void ArmModel::place(const Pose& X) {
  X_ = X_reported_ = X_start_ = X;
  V_ = {};
  p_aim = p_hand_ = X.p;
  q_hand_ = X.q;
}

void ArmModel::cut_power() { requested_ = powered_ = false; }

void ArmModel::open() {
  open_ = true;
  watchdog_bit_ = attached_ = false;
  silent_s_ = 0;
  type_ = 0;
  F_told_ = {};
}

void ArmModel::close() {
  open_ = attached_ = false;
  cut_power();
  F_told_ = {};
}

void ArmModel::apply(const Command& c) {
  switch (c.order) {
    case Order::hello:
    case Order::bye:
    case Order::note:
      return;
    case Order::command_type:
      type_ = c.number;
      return;
    case Order::indexing:
      indexing_ = c.number;
      return;
    case Order::power:
      if (c.number == 0) return cut_power();
      if (!requested_) {
        power_in_s_ = power_delay_s;
        ++books_.power_ons;
      }
      requested_ = true;
      return;
    case Order::force:
      for (int i = 0; i < 3; ++i) {
        F_told_.force[i] = static_cast<double>(c.values[i]);
        F_told_.torque[i] = static_cast<double>(c.values[i + 3]);
      }
      break;
    case Order::position:
      X_set_ = pose_of(c.values);
      break;
    case Order::speed:
      for (int i = 0; i < 3; ++i) {
        V_set_.linear[i] = static_cast<double>(c.values[i]);
        V_set_.angular[i] = static_cast<double>(c.values[i + 3]);
      }
      break;
    case Order::attach:
      std::copy(std::begin(c.values), std::end(c.values), gains_);
      attached_ = true;
      return;
    case Order::detach:
      attached_ = false;
      return;
    case Order::saturate:
      saturate_n_ = static_cast<double>(c.values[0]);
      saturate_nm_ = static_cast<double>(c.values[1]);
      return;
  }
  silent_s_ = 0;  // an update of the control: what the watchdog waits for
  ++books_.writes;
}

Wrench ArmModel::motor_wrench() const {
  Wrench F;
  if (!active()) return F;
  if (type_ == 3) F = F_told_;
  if (type_ == 5 && attached_) {
    const Vec6 x = displacement(X_reported_, X_set_);
    for (int i = 0; i < 3; ++i) {  // gains: rotation first
      F.torque[i] = static_cast<double>(gains_[i]) * x[i + 3] +
                    static_cast<double>(gains_[i + 6]) * (V_set_.angular[i] - V_.angular[i]);
      F.force[i] = static_cast<double>(gains_[i + 3]) * x[i] +
                   static_cast<double>(gains_[i + 9]) * (V_set_.linear[i] - V_.linear[i]);
    }
  }
  return {at_most(F.force, saturate_n_), at_most(F.torque, saturate_nm_)};
}

Wrench ArmModel::hand_wrench() const {
  if (!hand) return {};
  const Vec3 turn = log_so3(q_hand_ * X_.q.conjugate());
  return {at_most(kHandSpring * (p_hand_ + tremor(time_s_) - X_.p), hand_force_max_n) - kHandDamper * V_.linear,
          at_most(kHandAngularSpring * turn, kHandTorque) - kHandAngularDamper * V_.angular};
}

void ArmModel::substep(double h) {
  F_motor_ = motor_wrench();
  const Wrench F_hand = hand_wrench();
  V_.linear += h / kMass * (F_motor_.force + F_hand.force - kFriction * V_.linear);
  V_.angular += h / kInertia * (F_motor_.torque + F_hand.torque - kAngularFriction * V_.angular);
  const Vec6 step = h * V_.vector();
  X_ = displaced(X_, step);
  // Indexing: while there is no force, what is reported stays, as far as the mode says.
  Vec6 reported = step;
  if (!active()) {
    if (indexing_ == 0 || indexing_ == 1) reported.head<3>().setZero();
    if (indexing_ == 0 || indexing_ == 7) reported.tail<3>().setZero();
  }
  X_reported_ = displaced(X_reported_, reported);
  X_set_ = displaced(X_set_, h * V_set_.vector());
  time_s_ += h;
}

void ArmModel::advance(double h) {
  if (!chain) cut_power();
  if (open_) silent_s_ += h;
  if (open_ && silent_s_ > watchdog_s) {
    close();
    watchdog_bit_ = true;
    ++books_.watchdog_bites;
  }
  if (requested_) power_in_s_ -= h;
  powered_ = requested_ && power_in_s_ <= 0 && (dead_man || !power_needs_dead_man);
  const Vec3 way = p_aim - p_hand_;
  p_hand_ += at_most(way, hand_speed_m_per_s * h);
  for (int i = 0; i < kSubsteps; ++i) substep(h / kSubsteps);
  books_of_period();
}

void ArmModel::books_of_period() {
  books_.force_max_n = std::max(books_.force_max_n, F_motor_.force.norm());
  books_.torque_max_nm = std::max(books_.torque_max_nm, F_motor_.torque.norm());
  if (any_motor_) {
    books_.force_step_max_n = std::max(books_.force_step_max_n, (F_motor_.force - F_motor_last_.force).norm());
  }
  F_motor_last_ = F_motor_;
  any_motor_ = true;
  if (attached_ && active()) books_.reach_max_m = std::max(books_.reach_max_m, (X_set_.p - X_reported_.p).norm());
  books_.moved_max_m = std::max(books_.moved_max_m, (X_.p - X_start_.p).norm());
}

void ArmModel::reset_books() {
  books_ = {};
  X_start_ = X_;
  any_motor_ = false;
}

void ArmModel::state(State& out) const {
  out.power = powered_ ? 1 : 0;
  out.dead_man = dead_man ? 1 : 0;
  out.chain = chain ? 1 : 0;
  out.shift = shift || !powered_ || !dead_man ? 1 : 0;
  out.alarm = alarm;
  const Quat& q = X_reported_.q;
  const double pose[7] = {X_reported_.p.x(), X_reported_.p.y(), X_reported_.p.z(), q.x(), q.y(), q.z(), q.w()};
  for (int i = 0; i < 7; ++i) out.pose[i] = static_cast<float>(pose[i]);
  const bool still = !active() && indexing_ == 0;
  const Wrench F = motor_wrench();
  for (int i = 0; i < 3; ++i) {
    out.twist[i] = still ? 0 : static_cast<float>(V_.linear[i]);
    out.twist[i + 3] = still ? 0 : static_cast<float>(V_.angular[i]);
    out.force[i] = type_ == 5 ? static_cast<float>(-F.force[i]) : 0;
    out.force[i + 3] = type_ == 5 ? static_cast<float>(-F.torque[i]) : 0;
  }
}

}  // namespace tact::standin
