#pragma once
#include "contact/model/contact.hpp"

namespace tact::contact {

/// Sums over contacts; names as in assemble.hpp, f = w k depth.
struct ContactSums {
  Mat6 ss;                    ///< sum w s s^T
  Mat6 B;                     ///< sum w b s s^T
  Vec6 elastic;               ///< sum f s
  Mat3 levers;                ///< sum f r e^T of forces along g
  Mat6 sh_less_ss;            ///< sum w s (sh - s)^T
  Vec6 turning;               ///< sum f s of forces along N
  bool some_along_N = false;  ///< otherwise the two above are 0
  bool capped = false;        ///< some b is less than `damping`
};

/// The widest SIMD the processor has is chosen at run time. Real-time: does not allocate, lock or throw.
ContactSums sum_contacts(const ContactBuffer& contacts, double k, double damping, const Vec6& twist) noexcept;

}  // namespace tact::contact
