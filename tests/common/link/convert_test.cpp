#include "link/convert.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace tact {
namespace {

Pose some_pose() { return {Vec3(1, -2, 3), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -2).normalized()))}; }

TEST(Convert, PoseComesBackBitForBit) {
  geometry_msgs_msg_dds__Pose_ wire{};
  to_wire(some_pose(), wire);
  const Pose back = from_wire(wire);
  EXPECT_EQ(back.p, some_pose().p);
  EXPECT_EQ(back.q.coeffs(), some_pose().q.coeffs());
}

TEST(Convert, QuaternionFieldsAreWhatTheirNamesSay) {
  geometry_msgs_msg_dds__Pose_ wire{};
  to_wire(Pose{Vec3::Zero(), Quat(0.5, 0.1, 0.2, 0.3)}, wire);
  EXPECT_EQ(wire.orientation.w, 0.5);
  EXPECT_EQ(wire.orientation.x, 0.1);
  EXPECT_EQ(wire.orientation.z, 0.3);
}

TEST(Convert, MatricesGoRowByRow) {
  Mat6 G;
  for (int i = 0; i < 36; ++i) G(i / 6, i % 6) = i;
  double wire[36];
  to_wire(G, wire);
  for (int i = 0; i < 36; ++i) EXPECT_EQ(wire[i], i);
  EXPECT_EQ(from_wire(wire), G);
}

TEST(Convert, SymmetricMatricesSendTheirUpperTriangle) {
  const Mat6 A = Mat6::Random();
  const Mat6 K = A * A.transpose();
  double wire[21];
  to_wire_symmetric(K, wire);
  EXPECT_EQ(wire[0], K(0, 0));
  EXPECT_EQ(wire[5], K(0, 5));
  EXPECT_EQ(wire[6], K(1, 1));
  EXPECT_EQ(wire[20], K(5, 5));
  EXPECT_TRUE(symmetric_from_wire(wire).isApprox(K, 1e-15));
}

TEST(Convert, ForceComesBeforeTorque) {
  double wire[6];
  to_wire(Wrench{Vec3(1, 2, 3), Vec3(4, 5, 6)}, wire);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(wire[i], i + 1);
  EXPECT_EQ(wrench_from_wire(wire).torque, Vec3(4, 5, 6));
}

TEST(Convert, HistogramKeepsItsPercentiles) {
  rt::Histogram h;
  for (int i = 1; i <= 1000; ++i) h.add(i * 1000);
  wire::Histogram wire{};
  to_wire(h, wire);
  const rt::Histogram back = from_wire(wire);
  EXPECT_EQ(back.percentile_ns(0.5), h.percentile_ns(0.5));
  EXPECT_EQ(back.n, 1000u);
  EXPECT_DOUBLE_EQ(back.max_ns, 1e6);
}

TEST(Convert, TextIsCutAtACharacterBorder) {
  char field[5];
  wire::set_text(field, "abcdefg");
  EXPECT_STREQ(field, "abcd");
  wire::set_text(field, "abc\xC3\xA9");  // the last letter takes two bytes
  EXPECT_STREQ(field, "abc");
  wire::set_text(field, "");
  EXPECT_STREQ(field, "");
}

}  // namespace
}  // namespace tact
