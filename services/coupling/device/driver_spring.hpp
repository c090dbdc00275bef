#pragma once

namespace tact::coupling {

/// The spring and damper a driver keeps between handle and set-point in pseudo-admittance.
struct DriverSpring {
  double n_per_m = 0, nm_per_rad = 0;
  double n_s_per_m = 0, nm_s_per_rad = 0;
};

/// The rule for its gains, from the virtual body (mass m, smallest moment of inertia I) that we integrate against it
/// and the period T, so that the outer loop is stable:
///   K = min(2000 N/m, m (0.2 / T)^2),  B = 2 * 0.7 sqrt(K m);   K_r = min(5 Nm/rad, I (0.2 / T)^2), B_r alike.
DriverSpring driver_spring(double rate_hz, double mass_kg, double inertia_kg_m2);

}  // namespace tact::coupling
