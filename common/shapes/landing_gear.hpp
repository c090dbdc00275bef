#pragma once
#include "mesh/mesh.hpp"

namespace tact::shapes {

class Assembly;

/// A landing gear: strut with torsion links and braces, bogie with four braked wheels, hydraulic lines and wiring. Mesh
/// frame: z up from the ground, x along the bogie, the actuator's place at +x. README.md says how it is reached.
struct LandingGear {
  double passage_m;  ///< free height between the two wires that the actuator passes
  double wire_m;     ///< diameter of the thin wires
  double edge_m;     ///< side of a triangle on round parts

  Mesh mesh() const;

  static Vec3 upper_pin();       ///< where the actuator's pins are when it is built in: on the strut...
  static Vec3 lower_pin();       ///< ...and on the bogie
  static Vec3 passage_centre();  ///< between the two wires
  /// Unit vector of the last stretch: both forks slide over their lugs. Perpendicular to the line of the pins.
  static Vec3 approach();
};

/// A hydraulic actuator with a fork at each end. Mesh frame: origin in the middle of the upper pin's hole, x towards
/// the lower one at length_m(), y along the pins.
struct Actuator {
  static double length_m();  ///< from pin to pin: fits LandingGear
  double edge_m;

  Mesh mesh() const;
};

// The parts of a landing gear, each in a file of its own.
void add_wheel(Assembly& a, const Pose& hub);               ///< hub: in the middle, z outwards along the axle
void add_gear_lines(Assembly& a, const LandingGear& gear);  ///< hydraulic lines, wires

}  // namespace tact::shapes
