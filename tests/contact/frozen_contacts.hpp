#pragma once
#include "contact/response/assemble.hpp"
#include "math/exp_log.hpp"

namespace tact::contact::test {

/// The contacts of one pose moved by dx = (translation, left rotation increment about To) in O: the same points,
/// their depths from `depth(p_O)`, the field's gradient at each kept as it was.
template <class Depth>
ContactBuffer moved(const ContactBuffer& base, const Vec3& p_To, const Vec6& dx, Depth&& depth) {
  ContactBuffer out = base;
  const Mat3 turn = exp_so3(Vec3(dx.tail<3>())).toRotationMatrix();
  for (std::size_t i = 0; i < base.size; ++i) {
    out.r[i] = turn * base.r[i];
    out.N[i] = turn * base.N[i];
    out.depth_m[i] = depth(Vec3(p_To + dx.head<3>() + out.r[i]));
  }
  return out;
}

/// Central differences of the elastic wrench: what G claims to be. `step_m` for translations, and for rotations the
/// way of a point at the mean lever.
template <class Depth>
Mat6 derivative_of_wrench(Law& law, const ContactBuffer& base, const Vec3& p_To, double k, double step_m,
                          Depth&& depth) {
  double lever = 0;
  for (std::size_t i = 0; i < base.size; ++i) lever += base.r[i].norm() / static_cast<double>(base.size);
  Mat6 out;
  for (int c = 0; c < 6; ++c) {
    const double step = c < 3 ? step_m : step_m / lever;
    const auto wrench = [&](double sign) {
      ContactBuffer there = moved(base, p_To, sign * step * Vec6::Unit(c), depth);
      law.weigh(there);
      return assemble(there, law, k, 0, {}).F.vector();
    };
    out.col(c) = (wrench(1) - wrench(-1)) / (2 * step);
  }
  return out;
}

/// |a - b| / |b|, torques and rotations in units of `lever_m`, so that no block drowns in another.
inline double difference(const Mat6& a, const Mat6& b, double lever_m) {
  Vec6 unit = Vec6::Ones();
  unit.tail<3>().setConstant(1 / lever_m);
  const Mat6 scaled = unit.asDiagonal() * (a - b) * unit.asDiagonal();
  return scaled.norm() / (unit.asDiagonal() * b * unit.asDiagonal()).norm();
}

}  // namespace tact::contact::test
