// The contact server in a process of its own, coupling's link here: the product's two ends, real RouDi.
#include <gtest/gtest.h>
#include <signal.h>

#include "coupling/link/contact_link.hpp"
#include "coupling/link/session_link.hpp"
#include "fault/fault.hpp"
#include "link/convert.hpp"
#include "link/roudi.hpp"
#include "rt/histogram.hpp"
#include "rt/periodic_thread.hpp"
#include "rt/realtime.hpp"
#include "support/process.hpp"

namespace tact {
namespace {

using namespace std::chrono_literals;
using coupling::ContactReply;
using coupling::ToolSample;

/// Presses the tool 1 mm into the field body, a thousand times a second, and measures the way round.
class Loop {
 public:
  explicit Loop(coupling::Mailboxes& mail)
      : mail_(mail),
        thread_(
            {.name = "loop", .priority = 80}, [ticker = rt::Ticker(1'000'000)]() mutable { return ticker.wait(); },
            [this](const rt::Tick&) noexcept { return tick(); }) {}
  std::atomic<std::uint64_t> replies{0}, late{0};
  std::atomic<double> force_x{0};
  std::atomic<std::uint64_t> params_version{0};
  /// After the loop ended.
  const rt::Histogram& round_trip() const { return round_trip_; }
  void stop() { thread_.stop(); }

 private:
  rt::Next tick() noexcept {
    ContactReply reply;
    if (mail_.reply.read(reply)) {
      round_trip_.add(reply.received_mono_ns - reply.pose_t_mono_ns);
      if (reply.pose_seq != sample_.seq) ++late;
      force_x = reply.F_W.force.x();
      params_version = reply.params_version;
      ++replies;
    }
    ++sample_.seq;
    sample_.X_WT.p = Vec3(0.059, 0, 0);
    sample_.t_mono_ns = std::chrono::steady_clock::now().time_since_epoch() / 1ns;
    mail_.tool.write(sample_);
    mail_.tool_ready.ring();
    return rt::Next::again;
  }

  coupling::Mailboxes& mail_;
  ToolSample sample_;
  rt::Histogram round_trip_;
  rt::PeriodicThread thread_;
};

class ContactServer : public ::testing::TestWithParam<const char*> {
 protected:
  static Session make_session() {
    Session session;
    session.name = std::to_string(::getpid()) + "-serve";
    session.machine.transport = GetParam();
    return session;
  }
  test::Process start_server() {
    return {{TACT_SERVER, session_.name, GetParam()}, dir_.path() / ("server" + std::to_string(servers_++))};
  }

  const test::ScratchDir dir_;
  int servers_ = 0;
  static void SetUpTestSuite() { lease_ = std::make_unique<RoudiLease>(share_dir() / "roudi.toml"); }
  static void TearDownTestSuite() { lease_.reset(); }
  static inline std::unique_ptr<RoudiLease> lease_;  // one for all: a process knows one RouDi in its life
  const Session session_ = make_session();
  coupling::Mailboxes mail_;
  const Participant low_{wire::Channel::session, session_};
  HealthReporter health_{low_, "coupling", GetParam()};
  coupling::ContactLink link_{session_, low_, health_, mail_, {}};
};

TEST_P(ContactServer, ThePoseComesBackAsAWrench) {
  const rt::CpuDmaLatency awake;
  auto server = start_server();
  Loop loop(mail_);
  link_.start();
  ASSERT_TRUE(link_.wait_active(20s)) << server.output();
  ASSERT_TRUE(test::eventually([&] { return loop.replies > 3000; }));
  EXPECT_GT(loop.force_x, 0.1);  // out of the body
  loop.stop();
  const rt::Histogram& h = loop.round_trip();
  std::printf(
      "%s: round trip with contact and link threads, p50 %.0f p99 %.0f p99.9 %.0f max %.0f us, %lu late of %lu\n",
      GetParam(), h.percentile_ns(0.5) / 1e3, h.percentile_ns(0.99) / 1e3, h.percentile_ns(0.999) / 1e3, h.max_ns / 1e3,
      loop.late.load(), loop.replies.load());
  std::printf("%s: %s\n", GetParam(), health_.now().detail);
}

TEST_P(ContactServer, AKilledServerComesBackAndForcesWithIt) {
  Loop loop(mail_);
  link_.start();
  for (int round = 0; round < 3; ++round) {
    auto server = start_server();
    ASSERT_TRUE(test::eventually([&] { return link_.status().active; })) << health_.now().detail;
    const std::uint64_t before = loop.replies;
    ASSERT_TRUE(test::eventually([&] { return loop.replies > before + 100; }));
    server.signal(SIGKILL);
    ASSERT_TRUE(test::eventually([&] { return !link_.status().active; }));
  }
}

TEST_P(ContactServer, ItsContactsSceneAndParametersAreOnTheSessionDomain) {
  Subscriber<wire::ContactSet> sets(low_);
  Subscriber<wire::SceneInfo> scenes(low_);
  Subscriber<wire::ParameterAck> acks(low_);
  Publisher<wire::Parameter> requests(low_);
  auto server = start_server();
  Loop loop(mail_);
  link_.start();
  ASSERT_TRUE(link_.wait_active(20s));
  wire::Message<wire::ContactSet> set;
  ASSERT_TRUE(test::eventually([&] { return sets.take_newest(set) && set.contacts._length > 0; }));
  EXPECT_STREQ(set.law, "potential");
  EXPECT_GT(set.contacts._buffer[0].depth_m, 0);
  wire::Message<wire::SceneInfo> scene;
  ASSERT_TRUE(test::eventually([&] { return scenes.take_newest(scene); }));
  EXPECT_EQ(scene.points, 2000u);

  ASSERT_TRUE(test::eventually([&] { return requests.matched() > 0; }));
  const auto ask = [&](const char* key, const char* value) {
    wire::Parameter request{};
    wire::set_text(request.service, "contact");
    wire::set_text(request.key, key);
    wire::set_text(request.value, value);
    requests.write(request);
    wire::ParameterAck ack{};
    EXPECT_TRUE(test::eventually([&] { return acks.take(ack); }));
    return ack;
  };
  const double before = loop.force_x;
  const wire::ParameterAck accepted = ask("contact.law", "none");
  EXPECT_TRUE(accepted.accepted) << accepted.message;
  ASSERT_TRUE(test::eventually([&] { return loop.params_version == accepted.params_version; }));
  EXPECT_GT(loop.force_x, before);  // nothing is scaled down any more
  ASSERT_TRUE(test::eventually([&] { return scenes.take_newest(scene) && std::string(scene.law) == "none"; }));
  const wire::ParameterAck refused = ask("contact.law", "magic");
  EXPECT_FALSE(refused.accepted);
  EXPECT_NE(std::string(refused.message).find("contact.law"), std::string::npos) << refused.message;
  EXPECT_FALSE(ask("contact.capacity", "100").accepted);
}

INSTANTIATE_TEST_SUITE_P(Transports, ContactServer, ::testing::Values("shm", "udp"),
                         [](const auto& chosen) { return std::string(chosen.param); });

}  // namespace
}  // namespace tact
