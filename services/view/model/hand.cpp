#include "view/model/hand.hpp"

#include <cmath>

#include "math/exp_log.hpp"

namespace tact::view {

bool HandMove::plausible() const {
  for (const double v : {dx, dy, dz, about_x_rad, about_y_rad, about_z_rad}) {
    if (!(std::abs(v) <= 10)) return false;
  }
  return true;
}

void MouseHand::take(const Pose& X_WH, const Pose& X_TM, const Vec3& centre_W, double reach_m) {
  X_WT_ = X_WH;
  X_TM_ = X_TM;
  centre_W_ = centre_W;
  reach_m_ = reach_m;
}

void MouseHand::move(const HandMove& move, const Camera& camera) {
  if (!move.plausible()) return;
  const Quat q_WE = camera.X_WE().q;
  const double height = camera.picture_height_m(X_WT_.p);
  X_WT_.p += q_WE * (height * Vec3(move.dx, move.dy, move.dz));
  const Vec3 offset = X_WT_.p - centre_W_;
  if (offset.norm() > reach_m_) X_WT_.p = centre_W_ + reach_m_ * offset.normalized();
  const Vec3 turn_W = q_WE * Vec3(move.about_x_rad, move.about_y_rad, move.about_z_rad);
  X_WT_.q = (exp_so3(turn_W) * X_WT_.q).normalized();
}

}  // namespace tact::view
