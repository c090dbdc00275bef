// contact_test_server <session> <transport>: PoseServer and SessionLink on two spheres, until SIGTERM.
#include <cstdio>
#include <thread>

#include "contact/server/session_link.hpp"
#include "contact/server/sphere_scene.hpp"
#include "fault/fault.hpp"
#include "rt/realtime.hpp"
#include "service/stop_signal.hpp"

namespace {

void serve(const tact::Session& session) {
  using namespace tact;
  using namespace tact::contact;
  const StopSignal stop;
  const Participant low(wire::Channel::session, session);
  HealthReporter health(low, "contact", session.machine.transport);
  LoadedScene scene;
  scene.field = test::sphere_field();
  scene.shell = test::sphere_points(2000);
  scene.parts = {{"field", 0.1, scene.field.bytes()}};
  ContactSpec spec;
  const PipelineParams params = pipeline_params(spec, test::kVoxel, 0.2, 1);
  ContactPipeline pipeline(scene.field, scene.shell, 4096, params);
  PoseServer server(session, low, health, pipeline, {.capacity = 4096});
  SessionLink link(session, low, health, scene, pipeline, server, params);
  const rt::CpuDmaLatency awake;
  rt::lock_memory();
  link.start();
  server.start();
  while (!stop.wait_for(std::chrono::milliseconds{100}) && !server.refused()) {
  }
  link.stop();
  server.stop();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  tact::Session session;
  session.name = argv[1];
  session.machine.transport = argv[2];
  try {
    serve(session);
  } catch (const tact::SetupError& e) {
    std::printf("SetupError: %s\n", e.what());
    return 2;
  }
  std::fflush(nullptr);
  if (tact::endpoints_abandoned()) std::_Exit(0);
}
