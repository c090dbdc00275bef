// services/coupling/main.cpp: the hand in, force out, a thousand times a second.
#include <chrono>
#include <memory>
#include <thread>

#include "coupling/device/open_device.hpp"
#include "coupling/link/contact_link.hpp"
#include "coupling/link/session_link.hpp"
#include "coupling/loop/coupling_loop.hpp"
#include "coupling/safety/watchdog.hpp"
#include "fault/fault.hpp"
#include "log/log.hpp"
#include "rt/realtime.hpp"
#include "service/service_main.hpp"
#include "service/stop_signal.hpp"

namespace tact::coupling {
namespace {

using namespace std::chrono_literals;

constexpr int kWatchdogPriority = 90, kLoopPriority = 80;
constexpr double kFlightHistory_s = 2;
constexpr std::uint32_t kFlightFaults =
    bit(Fault::wrench_stale) | bit(Fault::not_finite) | bit(Fault::device_lost) | bit(Fault::device_alarm);
constexpr auto kRest = 100ms;  // time for the gate to bring the largest force to zero, several times over

DeviceOptions device_options(const Session& session) {
  DeviceOptions options;
  options.name = session.machine.device;
  options.mode = session.machine.mode;
  options.rate_hz = session.machine.rate_hz;
  options.virtual_mass_kg = session.scene.coupling.mass_kg;
  if (const auto hand = scripted_hand(session)) {
    options.hand_force_max_n = hand->hand_force_max_n;
    options.hand_motion = load_hand_motion(hand->hand_csv);
  }
  return options;
}

LoopConfig loop_config(const Session& session, const SceneModel& scene) {
  const CouplingSpec& coupling = session.scene.coupling;
  LoopConfig config;
  config.rate_hz = session.machine.rate_hz;
  config.tool.mass_kg = coupling.mass_kg;
  config.tool.inertia_shape_m2 = scene.inertia_shape_m2;
  config.tool.rotation_locked = coupling.rotation_locked;
  config.parameters = loop_parameters(coupling);
  const MachineSpec& machine = session.machine;
  config.mapping = {.X_WB = {machine.p_WB.value_or(Vec3::Zero()), machine.q_WB},
                    .scale = machine.workspace_scale,
                    .placed = machine.p_WB.has_value()};
  config.gate.force_n = session.machine.force_limit_n;
  config.gate.torque_nm = session.machine.torque_limit_nm;
  config.gate.force_slope_n_per_s = session.machine.force_slope_n_per_s;
  config.gate.torque_slope_nm_per_s = session.machine.torque_slope_nm_per_s;
  config.X_WT_start = session.scene.start_X_WM * scene.X_TM.inverse();
  config.X_WO = scene.X_WO;
  config.X_TM = scene.X_TM;
  config.gyration_radius_m = scene.gyration_radius_m;
  config.tool_radius_m = scene.tool_radius_m;
  config.voxel_m = scene.voxel_m;
  config.force_max_n = scene.stiffness_n_per_m * scene.x_max_m;
  return config;
}

void tell(const std::filesystem::path& record) {
  if (!record.empty()) log_warn("a fault was recorded: ", record.string());
}

void warn(const std::string& missing) {
  if (!missing.empty()) log_warn(missing);
}
void warn(const std::vector<std::string>& missing) {
  for (const std::string& one : missing) log_warn(one);
}

int serve(const ServiceOptions& options) {
  // Configure: may block, allocate and throw SetupError.
  const Session session = load_session(options.session_file);
  DeviceOptions wanted = device_options(session);
  if (options.check_only) {
    open_device(wanted);
    return kExitOk;
  }
  const StopSignal stop;
  const Participant low(wire::Channel::session, session);
  HealthReporter health(low, "coupling", session.machine.transport);
  const auto mail = std::make_unique<Mailboxes>();
  SessionLink session_link(session, low, health, *mail);

  health.phase(wire::kConnecting, "waiting for the contact server to load the scene");
  std::optional<SceneModel> scene;
  while (!(scene = session_link.wait_scene(100ms))) {
    if (stop.requested()) return kExitOk;
  }
  const LoopConfig config = loop_config(session, *scene);
  // A simulated hand does with the device what brings the tool where its script says.
  const WorkspaceMapping mapping(config.mapping, config.X_WT_start);
  wanted.X_WH_start = mapping.to_device(config.X_WT_start);
  for (Pose& X : wanted.hand_motion.X_WM) X = mapping.to_device(X * config.X_TM.inverse());
  wanted.virtual_inertia_shape_m2 = config.tool.inertia_shape_m2;
  const std::unique_ptr<HapticDevice> device = open_device(wanted);

  ToolSample probe;
  probe.X_WT = config.X_WT_start;
  probe.X_WO = config.X_WO;
  ContactLink link(session, low, health, *mail, {.probe = probe, .scene = scene->identity});
  FlightRecorder recorder(config.rate_hz, kFlightHistory_s, session.run_dir);
  CouplingLoop loop(config, *device, *mail, &recorder);
  const rt::CpuDmaLatency awake;
  warn(awake.missing());

  // Active: the links first, the device last.
  session_link.start(config.parameters);
  link.start();
  warn(rt::lock_memory());
  rt::PeriodicThread thread(
      {.name = "device-loop", .priority = kLoopPriority, .cpu = session.machine.cpu_coupling},
      [&] { return device->wait_tick(); }, [&](const rt::Tick& tick) noexcept { return loop.step(tick); });
  warn(thread.missing());
  auto watchdog = std::make_unique<Watchdog>(
      rt::ThreadOptions{.name = "watchdog", .priority = kWatchdogPriority}, loop.progress(), [&device] {
        device->power_off();
        leave_process("tact-coupling", "watchdog: the device loop stalled; power is off");
      });
  warn(watchdog->missing());
  log_info("device loop: ", session.machine.device, ", ", session.machine.mode, ", ", config.rate_hz, " Hz");

  // A full disk costs the flight record, not the hand.
  const auto record_flight = [](const auto& take) {
    try {
      tell(take());
    } catch (const SetupError& error) {
      log_error(error.what());
    }
  };

  // This thread only watches.
  std::optional<std::string> refused;
  while (!stop.wait_for(100ms) && !(refused = link.status().refused)) {
    record_flight([&] { return recorder.drain(kFlightFaults); });
  }

  // Stop in reverse: the hand is let go before the loop ends, the loop before the links.
  loop.rest();
  std::this_thread::sleep_for(kRest);
  watchdog.reset();
  thread.stop();
  device->power_off();
  record_flight([&] { return recorder.finish(kFlightFaults); });
  const LoopStats& stats = loop.finish();
  log_info(stats.ticks, " ticks, ", stats.missed_ticks, " missed, ", stats.page_faults, " page faults, ",
           stats.allocations, " allocations in ticks; faults: ", fault_names(stats.faults_ever));
  session_link.stop();
  link.stop();
  if (refused) throw SetupError(*refused);
  return kExitOk;
}

}  // namespace
}  // namespace tact::coupling

int main(int argc, char** argv) { return tact::service_main("tact-coupling", argc, argv, tact::coupling::serve); }
