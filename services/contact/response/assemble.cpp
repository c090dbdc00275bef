#include "contact/response/assemble.hpp"

#include "contact/response/sums.hpp"
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
  ContactSums sums = sum_contacts(contacts, k, damping, V.vector());
  Mat6 sh = sums.ss + sums.sh_less_ss;
  law.include_weight_derivative(sums.ss, sh);
  Response out;
  out.F = Wrench::from(sums.elastic - sums.B * V.vector());
  out.G = -k * sh;
  out.G.block<3, 3>(0, 3) -= skew(sums.turning.head<3>());
  out.G.block<3, 3>(3, 3) -= skew(sums.turning.tail<3>());
  out.G.block<3, 3>(3, 3) += sums.levers - sums.levers.trace() * Mat3::Identity();
  out.K = symmetric(k * sums.ss);
  out.B = sums.B;
  if (sums.capped) out.status |= bit(Status::capped);
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
