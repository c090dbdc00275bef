#include "contact/server/contact_snapshot.hpp"

#include <algorithm>
#include <numeric>

namespace tact::contact {

void SnapshotTaker::take(const ContactBuffer& contacts, const ContactResult& result, ContactSnapshot& out) noexcept {
  const std::size_t n = contacts.size;
  const auto begin = order_.begin(), end = begin + static_cast<std::ptrdiff_t>(n);
  std::iota(begin, end, 0u);
  out.total = static_cast<std::uint32_t>(n);
  out.size = static_cast<std::uint32_t>(std::min(n, ContactSnapshot::kMax));
  if (n > ContactSnapshot::kMax) {
    const auto heavier = [&](std::uint32_t a, std::uint32_t b) {
      return contacts.weight[a] * contacts.depth_m[a] > contacts.weight[b] * contacts.depth_m[b];
    };
    const auto cut = begin + ContactSnapshot::kMax;
    std::nth_element(begin, cut, end, heavier);
    std::sort(begin, cut, heavier);
  }
  for (std::size_t i = 0; i < out.size; ++i) {
    const std::uint32_t c = order_[i];
    out.items[i] = {contacts.point_id[c], contacts.flags[c],           contacts.r[c],       contacts.N[c],
                    contacts.g[c],        contacts.force_direction(c), contacts.depth_m[c], contacts.weight[c]};
  }
  out.X_WT = result.X_WT;
  out.X_WO = result.X_WO;
  out.F_W = result.response_W.F;
  out.stiffness_n_per_m = result.stiffness_n_per_m;
  out.params_version = result.params_version;
}

}  // namespace tact::contact
