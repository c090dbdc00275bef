#include "coupling/device/driver_spring.hpp"

#include <algorithm>
#include <cmath>

namespace tact::coupling {

DriverSpring driver_spring(double rate_hz, double mass_kg, double inertia_kg_m2) {
  constexpr double kSpring = 2000, kAngularSpring = 5, kDampingRatio = 0.7, kPhase = 0.2;
  const double w = kPhase * rate_hz;
  DriverSpring spring;
  spring.n_per_m = std::min(kSpring, mass_kg * w * w);
  spring.nm_per_rad = std::min(kAngularSpring, inertia_kg_m2 * w * w);
  spring.n_s_per_m = 2 * kDampingRatio * std::sqrt(spring.n_per_m * mass_kg);
  spring.nm_s_per_rad = 2 * kDampingRatio * std::sqrt(spring.nm_per_rad * inertia_kg_m2);
  return spring;
}

}  // namespace tact::coupling
