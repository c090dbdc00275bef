#include "contact/stiffness/adaptive.hpp"

#include <algorithm>
#include <vector>

namespace tact::contact {
namespace {

std::vector<Vec3> normals(const Pointshell& shell) {
  std::vector<Vec3> out(shell.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = shell.normal_T[i].cast<double>();
  return out;
}

std::vector<Vec3> torque_directions(const Pointshell& shell, double lever_floor_m, double lever_unit_m) {
  std::vector<Vec3> out(shell.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 lever = shell.position_T[i].cast<double>().cross(shell.normal_T[i].cast<double>());
    out[i] = lever / (lever_unit_m > 0 ? lever_unit_m : std::max(lever.norm(), lever_floor_m));
  }
  return out;
}

/// weight = mass / weight, where weight holds phi: each contact counts itself, so phi >= mass.
void invert(ContactBuffer& contacts, double mass) noexcept {
  for (std::size_t i = 0; i < contacts.size; ++i) contacts.weight[i] = mass / std::max(contacts.weight[i], mass);
}

}  // namespace

Adaptive3Dof::Adaptive3Dof(const Pointshell& shell, double epsilon) : normals_(normals(shell), epsilon) {}

void Adaptive3Dof::weigh(ContactBuffer& contacts) noexcept {
  std::fill_n(contacts.weight.begin(), contacts.size, 0.0);
  normals_.add({contacts.point_id.data(), contacts.size}, {contacts.weight.data(), contacts.size});
  invert(contacts, 1.0);
}

Adaptive6Dof::Adaptive6Dof(const Pointshell& shell, double epsilon, double lever_floor_m, double lever_unit_m)
    : normals_(normals(shell), epsilon), torques_(torque_directions(shell, lever_floor_m, lever_unit_m), epsilon) {}

void Adaptive6Dof::weigh(ContactBuffer& contacts) noexcept {
  std::fill_n(contacts.weight.begin(), contacts.size, 0.0);
  const std::span<const std::uint32_t> ids{contacts.point_id.data(), contacts.size};
  const std::span<double> phi{contacts.weight.data(), contacts.size};
  normals_.add(ids, phi);
  torques_.add(ids, phi);
  invert(contacts, 2.0);
}

}  // namespace tact::contact
