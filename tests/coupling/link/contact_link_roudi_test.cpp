// A program of its own: a process that lost its RouDi cannot use another.
#include <gtest/gtest.h>
#include <signal.h>

#include "coupling/link/contact_link.hpp"
#include "coupling/link/loop_stand_in.hpp"
#include "fault/fault.hpp"
#include "link/roudi.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

TEST(ContactLinkAndRoudi, ThatItIsStoppedAndItsDeathAreReportedWhileTheConnectionGoesOn) {
  const test::ScratchDir dir;
  const Session session = make_session("shm");
  RoudiLease lease(share_dir() / "roudi.toml");
  if (lease.foreign()) GTEST_SKIP() << "RouDi is somebody else's";
  Mailboxes mail;
  const Participant low(wire::Channel::session, session);
  HealthReporter health(low, "coupling", "shm");
  ContactLink link(session, low, health, mail, {});
  Loop loop(mail);
  test::Process server({TACT_PEER, "contact", session.name, "shm"}, dir.path() / "server");
  link.start();
  ASSERT_TRUE(link.wait_active(20s));
  const auto degraded = [&] { return (health.now().faults & bit(Fault::transport_degraded)) != 0; };
  ::kill(lease.pid(), SIGSTOP);
  ASSERT_TRUE(test::eventually(degraded)) << "it reads no messages";
  ::kill(lease.pid(), SIGCONT);
  EXPECT_TRUE(test::eventually([&] { return !degraded() && health.now().phase == wire::kActive; }));
  ::kill(lease.pid(), SIGKILL);
  ASSERT_TRUE(test::eventually(degraded));
  const std::uint64_t before = loop.replies;
  EXPECT_TRUE(test::eventually([&] { return loop.replies > before + 300; }));
  EXPECT_TRUE(link.status().active);
  link.stop();
}

}  // namespace
}  // namespace tact::coupling
