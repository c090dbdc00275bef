#include "coupling/dynamics/wrench_model.hpp"

namespace tact::coupling {
namespace {

constexpr double kRemembered = 0.5;

/// `a` without its component against `fresh`.
Vec3 not_reversed(const Vec3& a, const Vec3& fresh) {
  const double n2 = fresh.squaredNorm();
  if (n2 == 0) return a;
  const double along = a.dot(fresh);
  return along < 0 ? Vec3(a - (along / n2) * fresh) : a;
}

}  // namespace

void WrenchModel::begin_tick(const ContactLinearisation* reply) noexcept {
  if (reply != nullptr) {
    reply_ = *reply;
    S_ = reply->K.isZero(0) ? Mat6::Zero() : Mat6(reply->K + kRemembered * S_);
    any_ = true;
    age_ = 0;
  } else if (age_ < params_.fade_ticks) {
    ++age_;
  }
}

ContactLoad WrenchModel::at(const Pose& X_WT, std::uint64_t behind_ticks) noexcept {
  const double scale = strength();
  if (scale == 0) return {};
  if (age_ <= params_.extrapolate_ticks) {
    const Vec6 F = reply_.F_W.vector() + reply_.G * displacement(reply_.X_WT, X_WT);
    F_last_W_ = {not_reversed(F.head<3>(), reply_.F_W.force), not_reversed(F.tail<3>(), reply_.F_W.torque)};
  }
  const double n = 1.0 + static_cast<double>(behind_ticks);
  return {Wrench::from(scale * F_last_W_.vector()), scale * (reply_.K + n * S_), scale * reply_.B};
}

WrenchModel::Phase WrenchModel::phase() const noexcept {
  if (!any_) return Phase::waiting;
  if (age_ >= params_.fade_ticks) return Phase::stale;
  if (age_ == 0) return Phase::fresh;
  return age_ <= params_.extrapolate_ticks ? Phase::late : Phase::fading;
}

double WrenchModel::strength() const noexcept {
  if (!any_ || age_ >= params_.fade_ticks) return 0;
  if (age_ <= params_.extrapolate_ticks) return 1;
  return static_cast<double>(params_.fade_ticks - age_) /
         static_cast<double>(params_.fade_ticks - params_.extrapolate_ticks);
}

}  // namespace tact::coupling
