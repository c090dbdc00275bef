#pragma once
#include "coupling/loop/mailboxes.hpp"
#include "link/wire.hpp"

/// Coupling's own types to and from the wire. Real-time safe: none allocates or throws.
namespace tact::coupling {

void to_wire(const ToolSample& in, std::uint64_t session_id, std::uint64_t epoch, wire::ToolPose& out) noexcept;
/// received_mono_ns is left alone.
void from_wire(const wire::ContactWrench& in, ContactReply& out) noexcept;
/// Every number that forces are computed from is finite.
bool finite(const wire::ContactWrench& reply) noexcept;

/// `device` and `mode` as in the machine file.
void to_wire(const LoopStatus& in, std::uint64_t epoch, const char* device, const char* mode,
             wire::DeviceState& out) noexcept;
void to_wire(const LoopStats& in, std::uint64_t epoch, const Pose& X_WM, wire::SessionStats& out) noexcept;

}  // namespace tact::coupling
