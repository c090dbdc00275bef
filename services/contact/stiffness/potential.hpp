#pragma once
#include <cstdint>
#include <vector>

#include "contact/stiffness/law.hpp"
#include "contact/stiffness/potential_kernel.hpp"

namespace tact::contact {

/// Law "potential" (ours): the forces are minus the derivative of an energy of the depths,
///   E = (k/2) sum_u A_u^(2/p),   A_u = sum_i beta_iu (gamma_i depth_i)^p,
///   beta_iu = max(0, (n_i.u - cos reach) / (1 - cos reach))^q,   gamma_i^-2 = sum_u beta_iu^(2/p)
///   w_i = gamma_i^2 sum_u beta_iu ((gamma_i depth_i)^p / A_u)^((p-2)/p)   in (0, 1]
/// over directions u spread on the sphere (Fibonacci points); beta below 1e-30 counts as 0. gamma makes the weight of a
/// lonely contact exactly 1. Contacts whose normals are more than 2 reach apart know nothing of each other: faces that
/// oppose each other do not share one stiffness.
///
/// The u are fixed to the *tool*, so beta_iu are constants of the shell, kept per distinct normal: E depends on the
/// pose through the depths alone, and its Hessian in the depths is the whole weight derivative. With forces along the
/// field's gradient F is exactly -dE/dx. Theorems and their limits: README.
///
/// Depths are divided by the largest one, so powers neither overflow nor, short of depths 1e-17 times the largest,
/// underflow; there weights go to zero. Cost: O(contacts) + O(distinct normals in contact * directions in reach).
class Potential final : public Law {
 public:
  struct Params {
    int p, q, directions;
    double reach_rad;
  };

  Potential(const Pointshell& shell, const Params& params, std::size_t capacity);
  void weigh(ContactBuffer& contacts) noexcept override;
  void include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept override;

  /// The directions u, in the tool's frame.
  static std::vector<Vec3> directions(int count);

 private:
  struct alignas(32) Class {  // points of equal normal; never in two cache lines
    PotentialSupport support;
    double gamma;
    std::uint64_t tick;   // of its last use: nothing needs clearing
    std::uint32_t group;  // in that tick
  };

  Class make_class(const Vec3& n_T, const std::vector<Vec3>& u, const Params& params);

  int p_;
  PotentialSupports supports_;
  std::vector<std::uint32_t> class_of_;
  std::vector<Class> classes_;
  std::uint64_t tick_ = 0;
  PotentialWorkspace work_;
};

}  // namespace tact::contact
