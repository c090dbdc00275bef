// ContactLink in this process, a server in another, real RouDi.
#include "coupling/link/contact_link.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "coupling/link/loop_stand_in.hpp"
#include "fault/fault.hpp"
#include "link/roudi.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

using namespace std::chrono_literals;

class ContactLinkTest : public ::testing::TestWithParam<const char*> {
 protected:
  test::Process start_server(const std::string& transport = GetParam(), const std::string& hash = "0") {
    return {{TACT_PEER, "contact", session_.name, transport, hash},
            dir_.path() / ("server" + std::to_string(servers_++))};
  }
  bool replies(std::uint64_t more) {
    const std::uint64_t before = loop_.replies;
    return test::eventually([&] { return loop_.replies > before + more; });
  }

  const test::ScratchDir dir_;
  int servers_ = 0;
  static void SetUpTestSuite() { lease_ = std::make_unique<RoudiLease>(share_dir() / "roudi.toml"); }
  static void TearDownTestSuite() { lease_.reset(); }
  static inline std::unique_ptr<RoudiLease> lease_;  // one for all: a process knows one RouDi in its life
  const Session session_ = make_session(GetParam());
  Mailboxes mail_;
  const Participant low_{wire::Channel::session, session_};
  HealthReporter health_{low_, "coupling", GetParam()};
  ContactLink link_{session_, low_, health_, mail_, {}};
  Loop loop_{mail_};
};

TEST_P(ContactLinkTest, EveryReplyBelongsToAPoseOfThisLoop) {
  auto server = start_server();
  link_.start();
  ASSERT_TRUE(link_.wait_active(20s));
  EXPECT_TRUE(replies(300));
  EXPECT_EQ(loop_.wrong, 0u);
  const wire::Health health = health_.now();
  EXPECT_EQ(health.phase, wire::kActive);
  EXPECT_EQ(health.shared_memory_proven, std::string(GetParam()) == "shm");
  std::printf("%s: %s\n", GetParam(), health.detail);
}

TEST_P(ContactLinkTest, AKilledServerIsFollowedByItsSuccessor) {
  link_.start();
  std::uint64_t last_epoch = 0;
  for (int round = 0; round < 3; ++round) {
    auto server = start_server();
    ASSERT_TRUE(test::eventually([&] { return link_.status().active; })) << health_.now().detail;
    ASSERT_TRUE(replies(100));
    EXPECT_GT(loop_.server_epoch, last_epoch);
    last_epoch = loop_.server_epoch;
    server.signal(SIGKILL);
    ASSERT_TRUE(test::eventually([&] { return !link_.status().active; }));
    EXPECT_TRUE(test::eventually([&] { return health_.now().phase == wire::kConnecting; }));
  }
  EXPECT_EQ(link_.status().connections, 3u);
  EXPECT_EQ(loop_.wrong, 0u);
}

TEST_P(ContactLinkTest, AServerRestartedWithAnotherMeshIsRefusedUntilTheRightOneComesBack) {
  link_.start();
  for (const char* hash : {"0", "1", "0"}) {
    auto server = start_server(GetParam(), hash);
    if (std::string(hash) == "0") {
      ASSERT_TRUE(test::eventually([&] { return link_.status().active; })) << health_.now().detail;
      EXPECT_EQ(health_.now().faults & bit(Fault::scene_changed), 0u);
      EXPECT_TRUE(replies(100));
    } else {
      const std::uint64_t before = loop_.replies;
      ASSERT_TRUE(test::eventually([&] { return health_.now().phase == wire::kDegraded; })) << health_.now().detail;
      EXPECT_EQ(health_.now().faults & ContactLink::kFaults & ~bit(Fault::peer_restarted), bit(Fault::scene_changed));
      const std::string detail = health_.now().detail;
      EXPECT_NE(detail.find("found field 0000000000000001"), std::string::npos) << detail;
      EXPECT_NE(detail.find("restart the session"), std::string::npos) << detail;
      const std::uint64_t tick = loop_.ticks;
      EXPECT_TRUE(test::eventually([&] { return loop_.ticks > tick + 1000; }));
      EXPECT_EQ(loop_.replies, before);
      EXPECT_FALSE(link_.status().active);
      EXPECT_EQ(health_.now().phase, wire::kDegraded) << "it says so as long as it is so";
    }
    server.signal(SIGKILL);
    ASSERT_TRUE(test::eventually([&] { return health_.now().phase == wire::kConnecting; }));
  }
  EXPECT_EQ(loop_.wrong, 0u);
}

TEST_P(ContactLinkTest, AServerThatStandsStillIsLostAndFoundAgain) {
  auto server = start_server();
  link_.start();
  ASSERT_TRUE(link_.wait_active(20s));
  ASSERT_TRUE(replies(10));
  server.signal(SIGSTOP);
  ASSERT_TRUE(test::eventually([&] { return !link_.status().active; }));
  server.signal(SIGCONT);
  ASSERT_TRUE(test::eventually([&] { return link_.status().active; })) << health_.now().detail;
  EXPECT_TRUE(replies(100));
  EXPECT_EQ(loop_.wrong, 0u);
}

TEST_P(ContactLinkTest, AServerOfAnotherTransportIsRefused) {
  auto server = start_server(std::string(GetParam()) == "shm" ? "udp" : "shm");
  link_.start();
  EXPECT_THROW(link_.wait_active(20s), SetupError);
}

TEST_P(ContactLinkTest, WithoutAServerItStopsAtOnce) {
  link_.start();
  EXPECT_FALSE(link_.wait_active(50ms));
  link_.stop();
}

INSTANTIATE_TEST_SUITE_P(Transports, ContactLinkTest, ::testing::Values("shm", "udp"),
                         [](const auto& chosen) { return std::string(chosen.param); });

}  // namespace
}  // namespace tact::coupling
