#pragma once
#include <cstdint>
#include <vector>

#include "contact/model/contact.hpp"
#include "field/distance_field.hpp"

namespace tact::contact {

/// Remembers from which side each point came into a thin part, so that the part pushes it back there.
///
/// Past the middle of a wall the gradient points to the far side and the depth falls: a contact slips through at the
/// load it bears half a wall deep. From there on the depth of a contact is continued along a direction e that is kept:
///   depth* = depth at the middle - e.(p - p at the middle),   g* = e
/// e is the last gradient of a length above 1/2 before the gradient turned round (a wall), or the point's normal N when
/// N.g becomes negative although a surface lies within the band along N (a wire, round which gradients turn slowly).
/// The contact is let go when it leaves the field, or when e.g >= 0 again and the depth is no larger than depth*.
///
/// Passive whatever the path, under laws whose forces come from an energy of the depths (potential, none): they still
/// do between these events; depth* begins as the depth itself, and energy only ever drops when it ends.
class SideMemory {
 public:
  explicit SideMemory(std::size_t points) : memory_(points) {}

  /// Replaces depth and gradient of held contacts; the deepest of them, or 0. One call for each query, of all contacts
  /// found: points that are missing are forgotten. p_To: the tool's origin in O, the same frame as the contacts.
  /// Real-time: does not allocate, lock or throw; some 10 ns a contact.
  double hold(const DistanceField& field, const Vec3& p_To_O, ContactBuffer& contacts) noexcept;

 private:
  struct Memory {
    std::uint64_t tick = 0;  // of its last contact
    bool held = false;
    bool faced = false;  // N.g >= 0 there
    Vec3 direction_O;    // held: e; otherwise the last clear gradient, of length 1
    Vec3 p_O;            // held: where it began
    double depth_m = 0;  // held: how deep
  };

  std::vector<Memory> memory_;  // per point of the shell
  std::uint64_t tick_ = 1;
};

}  // namespace tact::contact
