#pragma once
#include "contact/model/contact.hpp"
#include "contact/stiffness/law.hpp"

namespace tact::contact {

/// The contact wrench on the tool about To and its derivatives, all in one frame (O when assembled, W after rotated()).
/// x = (translation of To, left rotation increment of the tool), V the twist of the tool relative to the field body.
struct Response {
  Wrench F;               ///< N, Nm
  Mat6 G = Mat6::Zero();  ///< dF/dx: exact while the contact set stays; not symmetric, maybe indefinite. To extrapolate
  Mat6 K = Mat6::Zero();  ///< stiffness, symmetric positive semidefinite. For the implicit solve
  Mat6 B = Mat6::Zero();  ///< contact damping, symmetric positive semidefinite: the damping part of F is -B V
  std::uint32_t status = 0;  ///< Status::capped when a damping force was limited
};

/// Sums the weighed contacts, [P] eq. 1 and 9. With e_i = contacts.force_direction(i), s_i = (e_i, r_i x e_i) and
/// sh_i = (g_i, r_i x g_i):
///   F = sum_i f_i s_i,   f_i = w_i (k depth_i - b_i s_i.V),   b_i = min(b, k depth_i / |s_i.V|)
///   G = -k sum_ij s_i H_ij sh_j^T + T    H: see Law::include_weight_derivative
///   T = [0, -[F]x; 0, -[tau]x]              F, tau: elastic, of contacts along N, which turns with the tool
///     + [0, 0; 0, sum_i [F_i]x [r_i]x]      F_i: elastic, of contacts along g, which does not turn
///       (the field's own curvature is left out: relative error depth / radius)
///   K =  k sum_ij s_i H_ij s_j^T
///   B = sum_i w_i b_i s_i s_i^T
/// A contact's damping is never larger than its spring force: no contact pulls, and none begins with a step. G leaves
/// out how the damping part changes with x.
/// `damping` b in Ns/m, V of To in the frame of the contacts. O(n). Real-time: does not allocate, lock or throw.
/// @pre law.weigh(contacts) was the last thing done with the law
Response assemble(const ContactBuffer& contacts, const Law& law, double k, double damping, const Twist& V) noexcept;

/// The response with all vectors turned by R.
Response rotated(const Response& response, const Mat3& R) noexcept;

}  // namespace tact::contact
