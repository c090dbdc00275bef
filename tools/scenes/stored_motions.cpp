#include "scenes/stored_motions.hpp"

#include <cmath>
#include <numbers>

#include "scenes/machine_motions.hpp"
#include "shapes/alpha.hpp"

namespace tact::scenes {
namespace {

constexpr double kRate_hz = 50;

/// A straight motion of the mesh frame without turning, with a second of rest at both ends.
HandMotion straight(const std::vector<Vec3>& corners, const std::vector<double>& seconds) {
  std::vector<KeyPose> keys{{0, corners[0], Vec3::Zero()}, {1, corners[0], Vec3::Zero()}};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    keys.push_back({keys.back().time_s + seconds[i - 1], corners[i], Vec3::Zero()});
  }
  keys.push_back({keys.back().time_s + 1, corners.back(), Vec3::Zero()});
  return minimum_jerk(keys, kRate_hz);
}

/// The alpha puzzle. The tool's loop holds the obstacle's upper strand S (direction s), tip down, its plane across S.
/// `solve` turns the tool about S until one flank lies level in the gap, slides along S past the crossing and off the
/// leg's end, and turns back; `lean` is the same way by a hand that leans on the lower strand while it slides; `cheat`
/// goes the straight way between the same two poses. See deploy/scenes/README.md.
struct AlphaMotions {
  HandMotion solve, lean, cheat;
};

AlphaMotions alpha_motions() {
  constexpr double kStart = 0.042, kEnd = -0.150;  // of the tool's plane along S from the crossing
  constexpr double kAboveTip = 0.0282;             // S above the flanks' meeting point, at start: wedged between them
  constexpr double kAlongFlank = 0.042;            // S along the level flank from there, while sliding
  constexpr double kLean = 0.003;                  // below the middle of the gap: some 2 mm into the lower strand
  const shapes::Alpha alpha = shapes::alpha_from({});
  const double g = alpha.tip_half_rad, level = std::numbers::pi / 2 - g;
  const Vec3 s = alpha.strand_direction();
  const auto on_strand = [&](double along) -> Vec3 { return along * s + alpha.h() * Vec3::UnitZ(); };

  Mat3 R;  // tip (x_M) down, plane across S
  R.col(0) = -Vec3::UnitZ();
  R.col(2) = s;
  R.col(1) = R.col(2).cross(R.col(0));
  const Quat q_down(R);
  // The body leans away from the loop's inside: towards z x s.
  const Quat q_level = Quat(Eigen::AngleAxisd(level, -s)) * q_down;

  const Vec3 held_down = alpha.virtual_tip() - Vec3(kAboveTip, 0, 0);
  // The flank that becomes level, in M: from the tip, and up from it.
  const double side =
      (q_level * Vec3(-std::cos(g), std::sin(g), 0)).z() < (q_level * Vec3(-std::cos(g), -std::sin(g), 0)).z() ? 1 : -1;
  const Vec3 flank(-std::cos(g), side * std::sin(g), 0), up(-std::sin(g), -side * std::cos(g), 0);
  const Vec3 held_level = alpha.virtual_tip() + kAlongFlank * flank + alpha.h() * up;

  const KeyPose start{0, on_strand(kStart), held_down, q_down};
  const KeyPose free{0, on_strand(kEnd), held_down, q_down};
  const auto at = [](double time_s, KeyPose key) {
    key.time_s = time_s;
    return key;
  };
  const auto through = [&](double below) {
    const Vec3 lower = -below * Vec3::UnitZ();
    return minimum_jerk({start,
                         at(1, start),
                         {5.5, on_strand(kStart) + lower, held_level, q_level},
                         {11.5, on_strand(kEnd) + lower, held_level, q_level},
                         at(16, free),
                         at(17, free)},
                        kRate_hz);
  };
  return {through(0), through(kLean), minimum_jerk({start, at(1, start), at(7, free), at(9, free)}, kRate_hz)};
}

}  // namespace

std::map<std::string, HandMotion> stored_motions() {
  AlphaMotions alpha = alpha_motions();
  MachineMotions engine = engine_motions(), gear = landing_gear_motions();
  return {{"alpha-solve.csv", std::move(alpha.solve)},
          {"alpha-lean.csv", std::move(alpha.lean)},
          {"alpha-cheat.csv", std::move(alpha.cheat)},
          {"cone-insert.csv", straight({{-0.06, 0, 0.001}, {-0.06, 0, 0}, {0.04, 0, 0}}, {1, 4})},
          {"two-walls-press.csv", straight({{0, 0, 0.012}, {0, 0, -0.002}}, {2})},
          {"peg-press.csv", straight({{0, 0, 0.002}, {0.0105, 0, 0.002}}, {2})},
          {"peg-round-press.csv", straight({{0, 0, 0.002}, {0.008, 0, -0.006}}, {2})},
          {"wedge-press.csv", straight({{0, 0, 0.002}, {0, 0, -0.04}}, {2.5})},
          {"engine-insert.csv", std::move(engine.insert)},
          {"engine-cheat.csv", std::move(engine.cheat)},
          {"landing-gear-insert.csv", std::move(gear.insert)},
          {"landing-gear-cheat.csv", std::move(gear.cheat)}};
}

}  // namespace tact::scenes
