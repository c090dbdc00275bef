#pragma once
#include <cstdint>

#include "coupling/loop/loop_parameters.hpp"
#include "coupling/loop/loop_status.hpp"
#include "math/pose.hpp"
#include "rt/doorbell.hpp"
#include "rt/latest_value.hpp"

namespace tact::coupling {

/// ToolSample::flags and ContactReply::status, same bits as haptic.idl.
inline constexpr std::uint32_t kToolReset = 1, kToolQueryOnly = 2;
inline constexpr std::uint32_t kReplyOverflow = 1, kReplySignDoubtful = 2, kReplyPastMidSurface = 4,
                               kReplyBeyondBand = 8, kReplyCapped = 16, kReplyPoseInvalid = 32;

/// What the device loop publishes each tick: the wire's ToolPose in our own types.
struct ToolSample {
  std::uint64_t seq = 0;
  std::int64_t t_mono_ns = 0;
  std::int64_t step_ns = 0;
  std::uint32_t flags = 0;  ///< kTool*
  Pose X_WT, X_WO;
  Twist V_WT, V_WO;
};

/// The wire's ContactWrench in our own types, with the time it arrived.
struct ContactReply {
  std::uint64_t server_epoch = 0;
  std::uint64_t pose_seq = 0;  ///< of this coupling epoch: replies to other epochs are dropped by the link
  std::int64_t pose_t_mono_ns = 0;
  std::int64_t received_mono_ns = 0;
  std::int64_t compute_ns = 0;
  Pose X_WT, X_WO;        ///< used by the server
  Wrench F_W;             ///< on the tool about To
  Mat6 G = Mat6::Zero();  ///< dF/dx
  Mat6 K = Mat6::Zero();  ///< symmetric positive semidefinite
  Mat6 B = Mat6::Zero();  ///< -dF/dV
  std::uint32_t contact_count = 0, dropped = 0, status = 0;
  double max_depth_m = 0, clearance_m = 0, stiffness_n_per_m = 0, x_max_m = 0;
  std::uint64_t params_version = 0;
};

/// The mouse hand, from the low-rate side.
struct HandTargetSample {
  Pose X_WM;
  bool hold = false;
};

/// Everything that crosses between the device loop (real time, never touches DDS) and the link side.
/// One writer and one reader each.
struct Mailboxes {
  rt::LatestValue<ToolSample> tool;            ///< device loop -> link thread
  rt::Doorbell tool_ready;                     ///< rung by the device loop after `tool` was written
  rt::LatestValue<ContactReply> reply;         ///< link thread -> device loop
  rt::Doorbell reply_ready;                    ///< rung by the link thread after `reply` was written
  rt::LatestValue<HandTargetSample> hand;      ///< session thread -> device loop
  rt::LatestValue<LoopParameters> parameters;  ///< session thread -> device loop
  rt::LatestValue<LoopStatus> status;          ///< device loop -> session thread, every 16 ms
};

}  // namespace tact::coupling
