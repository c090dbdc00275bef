#pragma once
#include "contact/stiffness/law.hpp"

namespace tact::contact {

/// Law "none": w = 1.
class NoScaling final : public Law {
 public:
  void weigh(ContactBuffer& contacts) noexcept override;
};

/// Law "global", [P] eq. 2: w = n0 / n for n >= n0 contacts, else 1.
class GlobalScaling final : public Law {
 public:
  explicit GlobalScaling(int n0) : n0_(n0) {}
  void weigh(ContactBuffer& contacts) noexcept override;

 private:
  double n0_;
};

}  // namespace tact::contact
