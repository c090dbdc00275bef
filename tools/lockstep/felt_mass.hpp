#pragma once
#include <string>

#include "lockstep/lockstep.hpp"

namespace tact::lockstep {

/// What a hand moves when it moves the handle in free space, its own mass left out, as it would be felt at the handle.
struct FeltMass {
  double mass_kg = 0;
  Vec3 inertia_kg_m2 = Vec3::Zero();  ///< about the axes of T where it starts, one at a time

  std::string text() const;  ///< "1.17 kg; 0.0034, 0.0035, 0.0037 kg m^2 about the tool's axes"
};

/// Measured: the setup's hand leads the handle to and fro at 1 Hz, 60 mm along x and 0.4 rad about each axis of T, with
/// the obstacle far away; F = m a + b v fitted to the wrench of the hand and the motion of the handle. Friction is in
/// b.
FeltMass felt_mass(const Experiment& setup);

}  // namespace tact::lockstep
