// half_space_server <session file>: a contact server in closed form, in a process of its own: a flat foot against the
// half-space z < 0 (loop/half_space.hpp). Publishes SceneInfo, connects, answers until SIGTERM.
#include "coupling/link/messages.hpp"
#include "fault/fault.hpp"
#include "link/convert.hpp"
#include "link/haptic_connector.hpp"
#include "loop/half_space.hpp"
#include "service/stop_signal.hpp"

namespace tact::coupling {
namespace {

ToolSample sample_of(const wire::ToolPose& pose) {
  ToolSample sample;
  sample.seq = pose.seq;
  sample.t_mono_ns = pose.t_mono_ns;
  sample.X_WT = tact::from_wire(pose.X_WT);
  sample.X_WO = tact::from_wire(pose.X_WO);
  sample.V_WT = tact::from_wire(pose.V_WT);
  return sample;
}

wire::ContactWrench wrench_of(const wire::ToolPose& pose, const ContactReply& reply) {
  wire::ContactWrench out{};
  out.session_id = pose.session_id;
  out.server_epoch = process_epoch();
  out.pose_epoch = pose.epoch;
  out.pose_seq = pose.seq;
  out.pose_t_mono_ns = pose.t_mono_ns;
  out.X_WT = pose.X_WT;
  out.X_WO = pose.X_WO;
  tact::to_wire(reply.F_W, out.F);
  tact::to_wire(reply.G, out.G);
  to_wire_symmetric(reply.K, out.K);
  to_wire_symmetric(reply.B, out.B);
  out.contact_count = reply.contact_count;
  out.max_depth_m = reply.max_depth_m;
  out.clearance_m = reply.clearance_m;
  out.stiffness_n_per_m = reply.stiffness_n_per_m;
  out.x_max_m = reply.x_max_m;
  out.compute_ns = 1000;
  return out;
}

void serve(const Session& session) {
  const StopSignal stop;
  HalfSpace wall;
  wall.k = 5000;  // 20000 N/m, saturates at 10 N
  const Participant low(wire::Channel::session, session), haptic(wire::Channel::haptic, session);
  HealthReporter health(low, "contact", session.machine.transport);
  HealthMonitor monitor(low);
  Publisher<wire::SceneInfo> scene(low);
  wire::Message<wire::SceneInfo> info;
  info.schema = wire::kSchema;
  info.server_epoch = process_epoch();
  info.voxel_m = 1e-3;
  tact::to_wire(Pose{}, info.X_TM);
  tact::to_wire(Pose{}, info.X_WO);
  tact::to_wire(Mat3(Vec3(4e-4, 5e-4, 8e-4).asDiagonal()), info.inertia_shape_m2);
  info.gyration_radius_m = 0.025;
  info.tool_radius_m = 0.03;
  info.stiffness_n_per_m = 4 * wall.k;
  info.x_max_m = wall.x_max;
  scene.write(info);
  HapticConnector<ContactEnds> connector(haptic, session.machine.transport, health, monitor);
  health.phase(wire::kConnecting);
  while (!stop.requested()) {
    const auto ends = connector.poll();
    if (!ends) continue;
    while (connector.peer_alive() && !stop.requested()) {
      wire::ToolPose pose;
      ends->in.wait(20'000'000);
      if (ends->in.take_newest(pose)) ends->out.write(wrench_of(pose, wall.answer(sample_of(pose))));
    }
    connector.drop();
  }
}

}  // namespace
}  // namespace tact::coupling

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  tact::coupling::serve(tact::load_session(argv[1]));
  if (tact::endpoints_abandoned()) std::_Exit(0);
}
