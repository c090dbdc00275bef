// services/contact/main.cpp: pose in, wrench out.
#include <chrono>

#include "contact/server/load.hpp"
#include "contact/server/pose_server.hpp"
#include "contact/server/session_link.hpp"
#include "fault/fault.hpp"
#include "log/log.hpp"
#include "rt/realtime.hpp"
#include "service/service_main.hpp"
#include "service/stop_signal.hpp"

namespace tact::contact {
namespace {

using namespace std::chrono_literals;

/// Loads while Health tells how far it is. Throws SetupError when the session stops meanwhile.
LoadedScene load(const Session& session, HealthReporter& health, const StopSignal& stop) {
  health.phase(wire::kLoading, "looking for baked files");
  auto told = std::chrono::steady_clock::now();
  return load_bodies(session, [&](const std::string& what, double fraction) {
    if (std::chrono::steady_clock::now() - told > 50ms) {
      health.phase(wire::kLoading, what, fraction);
      told = std::chrono::steady_clock::now();
    }
    return !stop.requested();
  });
}

void warn(const std::string& missing) {
  if (!missing.empty()) log_warn(missing);
}

int serve(const ServiceOptions& options) {
  // Configure: may block, allocate and throw SetupError.
  const Session session = load_session(options.session_file);
  const ContactSpec& spec = session.scene.contact;
  const auto capacity = static_cast<std::size_t>(spec.capacity);
  const double mass_kg = session.scene.coupling.mass_kg;
  if (options.check_only) {
    const LoadedScene scene = load_bodies(session, [](const std::string&, double) { return true; });
    ContactPipeline(scene.field, scene.shell, capacity, pipeline_params(spec, scene.field.voxel_m(), mass_kg, 1));
    return kExitOk;
  }
  const StopSignal stop;
  const Participant low(wire::Channel::session, session);
  HealthReporter health(low, "contact", session.machine.transport);

  const LoadedScene scene = load(session, health, stop);
  const PipelineParams params = pipeline_params(spec, scene.field.voxel_m(), mass_kg, 1);
  ContactPipeline pipeline(scene.field, scene.shell, capacity, params);
  PoseServer server(session, low, health, pipeline,
                    {.cpu = session.machine.cpu_contact,
                     .capacity = capacity,
                     .field_hash = scene.field.content_hash(),
                     .shell_hash = scene.shell->content_hash});
  SessionLink link(session, low, health, scene, pipeline, server, params);
  const rt::CpuDmaLatency awake;
  warn(awake.missing());
  warn(rt::lock_memory());

  // Active.
  link.start();
  server.start();
  while (!stop.wait_for(100ms)) {
    if (const auto refused = server.refused()) throw SetupError(*refused);
  }

  // Stop in reverse.
  server.stop();
  link.stop();
  return kExitOk;
}

}  // namespace
}  // namespace tact::contact

int main(int argc, char** argv) { return tact::service_main("tact-contact", argc, argv, tact::contact::serve); }
