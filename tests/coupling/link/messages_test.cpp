#include "coupling/link/messages.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "link/convert.hpp"

namespace tact::coupling {
namespace {

TEST(Messages, AToolSampleKeepsItsNumbers) {
  ToolSample sample;
  sample.seq = 42;
  sample.t_mono_ns = 7;
  sample.step_ns = 1'000'000;
  sample.X_WT.p = Vec3(1, 2, 3);
  sample.V_WT.angular = Vec3(4, 5, 6);
  sample.X_WO.p = Vec3(7, 8, 9);
  wire::ToolPose pose;
  to_wire(sample, 11, 12, pose);
  EXPECT_EQ(pose.session_id, 11u);
  EXPECT_EQ(pose.epoch, 12u);
  EXPECT_EQ(pose.seq, 42u);
  EXPECT_EQ(pose.step_ns, 1'000'000);
  EXPECT_EQ(pose.X_WT.position.z, 3);
  EXPECT_EQ(pose.V_WT.angular.x, 4);
  EXPECT_EQ(pose.X_WO.position.y, 8);
}

wire::ContactWrench some_wrench() {
  wire::ContactWrench w{};
  for (int i = 0; i < 6; ++i) w.F[i] = i;
  for (int i = 0; i < 36; ++i) w.G[i] = i;
  for (int i = 0; i < 21; ++i) w.K[i] = w.B[i] = i;
  w.X_WT.orientation.w = w.X_WO.orientation.w = 1;
  w.pose_seq = 3;
  w.max_depth_m = 0.5;
  return w;
}

TEST(Messages, AReplyKeepsItsMatrices) {
  ContactReply reply;
  from_wire(some_wrench(), reply);
  EXPECT_EQ(reply.F_W.torque, Vec3(3, 4, 5));
  EXPECT_EQ(reply.G(1, 0), 6);
  EXPECT_EQ(reply.K(0, 1), 1);
  EXPECT_EQ(reply.K, reply.K.transpose());
  EXPECT_EQ(reply.B(5, 5), 20);
  EXPECT_EQ(reply.pose_seq, 3u);
  EXPECT_EQ(reply.max_depth_m, 0.5);
}

TEST(Messages, ASingleBadNumberMakesAReplyNotFinite) {
  EXPECT_TRUE(finite(some_wrench()));
  const double bad[]{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
  for (const double b : bad) {
    auto w = some_wrench();
    w.F[3] = b;
    EXPECT_FALSE(finite(w));
    w = some_wrench();
    w.G[35] = b;
    EXPECT_FALSE(finite(w));
    w = some_wrench();
    w.B[20] = b;
    EXPECT_FALSE(finite(w));
    w = some_wrench();
    w.X_WT.orientation.x = b;
    EXPECT_FALSE(finite(w));
    w = some_wrench();
    w.clearance_m = b;
    EXPECT_FALSE(finite(w));
  }
}

TEST(Messages, StatusBecomesMicroseconds) {
  LoopStatus status;
  status.tick_ns_max = 1500;
  status.round_trip_ns = 25'000;
  status.stats.faults_ever = 3;
  wire::DeviceState out;
  to_wire(status, 9, "simulated", "impedance", out);
  EXPECT_DOUBLE_EQ(out.tick_us_max, 1.5);
  EXPECT_DOUBLE_EQ(out.round_trip_us, 25);
  EXPECT_EQ(out.faults_ever, 3u);
  EXPECT_STREQ(out.mode, "impedance");
}

}  // namespace
}  // namespace tact::coupling
