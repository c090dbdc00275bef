#pragma once
#include "mesh/mesh.hpp"

namespace tact::shapes {

class Assembly;

/// An engine in its bay: block, head, gearbox, belt drive, intake, exhaust, what stands about them, hoses and cables.
/// Mesh frame: x backwards along the crankshaft from the gearbox (x < 0) to the fan, z up, the starter's side at -y.
/// README.md says where the starter goes.
struct EngineBay {
  double passage_m;  ///< free width between the two inlet pipes that the starter passes
  double cable_m;    ///< diameter of the thin cables
  double edge_m;     ///< side of a triangle on round parts

  Mesh mesh() const;

  /// Between the two inlet pipes, at their height.
  static Vec3 passage_centre();
  /// The starter's axis where it meets the gearbox's front plate, which lies in x = 0.
  static Vec3 starter_mouth();
  /// Angle of the starter's solenoid from +y towards +z when it is bolted on.
  static double starter_roll_rad();
};

/// A starter motor: body, drive housing with flange, pinion, solenoid beside the body, studs. Mesh frame: origin on the
/// axis in the flange's face, x out of it towards the pinion, z towards the solenoid.
struct Starter {
  static constexpr double kRadius_m = 0.037;  ///< of the body
  double edge_m;

  Mesh mesh() const;
};

// The parts of an engine bay, each in a file of its own.
void add_engine(Assembly& a, const EngineBay& bay);        ///< block, head, gearbox, belt drive, pipes
void add_surroundings(Assembly& a, const EngineBay& bay);  ///< sheets, rails, boxes, radiator, brake booster
void add_lines(Assembly& a, const EngineBay& bay);         ///< hoses, harness, the loom beside the starter

}  // namespace tact::shapes
