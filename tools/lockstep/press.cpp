#include "lockstep/press.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::lockstep {
namespace {

constexpr double kReach_m = 0.03;

/// Root mean square about the straight line through them that fits best, all components together.
double ripple(std::span<const Vec3> values) {
  const auto n = static_cast<double>(values.size());
  if (values.size() < 3) return 0;
  Vec3 mean = Vec3::Zero(), slope = Vec3::Zero();
  double square_t = 0;
  for (const Vec3& v : values) mean += v / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) - (n - 1) / 2;
    slope += t * (values[i] - mean);
    square_t += t * t;
  }
  slope /= square_t;
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (values[i] - mean - (static_cast<double>(i) - (n - 1) / 2) * slope).squaredNorm();
  }
  return std::sqrt(squares / n);
}

/// What is kept of the window.
struct Window {
  std::vector<Vec3> force_n, torque_n;  ///< torque over the radius of gyration
  double contacts = 0, depth_m = 0, net = 0;
  std::size_t touching = 0;
  bool beyond = false;

  void see(const Lockstep& rig) {
    const contact::ContactResult& answer = rig.answer();
    force_n.push_back(answer.response_W.F.force);
    torque_n.push_back(answer.response_W.F.torque / rig.config().gyration_radius_m);
    contacts += static_cast<double>(answer.contact_count);
    depth_m += answer.max_depth_m;
    net += rig.trace().net_stiffness_n_per_m;
    touching += answer.contact_count > 0 ? 1 : 0;
    beyond = beyond || (answer.status & contact::bit(contact::Status::beyond_band)) != 0;
  }
  double ripple_of_half(int half) const {
    const std::size_t n = force_n.size() / 2, begin = half == 0 ? 0 : force_n.size() - n;
    return std::max(ripple({force_n.data() + begin, n}), ripple({torque_n.data() + begin, n}));
  }
};

/// To and fro about the last pose, in all six directions at three frequencies.
void append_rub(HandMotion& motion) {
  constexpr double kShift_m = 0.004, kTurn_rad = 0.02;
  constexpr int kSteps = 60;
  const Pose X = motion.X_WM.back();
  const double begin_s = motion.time_s.back();
  for (int i = 1; i <= kSteps; ++i) {
    const double phase = 2 * std::numbers::pi * i / kSteps;
    const double one = std::sin(phase), two = std::sin(2 * phase), three = std::sin(3 * phase);
    Vec6 x;
    x << kShift_m * Vec3(one, two, three), kTurn_rad * Vec3(two, three, one);
    motion.time_s.push_back(begin_s + kRub_s * i / kSteps);
    motion.X_WM.push_back(displaced(X, x));
  }
}

double kinetic_energy_j(const Lockstep& rig) {
  const auto& tool = rig.config().tool;
  const TickTrace& t = rig.trace();
  const Vec3 w_T = t.X_WT.q.conjugate() * t.V_WT.angular;
  return 0.5 * tool.mass_kg * (t.V_WT.linear.squaredNorm() + w_T.dot(tool.inertia_shape_m2 * w_T));
}

}  // namespace

const char* name(Verdict::Why why) {
  switch (why) {
    case Verdict::Why::stable:
      return "stable";
    case Verdict::Why::not_finite:
      return "not finite";
    case Verdict::Why::energy:
      return "energy";
    case Verdict::Why::lost:
      return "lost contact";
    case Verdict::Why::oscillates:
      return "oscillates";
    case Verdict::Why::active:
      return "active port";
  }
  return "";
}

