#include "link/convert.hpp"

#include <algorithm>

namespace tact {

void to_wire(const Vec3& in, geometry_msgs_msg_dds__Vector3_& out) noexcept { out = {in.x(), in.y(), in.z()}; }
void to_wire(const Vec3& in, geometry_msgs_msg_dds__Point_& out) noexcept { out = {in.x(), in.y(), in.z()}; }

void to_wire(const Pose& in, geometry_msgs_msg_dds__Pose_& out) noexcept {
  to_wire(in.p, out.position);
  out.orientation = {in.q.x(), in.q.y(), in.q.z(), in.q.w()};
}

void to_wire(const Twist& in, geometry_msgs_msg_dds__Twist_& out) noexcept {
  to_wire(in.linear, out.linear);
  to_wire(in.angular, out.angular);
}

void to_wire(const Wrench& in, geometry_msgs_msg_dds__Wrench_& out) noexcept {
  to_wire(in.force, out.force);
  to_wire(in.torque, out.torque);
}

void to_wire(const rt::Histogram& in, wire::Histogram& out) noexcept {
  static_assert(sizeof out.counts / sizeof out.counts[0] == rt::Histogram::kBuckets);
  std::copy(in.counts.begin(), in.counts.end(), out.counts);
  out.n = in.n;
  out.max_us = in.max_ns * 1e-3;
}

Vec3 from_wire(const geometry_msgs_msg_dds__Vector3_& in) noexcept { return {in.x, in.y, in.z}; }
Vec3 from_wire(const geometry_msgs_msg_dds__Point_& in) noexcept { return {in.x, in.y, in.z}; }

Pose from_wire(const geometry_msgs_msg_dds__Pose_& in) noexcept {
  return {from_wire(in.position), Quat(in.orientation.w, in.orientation.x, in.orientation.y, in.orientation.z)};
}

Twist from_wire(const geometry_msgs_msg_dds__Twist_& in) noexcept {
  return {from_wire(in.linear), from_wire(in.angular)};
}

Wrench from_wire(const geometry_msgs_msg_dds__Wrench_& in) noexcept {
  return {from_wire(in.force), from_wire(in.torque)};
}

rt::Histogram from_wire(const wire::Histogram& in) noexcept {
  rt::Histogram out;
  std::copy(std::begin(in.counts), std::end(in.counts), out.counts.begin());
  out.n = in.n;
  out.max_ns = in.max_us * 1e3;
  return out;
}

void to_wire(const Wrench& in, double (&out)[6]) noexcept { Eigen::Map<Vec6>{out} = in.vector(); }
Wrench wrench_from_wire(const double (&in)[6]) noexcept { return Wrench::from(Eigen::Map<const Vec6>{in}); }

void to_wire(const Mat6& in, double (&out)[36]) noexcept {
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{out} = in;
}
Mat6 from_wire(const double (&in)[36]) noexcept {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{in};
}

void to_wire(const Mat3& in, double (&out)[9]) noexcept {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{out} = in;
}
Mat3 from_wire(const double (&in)[9]) noexcept {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{in};
}

void to_wire_symmetric(const Mat6& in, double (&out)[21]) noexcept {
  for (int row = 0, i = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) out[i++] = in(row, column);
  }
}

Mat6 symmetric_from_wire(const double (&in)[21]) noexcept {
  Mat6 out;
  for (int row = 0, i = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) out(row, column) = out(column, row) = in[i++];
  }
  return out;
}

}  // namespace tact
