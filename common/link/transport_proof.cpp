#include "link/transport_proof.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "rt/histogram.hpp"

namespace tact {
namespace {

constexpr std::int64_t kReplyLimitNs = 200'000'000;

std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds{1}; }

/// False when it was not answered in time or the thread was given up.
bool round_trip(CouplingEnds& ends, const wire::ToolPose& pose, CallGuard& guard, wire::ContactWrench& reply) {
  guard.enter_write();
  const bool written = ends.out.write(pose);
  if (!guard.leave() || !written) return false;
  const std::int64_t until = now_ns() + kReplyLimitNs;
  for (std::int64_t left = kReplyLimitNs; left > 0; left = until - now_ns()) {
    bool answered = false;
    guard.enter_read();
    ends.in.wait(left);
    while (!answered && ends.in.take(reply)) {
      answered = reply.pose_epoch == pose.epoch && reply.pose_seq == pose.seq;
    }
    if (!guard.leave()) return false;
    if (answered) return true;
  }
  return false;
}

}  // namespace

std::uint64_t udp_datagrams_sent() {
  // "Udp: InDatagrams NoPorts InErrors OutDatagrams ..." and below it the numbers.
  std::ifstream file("/proc/net/snmp");
  std::string names, values;
  while (std::getline(file, names) && std::getline(file, values)) {
    if (names.rfind("Udp:", 0) != 0) continue;
    std::istringstream name(names), value(values);
    std::string n, v;
    while (name >> n && value >> v) {
      if (n == "OutDatagrams") return std::stoull(v);
    }
  }
  return 0;
}

std::string TransportProof::text() const {
  std::ostringstream out;
  out.precision(3);
  out << round_trips << " round trips, p50 " << p50_us << " us, p99 " << p99_us << " us, max " << max_us << " us, "
      << datagrams << " datagrams";
  return out.str();
}

TransportProof prove_transport(CouplingEnds& ends, wire::ToolPose pose, CallGuard& guard, int round_trips) {
  constexpr int kBlocks = 10;
  const int block = round_trips / kBlocks;
  const std::uint64_t limit = static_cast<std::uint64_t>(block) * 4 / 5;
  TransportProof proof;
  wire::ContactWrench reply{};
  pose.flags |= tact_haptic_TOOL_POSE_QUERY_ONLY;
  pose.seq = kProofSeq;
  for (int attempt = 0; attempt < 3 && !proof.no_datagrams; ++attempt) {
    proof = {};
    rt::Histogram times;
    std::array<std::uint64_t, kBlocks> datagrams{};
    for (std::uint64_t& count : datagrams) {
      const std::uint64_t before = udp_datagrams_sent();
      const std::int64_t begin_ns = now_ns();
      for (int i = 0; i < block; ++i, ++proof.round_trips) {
        ++pose.seq;
        pose.t_mono_ns = now_ns();
        if (!round_trip(ends, pose, guard, reply)) return proof;
        times.add(now_ns() - pose.t_mono_ns);
      }
      const std::int64_t took_ns = now_ns() - begin_ns;
      const std::uint64_t after = udp_datagrams_sent();
      count = after - before;
      if (count < limit) continue;
      // Ours, or those of others on this machine? Count as long again while we are quiet.
      std::this_thread::sleep_for(std::chrono::nanoseconds{took_ns});
      count -= std::min(count, udp_datagrams_sent() - after);
    }
    // The median block: others may burst or stall in some of them.
    std::sort(datagrams.begin(), datagrams.end());
    const std::uint64_t typical = datagrams[kBlocks / 2];
    proof.answered = true;
    proof.field_hash = reply.field_hash;
    proof.shell_hash = reply.shell_hash;
    proof.no_datagrams = typical < limit;
    proof.datagrams = typical * kBlocks;
    proof.p50_us = times.percentile_ns(0.5) * 1e-3;
    proof.p99_us = times.percentile_ns(0.99) * 1e-3;
    proof.max_us = times.max_ns * 1e-3;
  }
  return proof;
}

}  // namespace tact
