#include "coupling/link/session_link.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "coupling/link/some_scene.hpp"
#include "fault/fault.hpp"
#include "file/sealed_file.hpp"
#include "link/convert.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

using namespace std::chrono_literals;

Session make_session(const std::string& device, const std::filesystem::path& run_dir) {
  Session session;
  session.name = std::to_string(::getpid()) + "-low";
  session.run_dir = run_dir;
  session.machine.device = device;
  session.machine.transport = "udp";
  return session;
}

struct Fixture {
  explicit Fixture(const std::string& device = "simulated") : session(make_session(device, dir.path())) {}
  /// Calls `say` until `heard`: discovery takes a moment.
  static bool until(const std::function<void()>& say, const std::function<bool()>& heard) {
    return test::eventually([&] {
      say();
      std::this_thread::sleep_for(20ms);
      return heard();
    });
  }

  const test::ScratchDir dir;
  const Session session;
  Mailboxes mail;
  const Participant low{wire::Channel::session, session};
  HealthReporter health{low, "coupling", "udp"};
  SessionLink link{session, low, health, mail};
};

TEST(SessionLink, StateAndStatisticsArePublished) {
  Fixture f;
  Subscriber<wire::DeviceState> states(f.low);
  Subscriber<wire::SessionStats> stats(f.low);
  f.link.start({});
  LoopStatus status;
  status.tick = 5;
  status.stats.ticks = 5;
  status.faults = bit(Fault::motion_capped);
  wire::DeviceState state{};
  wire::SessionStats total{};
  ASSERT_TRUE(f.until([&] { f.mail.status.write(status); }, [&] { return states.take_newest(state); }));
  EXPECT_EQ(state.tick, 5u);
  EXPECT_STREQ(state.device, "simulated");
  EXPECT_EQ(f.health.now().faults & bit(Fault::motion_capped), bit(Fault::motion_capped));
  status.stats.ticks = 99;
  f.mail.status.write(status);
  f.link.stop();
  ASSERT_TRUE(test::eventually([&] { return stats.take_newest(total) && total.ticks == 99; }));
}

TEST(SessionLink, AParameterIsAcknowledgedOnceTheLoopHasIt) {
  Fixture f;
  Publisher<wire::Parameter> requests(f.low);
  Subscriber<wire::ParameterAck> acks(f.low);
  f.link.start({});
  wire::Parameter request{};
  request.request_id = 1;
  wire::set_text(request.service, "coupling");
  wire::set_text(request.key, "coupling.stiffness_n_per_m");
  wire::set_text(request.value, "1234");
  LoopParameters in_force;
  wire::ParameterAck ack{};
  ASSERT_TRUE(test::eventually([&] { return requests.matched() > 0 && acks.matched() > 0; }));
  requests.write(request);
  ASSERT_TRUE(test::eventually([&] { return f.mail.parameters.read(in_force); }));
  EXPECT_EQ(in_force.stiffness_n_per_m, 1234);
  EXPECT_FALSE(acks.take(ack));
  LoopStatus status;
  status.parameters_version = in_force.version;
  f.mail.status.write(status);
  ASSERT_TRUE(test::eventually([&] { return acks.take(ack); }));
  EXPECT_TRUE(ack.accepted);
  EXPECT_EQ(ack.request_id, 1u);
  EXPECT_EQ(ack.params_version, in_force.version);
}

TEST(SessionLink, ParametersThatCannotChangeAreRefusedWithTheReason) {
  Fixture f;
  Publisher<wire::Parameter> requests(f.low);
  Subscriber<wire::ParameterAck> acks(f.low);
  f.link.start({});
  ASSERT_TRUE(test::eventually([&] { return requests.matched() > 0 && acks.matched() > 0; }));
  for (const auto& [key, value] : {std::pair{"coupling.mass_kg", "1"}, {"coupling.damping_ratio", "much"}}) {
    wire::Parameter request{};
    wire::set_text(request.service, "coupling");
    wire::set_text(request.key, key);
    wire::set_text(request.value, value);
    requests.write(request);
    wire::ParameterAck ack{};
    ASSERT_TRUE(test::eventually([&] { return acks.take(ack); }));
    EXPECT_FALSE(ack.accepted);
    EXPECT_NE(std::string(ack.message).find(key), std::string::npos) << ack.message;
  }
  LoopParameters in_force;
  EXPECT_FALSE(f.mail.parameters.read(in_force));
}

