#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>

#include "fault/fault.hpp"
#include "latency/latency.hpp"
#include "latency/real_time.hpp"
#include "link/haptic_connector.hpp"
#include "rt/tick.hpp"

namespace tact::latency {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr seconds kConnectLimit{20};
constexpr std::int64_t kReplyLimitNs = 100'000'000;

/// One side of a haptic connection, as in the services.
template <class Ends>
struct Side {
  Side(const Session& session, const char* service)
      : low(wire::Channel::session, session),
        haptic(wire::Channel::haptic, session, {.priority = kTransportPriority}),
        health(low, service, session.machine.transport),
        monitor(low),
        connector(haptic, session.machine.transport, health, monitor) {
    health.phase(wire::kConnecting);
  }
  std::shared_ptr<Ends> connect() {
    const auto limit = steady_clock::now() + kConnectLimit;
    while (steady_clock::now() < limit) {
      if (auto ends = connector.poll()) return ends;
    }
    throw SetupError("two processes did not find one another in 20 s: " + connector.state());
  }

  Participant low, haptic;
  HealthReporter health;
  HealthMonitor monitor;
  HapticConnector<Ends> connector;
};

[[noreturn]] void answer(const Session& session, const Effort& effort) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  try {
    const RealTime real_time;
    Side<ContactEnds> side(session, "contact");
    const auto ends = side.connect();
    real_time.run("answer", kLinkPriority, effort.cpu, [&] {
      wire::ToolPose pose;
      wire::ContactWrench reply{};
      reply.X_WT.orientation.w = reply.X_WO.orientation.w = 1;
      for (;;) {  // until killed
        if (!ends->in.wait(20'000'000) || !ends->in.take_newest(pose)) continue;
        reply.pose_seq = pose.seq;
        ends->out.write(reply);
      }
    });
  } catch (const SetupError&) {  // the other side says that nobody answers
  }
  ::_exit(0);
}

}  // namespace

Figure round_trip(const Effort& effort, const std::string& transport) {
  Session session;
  session.name = "latency-" + std::to_string(::getpid());
  session.machine.transport = transport;
  const pid_t child = ::fork();
  if (child < 0) throw SetupError("fork: no second process");
  if (child == 0) answer(session, effort);

  Figure figure;
  const RealTime real_time;
  std::vector<std::int64_t> trips;
  const auto count = static_cast<std::size_t>(effort.seconds * effort.rate_hz);
  trips.reserve(count);
  {
    Side<CouplingEnds> side(session, "coupling");
    const auto ends = side.connect();
    figure.conditions = real_time.run("ask", kLinkPriority, effort.cpu, [&] {
      rt::Ticker ticker(static_cast<std::int64_t>(std::llround(1e9 / effort.rate_hz)));
      wire::ToolPose pose{};
      wire::ContactWrench reply;
      for (std::uint64_t i = 1; i <= count; ++i) {
        figure.missed += ticker.wait().skipped;
        pose.seq = i;
        const std::int64_t start = rt::monotonic_ns();
        ends->out.write(pose);
        bool answered = false;
        while (!answered && rt::monotonic_ns() - start < kReplyLimitNs) {
          answered = ends->in.wait(kReplyLimitNs) && ends->in.take_newest(reply) && reply.pose_seq == i;
        }
        if (answered) trips.push_back(rt::monotonic_ns() - start);
        if (!answered && ++figure.missed > 20) return;
      }
    });
    // The endpoints go while the peer lives: after a kill their destruction may hang.
    side.connector.drop();
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  if (trips.empty()) figure.error = "no reply came";
  figure.spread = spread_of(std::move(trips));
  return figure;
}

}  // namespace tact::latency
