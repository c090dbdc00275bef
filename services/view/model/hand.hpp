#pragma once
#include "math/pose.hpp"
#include "view/model/camera.hpp"

namespace tact::view {

/// One movement of the mouse, in picture terms.
struct HandMove {
  double dx = 0, dy = 0;                                     ///< right and up, in picture heights
  double dz = 0;                                             ///< towards the viewer, in picture heights
  double about_x_rad = 0, about_y_rad = 0, about_z_rad = 0;  ///< about the eye's axes

  /// All numbers, none beyond 10: no mouse does more between two messages.
  bool plausible() const;
};

/// The pose a mouse holds the tool at. The mouse moves To in the picture and turns the tool about To.
class MouseHand {
 public:
  /// Takes the tool where its handle now is, so that taking hold moves nothing.
  /// Stays within `reach_m` of `centre_W` whatever the mouse does.
  void take(const Pose& X_WH, const Pose& X_TM, const Vec3& centre_W, double reach_m);

  /// Ignores a move that is not plausible.
  void move(const HandMove& move, const Camera& camera);

  Pose X_WM() const { return X_WT_ * X_TM_; }
  const Pose& X_WT() const { return X_WT_; }

 private:
  Pose X_WT_, X_TM_;
  Vec3 centre_W_ = Vec3::Zero();
  double reach_m_ = 0;
};

}  // namespace tact::view
