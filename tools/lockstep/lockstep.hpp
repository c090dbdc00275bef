#pragma once
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "contact/pipeline/contact_pipeline.hpp"
#include "coupling/device/simulated_device.hpp"
#include "coupling/loop/session_config.hpp"
#include "lockstep/bodies.hpp"

namespace tact::lockstep {

/// One experiment: everything `tact run` would say, and what only a rig can.
struct Experiment {
  Session session;  ///< scene.contact, scene.coupling, machine.mode and .rate_hz, run.script; its bodies are not baked
  Bodies bodies;
  HandMotion motion_WM;                                 ///< in place of the session's script, unless empty
  std::optional<coupling::SimulatedHand::Params> hand;  ///< in place of the product's
  int delay_ticks = 0;                                  ///< beyond the one tick that every reply takes
  std::string replies;  ///< "110": of every three replies the third is lost; empty: none is
  /// The coupling's cap is x_max times k scaled by the contacts' mean weight: the idea that [P] section 3.3 rejects.
  bool cap_follows_stiffness = false;
};

/// One executed tick. Poses, twists and wrenches in W; wrenches about To.
struct TickTrace {
  double time_s = 0;
  Pose X_WH, X_WT;
  Twist V_WT;
  Wrench F_contact_W, F_coupling_W;  ///< on the tool, used in this tick
  std::uint32_t contact_count = 0;   ///< of the pose this tick published, as the next four
  double max_depth_m = 0, net_stiffness_n_per_m = 0;
  double port_energy_j = 0;  ///< since the beginning
  std::uint32_t faults = 0;  ///< tact::Fault bits
  bool script_done = false, live = false;
};

/// Device, coupling loop and contact server in one thread on a clock that only counts ticks:
///
///   simulated device <-> CouplingLoop --mailbox--> ContactPipeline --(delay, loss)--> mailbox --> CouplingLoop
///
/// The parts are the product's own; what is left out is DDS, threads and the wall clock. So two runs of one setup agree
/// to the last bit, whatever else the machine does. Tens of microseconds a tick.
class Lockstep {
 public:
  /// Throws SetupError: the session's values, the script, a device other than the simulated one.
  explicit Lockstep(const Experiment& setup);

  const TickTrace& tick();
  void run(double seconds);
  /// Until the script's end and `hold_s` more. `each` sees every tick. False: the device never became live.
  bool run_script(double hold_s = 1, const std::function<void(const TickTrace&)>& each = {});

  const TickTrace& trace() const { return trace_; }
  const coupling::LoopStatus& status() const { return status_; }
  /// The books of the session report. Times of computing and of the wall clock are zero: there are none here.
  coupling::LoopStats stats() const;

  contact::ContactPipeline& pipeline() { return pipeline_; }
  const contact::ContactResult& answer() const { return *answer_; }  ///< to the newest pose. @pre a tick was made
  const coupling::LoopConfig& config() const { return config_; }
  const coupling::SimulatedDevice& device() const { return dynamic_cast<const coupling::SimulatedDevice&>(*device_); }
  const Experiment& setup() const { return setup_; }
  double voxel_m() const { return config_.voxel_m; }

 private:
  coupling::ContactReply reply_to(const coupling::ToolSample& sample);
  void serve();

  const Experiment setup_;
  const std::int64_t period_ns_;
  contact::PipelineParams params_;
  contact::ContactPipeline pipeline_;
  coupling::LoopConfig config_;
  std::unique_ptr<coupling::Mailboxes> mail_;
  std::unique_ptr<coupling::HapticDevice> device_;
  std::unique_ptr<coupling::CouplingLoop> loop_;
  const contact::ContactResult* answer_ = nullptr;
  std::deque<coupling::ContactReply> under_way_;
  coupling::LoopStatus status_;
  TickTrace trace_;
  std::uint64_t ticks_ = 0;
  std::int64_t now_ns_ = 0;
};

/// k x_max of `force_max_n` at this k: x_max follows.
void set_stiffness(SceneSpec& scene, double stiffness_n_per_m, double force_max_n, double voxel_m);

}  // namespace tact::lockstep
