#pragma once
#include <cstdint>

#include "coupling/dynamics/tool_integrator.hpp"

namespace tact::coupling {

/// A contact reply as the dynamics see it: F(x) = F + G x about the pose it was computed at.
struct ContactLinearisation {
  Pose X_WT;  ///< pose used by the server
  Wrench F_W;
  Mat6 G = Mat6::Zero();  ///< dF/dx
  Mat6 K = Mat6::Zero(), B = Mat6::Zero();
};

/// What the tool feels between replies. Age counts executed ticks since the last reply arrived:
///
///   age  0..extrapolate_ticks   F + G x, x the displacement since the pose used; a component of the force along the
///                               last fresh force (torque likewise) never turns negative: no pulling into contact
///   .. fade_ticks               the last extrapolated wrench, scaled down linearly; strength() with it
///   beyond                      zero: stale, the device is calm
///
/// Damping. A contact that is first answered n ticks after the tool entered it has let the tool in by n h v, and a
/// stiff implicit step puts it out in one: it leaves with n v, so every touch feeds the next. And a gradient is that of
/// one pose, where a tool that rocks has others at both ends of its way. So an implicit step meets K + n S instead of
/// K: S what K has been lately (of each reply half of the one before, forgotten in the open), n the ticks from the pose
/// answered to the end of the step. That is a damper n h S: nothing at rest, a few ticks of delay in motion, and work
/// never but lost. What it changes: README.md, "Late replies".
///
/// Until the first reply it is as if stale, without being a fault. Real time: no allocation, a few hundred nanoseconds.
class WrenchModel {
 public:
  struct Params {
    std::uint32_t extrapolate_ticks = 5;
    std::uint32_t fade_ticks = 20;
  };
  enum class Phase { waiting, fresh, late, fading, stale };

  WrenchModel() = default;
  explicit WrenchModel(const Params& params) : params_(params) {}

  /// Begins a tick with a new reply, or without.
  void begin_tick(const ContactLinearisation* reply) noexcept;

  /// Contact load on the tool at X_WT in this tick; `behind_ticks`: poses published since the one answered, 0 when the
  /// reply is to the newest.
  ContactLoad at(const Pose& X_WT, std::uint64_t behind_ticks = 0) noexcept;

  Phase phase() const noexcept;
  /// 1 while fresh or late, falling to 0 through the fade.
  double strength() const noexcept;
  std::uint32_t age_ticks() const noexcept { return age_; }
  /// The pose of the last reply.
  const Pose& X_WT_answered() const noexcept { return reply_.X_WT; }

 private:
  Params params_;
  ContactLinearisation reply_;
  Mat6 S_ = Mat6::Zero();  // K lately
  Wrench F_last_W_;        // last not faded
  bool any_ = false;
  std::uint32_t age_ = 0;
};

}  // namespace tact::coupling
