#include "view/render/arrows.hpp"

#include <algorithm>
#include <cmath>

namespace tact::view {
namespace {

constexpr Color kNormalColor{38, 38, 214};
constexpr Color kHandColor{40, 170, 240};

}  // namespace

std::vector<Arrow> contact_arrows(const ViewScene& scene, double size_m, std::size_t limit) {
  std::vector<const Contact*> strongest;
  for (const Contact& contact : scene.contact_set.contacts) strongest.push_back(&contact);
  const auto by_force = [](const Contact* a, const Contact* b) {
    return a->force_W.squaredNorm() > b->force_W.squaredNorm();
  };
  if (strongest.size() > limit) {
    std::nth_element(strongest.begin(), strongest.begin() + static_cast<std::ptrdiff_t>(limit), strongest.end(),
                     by_force);
    strongest.resize(limit);
  }
  double largest = 0;
  for (const Contact* contact : strongest) largest = std::max(largest, contact->force_W.norm());

  std::vector<Arrow> arrows;
  for (const Contact* contact : strongest) {
    const double share = largest > 0 ? std::sqrt(contact->force_W.norm() / largest) : 0;
    const double length = size_m * (0.45 + 0.55 * share);
    arrows.push_back({contact->p_W, contact->p_W + length * contact->N_W, 0.035 * size_m, 0.3 * size_m, kNormalColor});
  }
  const DeviceState& device = scene.device;
  if ((device.X_WH.p - device.X_WT.p).norm() > scene.info.voxel_m) {
    arrows.push_back({device.X_WT.p, device.X_WH.p, 0.03 * size_m, 0, kHandColor});
  }
  return arrows;
}

}  // namespace tact::view
