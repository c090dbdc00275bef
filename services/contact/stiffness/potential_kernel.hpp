#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "contact/model/contact.hpp"

namespace tact::contact {

/// Where beta of one normal is not zero: directions[begin, end) of PotentialSupports.
struct PotentialSupport {
  std::uint32_t begin, end;
};

/// The supports of all normals of a shell, one behind the other.
struct PotentialSupports {
  std::vector<std::uint16_t> direction;
  std::vector<float> beta;  ///< in (0, 1]
};

/// Eight doubles in one cache line.
struct alignas(64) PotentialRow {
  double v[8] = {};
};

/// Contacts of equal normal, summed: rho = gamma depth / largest depth, s = (e, r x e), sh = (g, r x g).
struct PotentialGroup {
  PotentialRow own;  ///< (sum rho^p, sum gamma rho^(p-1) s, 0)
  PotentialSupport support;
  bool differs;  ///< e is not g in some contact
};

/// Scratch and results of run_potential, for at most `capacity` contacts of at most `groups` normals.
struct PotentialWorkspace {
  PotentialWorkspace(std::size_t capacity, std::size_t groups, std::size_t directions);

  std::vector<std::uint32_t> group_of;  ///< per contact
  std::vector<double> gamma;            ///< per contact
  std::size_t size = 0;                 ///< groups in use
  std::vector<PotentialGroup> group;
  std::vector<PotentialRow> less_of;    ///< per group that differs: (0, sum gamma rho^(p-1) (s - sh), 0)
  std::vector<PotentialRow> own, less;  ///< scratch, per direction: (A, S, 0) and (0, S - Sh, 0)
  std::vector<double> slope;            ///< scratch, per direction: A^(2/p-1), 0 where A is
  std::vector<std::uint32_t> active;    ///< scratch: directions with A > 0
  std::vector<double> a, scale;         ///< scratch, of these, padded to whole vectors: A, A^(1/p-1)
  std::vector<double> sum;              ///< scratch, per group: sum_u beta A_u^(2/p-1)
  Mat6 ss, sh;                          ///< result: sum_u A_u^(2/p-2) S_u (S_u, Sh_u)^T, (A_u, S_u) = sum beta own
};

/// Writes the weights, and the sums over all groups. Directions with A_u = 0 add nothing. The widest SIMD the
/// processor has is chosen at run time. Real-time: does not allocate, lock or throw.
/// @pre group_of and gamma of the contacts, supports of the groups are set
void run_potential(const PotentialSupports& supports, int p, ContactBuffer& contacts,
                   PotentialWorkspace& work) noexcept;

}  // namespace tact::contact
