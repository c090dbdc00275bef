#pragma once
#include <cstdint>
#include <vector>

#include "contact/stiffness/law.hpp"
#include "contact/stiffness/potential_kernel.hpp"

namespace tact::contact {

/// Law "potential" (ours): the forces are minus the derivative of an energy of the depths,
///   E = (k/2) c sum_u A_u^(2/p),   A_u = sum_i beta(N_i.u) (gamma_i depth_i)^p,   beta(x) = ((1 + x)/2)^q
///   w_i = c gamma_i^2 sum_u beta_iu ((gamma_i depth_i)^p / A_u)^((p-2)/p)   in (0, 1]
/// over directions u spread on the sphere (Fibonacci points). c = (2q/p + 1) / #u; gamma_i (within 1e-3 of 1 by
/// default) makes the weight of a lonely contact exactly 1.
///
/// The u are fixed to the *tool*, so beta_iu are constants of the shell: E depends on the pose through the depths
/// alone, its Hessian in the depths is the whole weight derivative, and no direction term is missing from G.
/// Contacts of equal normal combine as the p-norm of their depths: net n^(2/p) k, never below k, monotone as contacts
/// enter; no point is deeper than F/k while normals are parallel.
///
/// Depths are divided by the largest one, so powers neither overflow nor, short of depths 1e-17 times the largest,
/// underflow; there weights go to zero. Cost: O(contacts) + O(distinct normals in contact * #u).
class Potential final : public Law {
 public:
  Potential(const Pointshell& shell, int p, int q, int directions, std::size_t capacity);
  void weigh(ContactBuffer& contacts) noexcept override;
  void include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept override;

 private:
  struct Class {  // points of equal normal
    Vec3 n_T;
    double gamma;
    std::uint64_t tick;   // of its last use: nothing needs clearing
    std::uint32_t group;  // in that tick
  };

  int p_, q_;
  PotentialDirections directions_;
  std::vector<std::uint32_t> class_of_;
  std::vector<Class> classes_;
  std::uint64_t tick_ = 0;
  PotentialWorkspace work_;
};

}  // namespace tact::contact
