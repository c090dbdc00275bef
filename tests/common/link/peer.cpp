// link_test_peer <what> <session> <transport> [<hash>]: the other process of the transport tests.
//   contact   answers every pose (F.x = its seq) until SIGTERM, from a scene of that hash
//   coupling  connects, proves the transport, prints the result, then sends 1 kHz for ever
//   listener  prints each Health detail heard
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "fault/fault.hpp"
#include "link/haptic_connector.hpp"
#include "link/transport_proof.hpp"
#include "service/stop_signal.hpp"

namespace tact {
namespace {

using namespace std::chrono_literals;

void contact(const Session& session, std::uint64_t hash) {
  StopSignal stop;
  const Participant low(wire::Channel::session, session), haptic(wire::Channel::haptic, session);
  HealthReporter health(low, "contact", session.machine.transport);
  HealthMonitor monitor(low);
  HapticConnector<ContactEnds> connector(haptic, session.machine.transport, health, monitor);
  health.phase(wire::kConnecting);
  while (!stop.requested()) {
    const auto ends = connector.poll();
    if (!ends) continue;
    std::printf("connected\n");
    std::fflush(stdout);
    while (connector.peer_alive() && !stop.requested()) {
      ends->in.wait(20'000'000);
      wire::ToolPose pose;
      if (!ends->in.take_newest(pose)) continue;
      wire::ContactWrench reply{};
      reply.session_id = pose.session_id;
      reply.server_epoch = process_epoch();
      reply.F[0] = static_cast<double>(pose.seq);
      reply.X_WT.orientation.w = reply.X_WO.orientation.w = 1;
      reply.field_hash = reply.shell_hash = hash;
      reply.pose_epoch = pose.epoch;
      reply.pose_seq = pose.seq;
      ends->out.write(reply);
    }
    connector.drop();
  }
}

void coupling(const Session& session) {
  StopSignal stop;
  const Participant low(wire::Channel::session, session), haptic(wire::Channel::haptic, session);
  HealthReporter health(low, "coupling", session.machine.transport);
  HealthMonitor monitor(low);
  HapticConnector<CouplingEnds> connector(haptic, session.machine.transport, health, monitor);
  health.phase(wire::kConnecting);
  while (!stop.requested()) {
    const auto ends = connector.poll();
    if (!ends) continue;
    CallGuard guard;
    wire::ToolPose pose{};
    pose.epoch = process_epoch();
    const auto proof = prove_transport(*ends, pose, guard, 2000);
    std::printf("answered=%d no_datagrams=%d %s\n", proof.answered, proof.no_datagrams, proof.text().c_str());
    std::fflush(stdout);
    while (connector.peer_alive() && !stop.requested()) {
      ends->out.write(pose);
      std::this_thread::sleep_for(1ms);
    }
    std::printf("peer lost\n");
    std::fflush(stdout);
    connector.drop();
  }
}

void listener(const Session& session) {
  StopSignal stop;
  const Participant low(wire::Channel::session, session);
  Subscriber<wire::Health> in(low);
  std::printf("listening\n");
  std::fflush(stdout);
  while (!stop.requested()) {
    in.wait(20'000'000);
    for (wire::Health h; in.take(h);) {
      std::printf("heard %s\n", h.detail);
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace tact

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) return 64;
  tact::Session session;
  session.name = argv[2];
  session.machine.transport = argv[3];
  try {
    if (!std::strcmp(argv[1], "contact")) tact::contact(session, argc == 5 ? std::strtoull(argv[4], nullptr, 10) : 0);
    if (!std::strcmp(argv[1], "coupling")) tact::coupling(session);
    if (!std::strcmp(argv[1], "listener")) tact::listener(session);
  } catch (const tact::SetupError& e) {
    std::printf("SetupError: %s\n", e.what());
    return 2;
  }
  if (tact::endpoints_abandoned()) {
    std::fflush(stdout);
    std::_Exit(0);
  }
}
