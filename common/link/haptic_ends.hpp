#pragma once
#include <cstdint>
#include <string>

#include "link/endpoint.hpp"

namespace tact {

/// Both endpoints of one side of the haptic connection between one coupling incarnation and one server incarnation.
/// Topic names carry both, so the queues a crash left locked are never met again.
template <class Out, class In>
struct HapticEnds {
  HapticEnds(const Participant& haptic, std::uint64_t coupling_epoch, std::uint64_t server_epoch)
      : out(haptic, std::to_string(coupling_epoch) + "_" + std::to_string(server_epoch)),
        in(haptic, std::to_string(coupling_epoch) + "_" + std::to_string(server_epoch)) {}

  bool matched() const noexcept { return out.matched() > 0 && in.matched() > 0; }
  bool shared_memory_capable() const noexcept { return out.shared_memory_capable() && in.shared_memory_capable(); }
  void abandon() noexcept {
    out.abandon();
    in.abandon();
  }

  Publisher<Out> out;
  Subscriber<In> in;
};

using CouplingEnds = HapticEnds<wire::ToolPose, wire::ContactWrench>;
using ContactEnds = HapticEnds<wire::ContactWrench, wire::ToolPose>;

}  // namespace tact
