#pragma once
#include <cstdint>

#include "math/pose.hpp"
#include "virtuose/arm_wire.hpp"

namespace tact::standin {

/// The stand-in arm: a handle of some mass, a hand that holds it and trembles, motors with a power supply, and the
/// controller: the force it is told (IMPEDANCE), or a spring and damper to a set-point that moves on at its twist
/// (VIRTMECH), indexing, and the watchdog. Time is its own: advance() is one period of the controller.
class ArmModel {
 public:
  // What a test does to it.
  bool dead_man = false, chain = true, shift = false;
  bool power_needs_dead_man = false;  ///< some arms report no power without a hand
  double power_delay_s = 0.3;
  double watchdog_s = 2;
  std::uint32_t alarm = 0;
  bool hand = true;
  Vec3 p_aim = Vec3::Zero();  ///< where the hand wants the handle
  double hand_speed_m_per_s = 0.1, hand_force_max_n = 20;

  void place(const Pose& X);  ///< puts the handle, and the hand, there
  void cut_power();

  // What the library does to it.
  void open();
  void close();
  void apply(const Command& command);

  void advance(double h);
  void state(State& out) const;
  bool watchdog_bit() const { return watchdog_bit_; }

  // What it felt: since reset_books().
  struct Books {
    double force_max_n = 0,
           force_step_max_n = 0;  ///< of the motors on the handle, and its change from period to period
    double torque_max_nm = 0;
    double reach_max_m = 0;  ///< handle to set-point while attached
    double moved_max_m = 0;  ///< of the handle, from where it was
    std::uint64_t writes = 0, watchdog_bites = 0, power_ons = 0;
  };
  const Books& books() const { return books_; }
  void reset_books();

  Pose X_handle() const { return X_; }
  Wrench F_motor() const { return F_motor_; }
  bool powered() const { return powered_; }
  bool attached() const { return attached_; }
  int command_type() const { return type_; }
  const float* gains() const { return gains_; }
  Vec3 set_speed() const { return V_set_.linear; }

 private:
  bool active() const { return powered_ && dead_man && !shift; }
  Wrench motor_wrench() const;
  Wrench hand_wrench() const;
  void substep(double h);
  void books_of_period();

  Pose X_, X_reported_, X_start_;
  Twist V_;
  Vec3 p_hand_ = Vec3::Zero();  // aim as it moves
  Quat q_hand_ = Quat::Identity();
  double time_s_ = 0;

  int type_ = 0, indexing_ = 0;
  bool open_ = false, requested_ = false, powered_ = false, attached_ = false, watchdog_bit_ = false;
  double power_in_s_ = 0, silent_s_ = 0;
  Wrench F_told_;
  Pose X_set_;
  Twist V_set_;
  float gains_[12] = {};
  double saturate_n_ = 35, saturate_nm_ = 3.5;
  Wrench F_motor_, F_motor_last_;
  bool any_motor_ = false;
  Books books_;
};

}  // namespace tact::standin
