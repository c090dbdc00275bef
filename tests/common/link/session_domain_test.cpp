#include <gtest/gtest.h>
#include <unistd.h>

#include "link/health.hpp"
#include "support/process.hpp"

namespace tact {
namespace {

Session named(const std::string& name) {
  Session session;
  session.name = name + std::to_string(::getpid());
  session.machine.transport = "udp";
  return session;
}

TEST(SessionDomain, AnotherProcessHearsTheHealthOfAService) {
  const test::ScratchDir dir;
  const Session session = named("a");
  test::Process peer({TACT_PEER, "listener", session.name, "udp"}, dir.path() / "log");
  const Participant participant(wire::Channel::session, session);
  HealthReporter health(participant, "contact", "udp");
  health.phase(wire::kLoading, "field 40 %", 0.4);
  EXPECT_TRUE(test::eventually([&] { return peer.output().find("heard field 40 %") != std::string::npos; }));
}

TEST(SessionDomain, SessionsDoNotHearEachOther) {
  const test::ScratchDir dir;
  const Session session = named("b");
  test::Process own({TACT_PEER, "listener", session.name, "udp"}, dir.path() / "own");
  test::Process other({TACT_PEER, "listener", session.name + "x", "udp"}, dir.path() / "other");
  const Participant participant(wire::Channel::session, session);
  HealthReporter health(participant, "contact", "udp");
  health.phase(wire::kLoading, "mine");
  ASSERT_TRUE(test::eventually([&] { return other.output().find("listening") != std::string::npos; }));
  ASSERT_TRUE(test::eventually([&] { return own.output().find("heard mine") != std::string::npos; }));
  health.phase(wire::kLoading, "again");
  ASSERT_TRUE(test::eventually([&] { return own.output().find("heard again") != std::string::npos; }));
  EXPECT_EQ(other.output().find("heard"), std::string::npos);
}

TEST(SessionDomain, AMonitorKnowsTheNewestIncarnationOfEachServiceOnly) {
  const Session session = named("c");
  const Participant participant(wire::Channel::session, session);
  Publisher<wire::Health> publisher(participant);
  HealthMonitor monitor(participant);
  ASSERT_TRUE(test::eventually([&] { return publisher.matched() > 0; }));
  wire::Health h{};
  h.schema = wire::kSchema;
  const auto say = [&](const char* service, std::uint64_t epoch, wire::Phase phase) {
    wire::set_text(h.service, service);
    h.epoch = epoch;
    h.phase = phase;
    publisher.write(h);
    monitor.poll(1'000'000'000);
  };
  say("contact", 7, wire::kActive);
  say("coupling", 3, wire::kActive);
  say("contact", 6, wire::kStopping);  // the predecessor's last words
  ASSERT_TRUE(monitor.alive("contact"));
  EXPECT_EQ(monitor.alive("contact")->epoch, 7u);
  ASSERT_TRUE(monitor.alive("coupling"));
  say("contact", 7, wire::kStopping);
  EXPECT_FALSE(monitor.alive("contact"));
  EXPECT_EQ(monitor.latest("contact")->phase, wire::kStopping);
  EXPECT_FALSE(monitor.latest("view"));
}

TEST(SessionDomain, SequencesArriveWhole) {
  const Session session = named("d");
  const Participant participant(wire::Channel::session, session);
  Publisher<wire::ContactSet> publisher(participant);
  Subscriber<wire::ContactSet> subscriber(participant);
  ASSERT_TRUE(test::eventually([&] { return publisher.matched() > 0 && subscriber.matched() > 0; }));
  std::vector<wire::Contact> contacts(512);
  wire::ContactSet out{};
  out.contacts._buffer = contacts.data();
  out.contacts._maximum = 512;
  wire::Message<wire::ContactSet> in;
  for (const std::uint32_t n : {512u, 3u, 400u}) {
    contacts[n - 1].depth_m = n;
    out.contacts._length = n;
    ASSERT_TRUE(publisher.write(out));
    ASSERT_TRUE(subscriber.wait(5'000'000'000));
    ASSERT_TRUE(subscriber.take_newest(in));
    ASSERT_EQ(in.contacts._length, n);
    EXPECT_EQ(in.contacts._buffer[n - 1].depth_m, n);
  }
}

TEST(SessionDomain, TheEndOfAWriterLeavesTheReadersCopyAlone) {
  const Session session = named("f");
  const Participant participant(wire::Channel::session, session);
  Subscriber<wire::SceneInfo> subscriber(participant);
  wire::Message<wire::SceneInfo> in;
  {
    Publisher<wire::SceneInfo> publisher(participant);
    wire::LoadedPart part{};
    wire::SceneInfo out{};
    wire::set_text(out.scene, "alpha");
    out.loaded._buffer = &part;
    out.loaded._length = out.loaded._maximum = 1;
    publisher.write(out);
    ASSERT_TRUE(test::eventually([&] { return subscriber.take_newest(in); }));
  }
  subscriber.wait(1'000'000'000);
  EXPECT_FALSE(subscriber.take_newest(in));
  EXPECT_STREQ(in.scene, "alpha");
  EXPECT_EQ(in.loaded._length, 1u);
}

TEST(SessionDomain, ALateReaderGetsTheScene) {
  const Session session = named("e");
  const Participant participant(wire::Channel::session, session);
  Publisher<wire::SceneInfo> publisher(participant);
  wire::SceneInfo out{};
  wire::set_text(out.scene, "alpha");
  ASSERT_TRUE(publisher.write(out));
  Subscriber<wire::SceneInfo> subscriber(participant);
  wire::Message<wire::SceneInfo> in;
  ASSERT_TRUE(subscriber.wait(5'000'000'000));
  ASSERT_TRUE(subscriber.take_newest(in));
  EXPECT_STREQ(in.scene, "alpha");
}

}  // namespace
}  // namespace tact
