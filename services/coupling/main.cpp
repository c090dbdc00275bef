// services/coupling/main.cpp: the hand in, force out, a thousand times a second.
#include <chrono>
#include <memory>
#include <thread>

#include "coupling/device/open_device.hpp"
#include "coupling/link/contact_link.hpp"
#include "coupling/link/session_link.hpp"
#include "coupling/loop/coupling_loop.hpp"
#include "coupling/loop/flight_recorder.hpp"
#include "coupling/loop/recorded_hand.hpp"
#include "coupling/loop/session_config.hpp"
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
constexpr std::uint32_t kFlightFaults = bit(Fault::wrench_stale) | bit(Fault::not_finite) | bit(Fault::device_lost) |
                                        bit(Fault::device_alarm) | bit(Fault::device_data);
constexpr auto kRest = 100ms;  // time for the gate to bring the largest force to zero, several times over

RecordingInfo recording_info(const Session& session, const SceneModel& scene, const LoopConfig& config,
                             HapticDevice& device) {
  RecordingInfo info;
  info.session = session.name;
  info.scene = session.scene.name;
  info.session_id = session.id;
  info.field_hash = scene.identity.field_hash;
  info.shell_hash = scene.identity.shell_hash;
  info.config = config;
  info.device = device.capabilities();
  info.first_reading = device.read();
  info.first_set_point = device.last_set_point();
  return info;
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
  const bool playback = wanted.name == "playback";
  if (options.check_only) {
    wanted.check_only = true;
    if (playback) use_recording({session.machine.recording, wanted.mode, wanted.rate_hz}, wanted);
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
  LoopConfig config = loop_config(session, *scene);
  if (playback) {
    config.X_WT_start = use_recording({session.machine.recording, wanted.mode, wanted.rate_hz,
                                       scene->identity.field_hash, scene->identity.shell_hash},
                                      wanted);
  }
  take_bodies(config, wanted);
  const std::unique_ptr<HapticDevice> device = open_device(wanted);

  ToolSample probe;
  probe.X_WT = config.X_WT_start;
  probe.X_WO = config.X_WO;
  ContactLink link(session, low, health, *mail, {.probe = probe, .scene = scene->identity});
  FlightRecorder recorder(recording_info(session, *scene, config, *device), session.run_dir,
                          free_recording_name(session.run.record, session.id));
  CouplingLoop loop(config, *device, *mail, &recorder.queue());
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

  // A full disk costs the record, not the hand; a disk that hangs holds this thread only.
  const auto keep = [&recorder](bool last) {
    try {
      tell(last ? recorder.finish(kFlightFaults) : recorder.drain(kFlightFaults));
    } catch (const SetupError& error) {
      log_error(error.what());
    }
  };
  std::jthread keeper([&keep](const std::stop_token& ended) {
    for (; !ended.stop_requested(); std::this_thread::sleep_for(100ms)) keep(false);
  });

  // This thread only watches.
  std::optional<std::string> refused;
  while (!stop.wait_for(100ms) && !(refused = link.status().refused)) {
    warn(device->take_news());
  }

  // Stop in reverse: the hand is let go before the loop ends, the loop before the links.
  loop.rest();
  std::this_thread::sleep_for(kRest);
  watchdog.reset();
  thread.stop();
  device->power_off();
  keeper.request_stop();
  keeper.join();
  keep(true);
  if (recorder.dropped() > 0) log_warn("recorder: ", recorder.dropped(), " ticks were dropped: the disk was too slow");
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
