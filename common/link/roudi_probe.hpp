#pragma once
#include <chrono>
#include <cstdint>

namespace tact {

inline constexpr const char* kRoudiSocket = "/tmp/roudi";

enum class RoudiState { absent, reachable, hung, forbidden };

/// Looks at RouDi's socket; sends nothing. Waits up to `patience` for a full queue to drain before it says hung.
RoudiState probe_roudi(std::chrono::milliseconds patience);

/// Tells one RouDi from its successor; 0: none. Clients of an old one must not talk to a new one: it does not know
/// them.
std::uint64_t roudi_instance() noexcept;

}  // namespace tact
