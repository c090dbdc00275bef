#include "scenes/machine_motions.hpp"

#include <cmath>

#include "shapes/engine.hpp"
#include "shapes/landing_gear.hpp"

namespace tact::scenes {
namespace {

constexpr double kRate_hz = 50;

/// Frame of the tool whose x axis points along `x` and whose z axis points along `z`.
Quat turned(const Vec3& x, const Vec3& z) {
  Mat3 R;
  R.col(0) = x.normalized();
  R.col(2) = z.normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return Quat(R);
}

/// A motion of one point of the tool from place to place, each in its time, with a second of rest at both ends.
class Way {
 public:
  Way(const Vec3& p_M, const Vec3& p_W, const Quat& q_WM) : p_M_(p_M), keys_{{0, p_W, p_M, q_WM}} { go(1, p_W, q_WM); }

  Way& go(double seconds, const Vec3& p_W, const Quat& q_WM) {
    keys_.push_back({keys_.back().time_s + seconds, p_W, p_M_, q_WM});
    return *this;
  }
  Way& go(double seconds, const Vec3& p_W) { return go(seconds, p_W, Quat(keys_.back().q_WM)); }

  HandMotion motion() {
    const KeyPose last = keys_.back();
    go(1, last.p_W, last.q_WM);
    return minimum_jerk(keys_, kRate_hz);
  }

 private:
  Vec3 p_M_;
  std::vector<KeyPose> keys_;
};

}  // namespace

MachineMotions engine_motions() {
  using shapes::EngineBay;
  constexpr double kSeat = 0.0016;  // from the flange to the plate, at the end
  const Vec3 middle(-0.0615, 0, 0), passage = EngineBay::passage_centre(), mouth = EngineBay::starter_mouth();
  const double roll = EngineBay::starter_roll_rad();
  const Quat down = turned(-Vec3::UnitZ(), -Vec3::UnitY()),
             seated = turned(-Vec3::UnitX(), {0, std::cos(roll), std::sin(roll)});
  const Vec3 start(passage.x(), -0.36, 0.3), seat = mouth + Vec3(kSeat - middle.x(), 0, 0);
  const auto before_seat = [&](double by) -> Vec3 { return seat + by * Vec3::UnitX(); };

  Way insert(middle, start, down);
  insert.go(6, {passage.x(), passage.y(), start.z()})
      .go(8, {passage.x(), passage.y(), -0.125})
      .go(7, {0.15, -0.03, -0.165}, seated)
      .go(3, before_seat(0.054))
      .go(3, seat);
  Way cheat(middle, start, down);
  cheat.go(9, {0.16, start.y(), mouth.z()}, seated).go(6, {0.16, mouth.y(), mouth.z()}).go(4, seat);
  return {insert.motion(), cheat.motion()};
}

MachineMotions landing_gear_motions() {
  using shapes::LandingGear;
  const Vec3 pins = LandingGear::lower_pin() - LandingGear::upper_pin(), in = LandingGear::approach(),
             passage = LandingGear::passage_centre();
  const Vec3 middle(shapes::Actuator::length_m() / 2, 0, 0), built_in = LandingGear::upper_pin() + pins / 2;
  const Quat leaning = turned(pins, pins.cross(Vec3::UnitY())), level = turned(Vec3::UnitX(), Vec3::UnitZ());
  const Vec3 start = built_in - 0.72 * in;

  Way insert(middle, start, leaning);
  insert.go(8, passage + Vec3(0.45, 0, 0), level)
      .go(13, passage - Vec3(0.375, 0, 0))
      .go(7, built_in - 0.14 * in, leaning)
      .go(4, built_in);
  Way cheat(middle, start, leaning);
  cheat.go(12, built_in);
  return {insert.motion(), cheat.motion()};
}

}  // namespace tact::scenes
