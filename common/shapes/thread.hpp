#pragma once
#include "mesh/mesh.hpp"

namespace tact::shapes {

/// A right-handed screw thread about z with the basic profile of ISO 68-1: flanks at 30 degrees to the radius, crest
/// cut to an eighth, root to a quarter of the pitch. Solid where r < radius(angle, z): of a bolt inside, of a nut
/// outside the surface. Turning it by an angle a is shifting it along z by pitch * a / (2 pi).
struct Thread {
  double diameter_m;   ///< d, nominal: of the bolt's crests
  double pitch_m;      ///< P
  double allowance_m;  ///< off all diameters, as ISO 965-1 has it: a bolt in a nut without has this much diametral play

  double crest_m() const { return diameter_m - allowance_m; }  ///< largest diameter
  double root_m() const;                                       ///< smallest diameter: d - 5/4 H, H = P sqrt(3) / 2
  double radius(double angle_rad, double z_m) const;           ///< a crest passes through angle 0, z 0
  double section_m2() const;                                   ///< area of the round side across z, the same everywhere

  /// What a bolt with this allowance can be shifted by in a nut with none, along their common axis, flank to flank.
  double axial_play_m() const;
};

/// Hexagon bolt: its tip at z = 0, thread to z = length, then the head. `sides` columns round, a multiple of 12.
Mesh bolt(const Thread& thread, double length, double head_width, double head_height, int sides);

/// Hexagon nut from z = 0 to z = height. A bolt and a nut in the same frame are screwed together, in the middle of
/// their play.
Mesh nut(const Thread& thread, double width, double height, int sides);

}  // namespace tact::shapes
