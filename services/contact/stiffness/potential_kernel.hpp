#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Contacts of equal normal, summed: rho = gamma depth / largest depth, s = (N, r x N), sh = (g, r x g).
struct PotentialGroup {
  double n[3];        ///< unit normal, in the directions' frame
  double power;       ///< sum rho^p
  double moment[12];  ///< sum gamma rho^(p-1) (s, sh)
};

/// The fixed directions u on the sphere, structure of arrays, padded to whole vectors.
struct PotentialDirections {
  static constexpr std::size_t kPadding = 8;  ///< doubles in the widest vector used

  explicit PotentialDirections(int count);
  std::size_t padded() const { return x.size(); }

  int count;
  std::vector<double> x, y, z;  ///< u / 2
  std::vector<double> active;   ///< 1, or 0 for padding
};

/// Scratch and results of run_potential, for at most `capacity` groups.
struct PotentialWorkspace {
  explicit PotentialWorkspace(std::size_t capacity);

  std::size_t size = 0;  ///< groups in use
  std::vector<PotentialGroup> group;
  std::vector<double> beta;     ///< scratch: beta of each group for one vector of directions
  std::vector<double> partial;  ///< scratch: lane sums of `sum`
  std::vector<double> sum;      ///< result, per group: sum_u beta A_u^(2/p-1)
  Mat6 ss, sh;                  ///< result: sum_u A_u^(2/p-2) S_u (S_u, Sh_u)^T, (S_u, Sh_u) = sum beta moment
};

/// A_u = sum beta(n.u) power, and what follows from it; beta(x) = ((1+x)/2)^q. Directions with A_u = 0 add nothing.
/// The widest SIMD the processor has is chosen at run time. Real-time: does not allocate, lock or throw.
void run_potential(const PotentialDirections& directions, int p, int q, PotentialWorkspace& work) noexcept;

}  // namespace tact::contact