TEST(SessionLink, AHandThatFallsSilentLetsGo) {
  Fixture f;
  Publisher<wire::HandTarget> hands(f.low);
  f.link.start({});
  wire::HandTarget hand{};
  hand.hold = true;
  to_wire(Pose{Vec3(1, 2, 3), Quat::Identity()}, hand.X_WM);
  HandTargetSample sample;
  ASSERT_TRUE(f.until([&] { hands.write(hand); }, [&] { return f.mail.hand.read(sample); }));
  EXPECT_TRUE(sample.hold);
  EXPECT_EQ(sample.X_WM.p, Vec3(1, 2, 3));
  ASSERT_TRUE(test::eventually([&] { return f.mail.hand.read(sample) && !sample.hold; }));
}

TEST(SessionLink, HandsAreRefusedWhileARealDeviceIsEngaged) {
  Fixture f("virtuose");
  Publisher<wire::HandTarget> hands(f.low);
  Subscriber<wire::DeviceState> states(f.low);
  f.link.start({});
  LoopStatus status;
  status.engaged = true;
  wire::DeviceState state{};
  ASSERT_TRUE(f.until([&] { f.mail.status.write(status); },
                      [&] { return states.take_newest(state) && state.engaged && hands.matched() > 0; }));
  wire::HandTarget hand{};
  hand.hold = true;
  hand.X_WM.orientation.w = 1;
  HandTargetSample sample;
  for (int i = 0; i < 20; ++i) {
    hands.write(hand);
    std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(f.mail.hand.read(sample));
  }
}

TEST(SessionLink, TheSceneIsTakenFromTheServer) {
  Fixture f;
  EXPECT_FALSE(f.link.wait_scene(10ms));
  Publisher<wire::SceneInfo> scenes(f.low);
  wire::SceneInfo info = some_scene();
  info.server_epoch = 4;
  info.X_TM.position.x = 0.25;
  scenes.write(info);
  const auto model = f.link.wait_scene(5s);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->server_epoch, 4u);
  EXPECT_EQ(model->X_TM.p.x(), 0.25);
}

TEST(SessionLink, ACouplingStartedAgainRefusesAnotherSceneThanTheSessionBeganWith) {
  Fixture f;
  const SceneIdentity first{11, 22};
  ASSERT_EQ(first_scene(f.session.run_dir, first), first);  // its predecessor
  Publisher<wire::SceneInfo> scenes(f.low);
  wire::SceneInfo info = some_scene();
  for (const SceneIdentity& other : {SceneIdentity{11, 23}, SceneIdentity{12, 22}}) {
    info.field_hash = other.field_hash;
    info.shell_hash = other.shell_hash;
    scenes.write(info);
    ASSERT_TRUE(test::eventually([&] {
      EXPECT_FALSE(f.link.wait_scene(10ms));
      return std::string(f.health.now().detail).find(hex(other.shell_hash)) != std::string::npos;
    }));
    EXPECT_EQ(f.health.now().faults, bit(Fault::scene_changed));
    EXPECT_EQ(f.health.now().phase, wire::kDegraded);
  }
  scenes.write(some_scene());
  const auto model = f.link.wait_scene(5s);
  ASSERT_TRUE(model) << "the right one came back";
  EXPECT_EQ(model->identity, first);
  EXPECT_EQ(f.health.now().faults, 0u);
}

TEST(SessionLink, ASceneWithoutSenseIsRefusedBeforeTheLoopBegins) {
  Fixture f;
  Publisher<wire::SceneInfo> scenes(f.low);
  wire::SceneInfo info = some_scene();
  info.voxel_m = 0;
  scenes.write(info);
  EXPECT_THROW(f.link.wait_scene(5s), SetupError);
}

}  // namespace
}  // namespace tact::coupling
