#pragma once
#include <string_view>

#include "link/wire.hpp"
#include "math/pose.hpp"
#include "rt/histogram.hpp"

/// The only place where wire and mathematics meet. None of these allocates, locks or throws: real-time safe.
namespace tact {

void to_wire(const Pose& in, geometry_msgs_msg_dds__Pose_& out) noexcept;
void to_wire(const Twist& in, geometry_msgs_msg_dds__Twist_& out) noexcept;
void to_wire(const Wrench& in, geometry_msgs_msg_dds__Wrench_& out) noexcept;
void to_wire(const Vec3& in, geometry_msgs_msg_dds__Vector3_& out) noexcept;
void to_wire(const Vec3& in, geometry_msgs_msg_dds__Point_& out) noexcept;
void to_wire(const rt::Histogram& in, wire::Histogram& out) noexcept;

/// As received: not normalised, possibly not finite. Whoever uses it checks.
Pose from_wire(const geometry_msgs_msg_dds__Pose_& in) noexcept;
Twist from_wire(const geometry_msgs_msg_dds__Twist_& in) noexcept;
Wrench from_wire(const geometry_msgs_msg_dds__Wrench_& in) noexcept;
Vec3 from_wire(const geometry_msgs_msg_dds__Vector3_& in) noexcept;
Vec3 from_wire(const geometry_msgs_msg_dds__Point_& in) noexcept;
rt::Histogram from_wire(const wire::Histogram& in) noexcept;

/// F[6]: force, then torque.
void to_wire(const Wrench& in, double (&out)[6]) noexcept;
Wrench wrench_from_wire(const double (&in)[6]) noexcept;
/// 36 numbers, row by row.
void to_wire(const Mat6& in, double (&out)[36]) noexcept;
Mat6 from_wire(const double (&in)[36]) noexcept;
/// 9 numbers, row by row.
void to_wire(const Mat3& in, double (&out)[9]) noexcept;
Mat3 from_wire(const double (&in)[9]) noexcept;
/// Symmetric: 21 numbers, the upper triangle row by row. Only the upper triangle of `in` is read.
void to_wire_symmetric(const Mat6& in, double (&out)[21]) noexcept;
Mat6 symmetric_from_wire(const double (&in)[21]) noexcept;

}  // namespace tact
