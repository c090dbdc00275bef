#pragma once
#include <cstdint>
#include <string>

#include "link/call_guard.hpp"
#include "link/haptic_ends.hpp"

namespace tact {

/// Datagrams this network namespace has sent, from /proc/net/snmp.
std::uint64_t udp_datagrams_sent();

struct TransportProof {
  bool answered = false;  ///< every pose was
  /// Neither direction used the network: fewer datagrams than four fifths of the round trips. A single direction on UDP
  /// makes as many as round trips, and acknowledgements.
  bool no_datagrams = false;
  int round_trips = 0;
  std::uint64_t datagrams = 0;                   ///< of the exchange: its median tenth, less those of others, times ten
  std::uint64_t field_hash = 0, shell_hash = 0;  ///< what the server answers with, from its last reply
  double p50_us = 0, p99_us = 0, max_us = 0;
  std::string text() const;  ///< "500 round trips, p50 25 us, p99 60 us, max 190 us, 3 datagrams"
};

/// Sequence numbers of proof poses have this bit: their replies are never mistaken for those of ticks.
inline constexpr std::uint64_t kProofSeq = std::uint64_t{1} << 63;

/// Sends `round_trips` (a multiple of ten) copies of `pose` (TOOL_POSE_QUERY_ONLY set) one after the other, each after
/// the reply to the one before, in ten blocks. Datagrams are counted over each block; where there are many, again over
/// a quiet time as long, to take off those of other processes. The median block decides; three attempts. Coupling's
/// side, on its writing thread; the guard may be abandoned meanwhile (answered is false then, and the caller returns at
/// once).
TransportProof prove_transport(CouplingEnds& ends, wire::ToolPose pose, CallGuard& guard, int round_trips = 500);

}  // namespace tact
