#include "contact/response/assemble.hpp"

#include <algorithm>
#include <cmath>

#include "math/exp_log.hpp"

namespace tact::contact {
namespace {

Mat6 rotated(const Mat6& M, const Mat3& R) noexcept {
  Mat6 out;
  for (int row = 0; row < 6; row += 3) {
    for (int column = 0; column < 6; column += 3) {
      out.block<3, 3>(row, column) = R * M.block<3, 3>(row, column) * R.transpose();
    }
  }
  return out;
}

Mat6 symmetric(const Mat6& M) noexcept { return 0.5 * (M + M.transpose()); }

}  // namespace

Response assemble(const ContactBuffer& contacts, const Law& law, double k, double damping, const Twist& V) noexcept {
  Response out;
  Vec6 elastic = Vec6::Zero(), damped = Vec6::Zero(), turning = Vec6::Zero();
  Mat6 ss = Mat6::Zero(), sh = Mat6::Zero();
  Mat3 levers = Mat3::Zero();
  const Vec6 twist = V.vector();
  for (std::size_t i = 0; i < contacts.size; ++i) {
    const double w = contacts.weight[i], depth = contacts.depth_m[i];
    const Vec3& r = contacts.r[i];
    const Vec3& e = contacts.force_direction(i);
    Vec6 s, h;
    s << e, r.cross(e);
    const Vec6 ws = w * s, f = (k * depth) * ws;
    elastic += f;
    ss.noalias() += ws * s.transpose();
    if (&e == &contacts.g[i]) {
      levers.noalias() += r * f.head<3>().transpose();
      sh.noalias() += ws * s.transpose();
    } else {
      turning += f;
      h << contacts.g[i], r.cross(contacts.g[i]);
      sh.noalias() += ws * h.transpose();
    }
    if (damping > 0) {
      const double speed = s.dot(twist), spring = k * depth;
      double b = damping;
      if (b * std::fabs(speed) > spring) {
        b = spring / std::fabs(speed);
        out.status |= bit(Status::capped);
      }
      damped -= (b * speed) * ws;
      out.B.noalias() += (b * ws) * s.transpose();
    }
  }
  law.include_weight_derivative(ss, sh);
  out.F = Wrench::from(elastic + damped);
  out.G = -k * sh;
  out.G.block<3, 3>(0, 3) -= skew(turning.head<3>());
  out.G.block<3, 3>(3, 3) -= skew(turning.tail<3>());
  out.G.block<3, 3>(3, 3) += levers - levers.trace() * Mat3::Identity();
  out.K = symmetric(k * ss);
  out.B = symmetric(out.B);
  return out;
}

Response rotated(const Response& response, const Mat3& R) noexcept {
  Response out;
  out.F = {R * response.F.force, R * response.F.torque};
  out.G = rotated(response.G, R);
  out.K = symmetric(rotated(response.K, R));
  out.B = symmetric(rotated(response.B, R));
  out.status = response.status;
  return out;
}

}  // namespace tact::contact
