#include "contact/stiffness/uniform.hpp"

#include <algorithm>

namespace tact::contact {

void NoScaling::weigh(ContactBuffer& contacts) noexcept { std::fill_n(contacts.weight.begin(), contacts.size, 1.0); }

void GlobalScaling::weigh(ContactBuffer& contacts) noexcept {
  // Points beyond capacity are in contact too: they count.
  const double n = static_cast<double>(contacts.size + contacts.dropped);
  std::fill_n(contacts.weight.begin(), contacts.size, n >= n0_ ? n0_ / n : 1.0);
}

}  // namespace tact::contact