Verdict press(const Experiment& setup) {
  Experiment rubbing = setup;
  append_rub(rubbing.motion_WM);
  Lockstep rig(rubbing);
  const double rate_hz = rig.config().rate_hz;
  const auto ticks = [rate_hz](double seconds) { return std::llround(seconds * rate_hz); };
  Verdict verdict;
  Window window;
  double port_before_j = 0;
  double steps_n2 = 0;
  std::uint64_t steps = 0;
  Vec3 force_last_n = Vec3::Zero();
  bool touched = false;
  const auto one = [&] {
    rig.tick();
    const bool touches = rig.answer().contact_count > 0;
    const Vec3& force_n = rig.answer().response_W.F.force;
    if (touches && touched) {
      steps_n2 += (force_n - force_last_n).squaredNorm();
      verdict.force_step_rms_n = std::sqrt(steps_n2 / static_cast<double>(++steps));
    }
    force_last_n = force_n;
    touched = touches;
    verdict.energy_max_j = std::max(verdict.energy_max_j, kinetic_energy_j(rig));
    if ((rig.trace().faults & bit(Fault::not_finite)) != 0) verdict.why = Verdict::Why::not_finite;
    if (!(verdict.energy_max_j <= kEnergy_j) && verdict.stable()) verdict.why = Verdict::Why::energy;
    return verdict.stable();
  };
  const auto run = [&](long long n, const auto& each) {
    for (; n > 0; --n) {
      if (!one()) return false;
      each();
    }
    return true;
  };
  // Half a second until the coupling is at full strength, then motion and rub.
  constexpr double kLive_s = 1.5;
  for (long long n = ticks(kLive_s + kMotion_s + kRub_s); n > 0 && !rig.trace().script_done; --n) {
    if (!one()) return verdict;
  }
  const bool lived = run(ticks(kSettle_s), [] {}) && (port_before_j = rig.trace().port_energy_j, true) &&
                     run(ticks(kWindow_s), [&] { window.see(rig); });
  verdict.port_energy_j = rig.trace().port_energy_j;
  if (!lived) return verdict;
  const auto n = static_cast<double>(window.force_n.size());
  verdict.contacts = window.contacts / n;
  verdict.depth_m = window.depth_m / n;
  verdict.net_stiffness_n_per_m = window.net / n;
  verdict.ripple_n = window.ripple_of_half(1);
  if (window.beyond || 2 * window.touching < window.force_n.size()) {
    verdict.why = Verdict::Why::lost;
  } else if (verdict.ripple_n > kRipple_n && verdict.ripple_n > kDecay * window.ripple_of_half(0)) {
    verdict.why = Verdict::Why::oscillates;
  } else if (verdict.port_energy_j > kPort_j || verdict.port_energy_j - port_before_j > 0.1 * kPort_j) {
    verdict.why = Verdict::Why::active;
  }
  return verdict;
}

void shorten_to_press(Experiment& setup, double from_s, double lift_m) {
  HandMotion motion = setup.motion_WM;
  if (motion.time_s.empty()) {
    if (const auto script = scripted_hand(setup.session)) motion = load_hand_motion(script->hand_csv);
  }
  contact::ContactPipeline probe(setup.bodies.field, setup.bodies.shell, 16384, [] {
    contact::PipelineParams params;
    params.law = "none";
    return params;
  }());
  const Pose X_MT = setup.bodies.shell->X_TM.inverse();
  const auto touches = [&](const Pose& X_WM) {
    return probe.step({X_WM * X_MT, {}, setup.session.scene.X_WO, {}}).contact_count > 0;
  };
  std::size_t first = 0;
  while (first < motion.X_WM.size() && (from_s > 0 ? motion.time_s[first] < from_s : !touches(motion.X_WM[first]))) {
    ++first;
  }
  if (first >= motion.X_WM.size()) {
    throw SetupError("scene " + setup.session.scene.name + ", script " + setup.session.run.script +
                     ": never touches the obstacle: nothing to press");
  }
  first = first > 0 ? first - 1 : 0;
  std::size_t last = first;
  while (last + 1 < motion.X_WM.size() && (motion.X_WM[last].p - motion.X_WM[first].p).norm() < kReach_m) ++last;
  HandMotion piece;
  for (std::size_t i = first; i <= last; ++i) {
    if (i > first && motion.time_s[i] <= motion.time_s[i - 1]) continue;
    piece.time_s.push_back(motion.time_s[i]);
    piece.X_WM.push_back(motion.X_WM[i]);
  }
  const double begin = piece.time_s.front(), length = piece.time_s.back() - begin;
  for (double& t : piece.time_s) t = (t - begin) * kMotion_s / length;
  piece.X_WM.front().p.z() += lift_m;
  setup.session.scene.start_X_WM = piece.X_WM.front();
  setup.motion_WM = std::move(piece);
}

double largest_stable(const std::function<bool(double)>& stable, double from, double most, double ratio) {
  double low = from, high = 0;
  if (stable(from)) {
    while (high == 0) {
      const double next = std::min(2 * low, most);
      if (stable(next)) {
        low = next;
        if (low >= most) return most;
      } else {
        high = next;
      }
    }
  } else {
    high = from;
    for (low = from / 2; !stable(low); low /= 2) {
      high = low;
      if (low <= from / 64) return 0;
    }
  }
  while (high / low > ratio) {
    const double middle = std::sqrt(high * low);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace tact::lockstep
