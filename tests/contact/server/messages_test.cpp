#include "contact/server/messages.hpp"

#include <gtest/gtest.h>

#include "contact/server/sphere_scene.hpp"
#include "fault/fault.hpp"
#include "link/convert.hpp"
#include "math/exp_log.hpp"

namespace tact::contact {
namespace {

TEST(ServerMessages, ContactForcesSumToTheWrench) {
  ContactSpec spec;
  spec.law = "global";
  ContactPipeline pipeline(test::sphere_field(), test::sphere_points(400), 4096,
                           pipeline_params(spec, test::kVoxel, 0.2, 3));
  ToolQuery query;
  query.X_WO = {Vec3(1, 2, 3), exp_so3(Vec3(0.3, -1, 0.5))};
  query.X_WT = query.X_WO * test::touching(0.001);
  const ContactResult& result = pipeline.step(query);
  ASSERT_GT(result.contact_count, 3u);
  ContactSnapshot snapshot;
  SnapshotTaker(4096).take(pipeline.contacts(), result, snapshot);
  std::vector<wire::Contact> items(ContactSnapshot::kMax);
  wire::ContactSet set;
  to_wire(snapshot, 9, "global", items, set);
  EXPECT_EQ(set.server_epoch, 9u);
  EXPECT_EQ(set.contacts._length, result.contact_count);
  EXPECT_STREQ(set.law, "global");
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (std::uint32_t i = 0; i < set.contacts._length; ++i) {
    const wire::Contact& c = set.contacts._buffer[i];
    const Vec3 f = tact::from_wire(c.force_W);
    force += f;
    torque += (tact::from_wire(c.p_W) - query.X_WT.p).cross(f);
  }
  EXPECT_LT((force - result.response_W.F.force).norm(), 1e-9 * force.norm());
  EXPECT_LT((torque - result.response_W.F.torque).norm(), 1e-9);
}

TEST(ServerMessages, AReplyCarriesTheResult) {
  ContactResult result;
  result.response_W.F = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
  result.response_W.G(2, 1) = 7;
  result.response_W.K.setIdentity();
  result.contact_count = 5;
  result.clearance_m = 0.25;
  wire::ContactWrench out{};
  to_wire(result, out);
  EXPECT_EQ(out.F[5], 6);
  EXPECT_EQ(out.G[2 * 6 + 1], 7);
  EXPECT_EQ(out.K[0], 1);
  EXPECT_EQ(out.K[6], 1);
  EXPECT_EQ(out.contact_count, 5u);
  EXPECT_EQ(out.clearance_m, 0.25);
}

TEST(ServerMessages, EveryPartLoadedIsTold) {
  LoadedScene scene;
  scene.field = test::sphere_field();
  scene.shell = test::sphere_points(100);
  scene.parts = {{"field of block, 100^3", 1.5, 1000}, {"100 points of peg", 0.5, 50}};
  SceneSpec spec;
  spec.name = "spheres";
  PipelineParams params;
  params.law = "none";
  params.version = 4;
  std::vector<wire::LoadedPart> parts;
  wire::SceneInfo info;
  to_wire(scene, spec, params, 7, parts, info);
  ASSERT_EQ(info.loaded._length, 2u);
  EXPECT_STREQ(info.loaded._buffer[1].what, "100 points of peg");
  EXPECT_EQ(info.loaded._buffer[0].bytes, 1000u);
  EXPECT_STREQ(info.scene, "spheres");
  EXPECT_EQ(info.points, 100u);
  EXPECT_EQ(info.params_version, 4u);
  EXPECT_EQ(info.voxel_m, test::kVoxel);
}

TEST(ServerMessages, StatusBitsBecomeFaults) {
  EXPECT_EQ(faults_of(0), 0u);
  EXPECT_EQ(faults_of(bit(Status::overflow)), tact::bit(Fault::contacts_full));
  EXPECT_EQ(faults_of(bit(Status::pose_invalid) | bit(Status::beyond_band)),
            tact::bit(Fault::not_finite) | tact::bit(Fault::beyond_band));
  EXPECT_EQ(faults_of(bit(Status::capped)), 0u);  // the law at work, no fault
}

}  // namespace
}  // namespace tact::contact
