#include "lockstep/felt_mass.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::lockstep {
namespace {

constexpr double kHalf_m = 0.03, kHalf_rad = 0.2, kPeriod_s = 1, kSwingIn_s = 1, kFit_s = 2;
constexpr double kFarAway_m = 100, kPatience_s = 5;

/// To and fro along `direction` (linear, angular about To, in W), from where the tool starts.
HandMotion swing(const Experiment& setup, const Vec6& direction) {
  const Pose X_TM = setup.bodies.shell->X_TM, X_WT = setup.session.scene.start_X_WM * X_TM.inverse();
  HandMotion motion;
  const double step_s = 0.01;
  for (double t = 0; t < 2 * (kSwingIn_s + kFit_s); t += step_s) {
    const Vec6 x = (1 - std::cos(2 * std::numbers::pi * t / kPeriod_s)) * direction;
    motion.time_s.push_back(t);
    motion.X_WM.push_back(displaced(X_WT, x) * X_TM);
  }
  return motion;
}

/// m of F = m a + b v along the swing, hand included.
double fitted(const Experiment& setup, const Vec6& direction) {
  Experiment free = setup;
  free.session.scene.X_WO.p.z() -= kFarAway_m;
  free.session.machine.simulated.events.clear();
  free.motion_WM = swing(setup, direction);
  Lockstep rig(free);
  for (auto n = std::llround(kPatience_s * rig.config().rate_hz); !rig.trace().live; --n) {
    if (n == 0) throw SetupError("felt mass: haptics did not become live in free motion");
    rig.tick();
  }
  rig.run(kSwingIn_s);

  const bool turns = !direction.tail<3>().isZero();
  struct Moment {
    Vec3 F, V;
  };
  const auto now = [&] {
    const coupling::SimulatedDevice& device = rig.device();
    const Wrench F = device.true_hand_wrench_W();
    const Twist& V = device.true_V_WH();
    return turns ? Moment{F.torque, V.angular} : Moment{F.force, V.linear};
  };
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d r = Eigen::Vector2d::Zero();
  const double rate_hz = rig.config().rate_hz;
  Moment last = now();
  for (auto n = std::llround(kFit_s * rate_hz); n > 0; --n) {
    rig.tick();
    const Moment next = now();
    const Vec3 a = rate_hz * (next.V - last.V), v = 0.5 * (next.V + last.V), F = 0.5 * (next.F + last.F);
    A += (Eigen::Matrix2d() << a.dot(a), a.dot(v), a.dot(v), v.dot(v)).finished();
    r += Eigen::Vector2d(a.dot(F), v.dot(F));
    last = next;
  }
  return A.inverse().row(0).dot(r);
}

}  // namespace

std::string FeltMass::text() const {
  char words[128];
  std::snprintf(words, sizeof words, "%.3g kg; %.2g, %.2g, %.2g kg m^2 about the tool's axes", mass_kg,
                inertia_kg_m2.x(), inertia_kg_m2.y(), inertia_kg_m2.z());
  return words;
}

FeltMass felt_mass(const Experiment& setup) {
  const coupling::SimulatedHand::Params hand = setup.hand ? *setup.hand : coupling::device_options(setup.session).hand;
  const Mat3 R_WT = (setup.session.scene.start_X_WM * setup.bodies.shell->X_TM.inverse()).R();
  FeltMass felt;
  felt.mass_kg = fitted(setup, (Vec6() << kHalf_m, 0, 0, 0, 0, 0).finished()) - hand.mass_kg;
  for (int i = 0; i < 3; ++i) {
    Vec6 direction = Vec6::Zero();
    direction.tail<3>() = kHalf_rad * R_WT.col(i);
    felt.inertia_kg_m2[i] = fitted(setup, direction) - hand.inertia_kg_m2;
  }
  return felt;
}

}  // namespace tact::lockstep
