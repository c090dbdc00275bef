#include "contact/server/messages.hpp"

#include <algorithm>

#include "fault/fault.hpp"
#include "link/convert.hpp"

namespace tact::contact {

ToolQuery from_wire(const wire::ToolPose& in) noexcept {
  return {tact::from_wire(in.X_WT), tact::from_wire(in.V_WT), tact::from_wire(in.X_WO), tact::from_wire(in.V_WO)};
}

void to_wire(const ContactResult& in, wire::ContactWrench& out) noexcept {
  tact::to_wire(in.X_WT, out.X_WT);
  tact::to_wire(in.X_WO, out.X_WO);
  tact::to_wire(in.response_W.F, out.F);
  tact::to_wire(in.response_W.G, out.G);
  to_wire_symmetric(in.response_W.K, out.K);
  to_wire_symmetric(in.response_W.B, out.B);
  out.contact_count = static_cast<std::uint32_t>(in.contact_count);
  out.dropped = static_cast<std::uint32_t>(in.dropped);
  out.status = in.status;
  out.max_depth_m = in.max_depth_m;
  out.clearance_m = in.clearance_m;
  out.stiffness_n_per_m = in.stiffness_n_per_m;
  out.x_max_m = in.x_max_m;
  out.params_version = in.params_version;
}

void to_wire(const ContactSnapshot& in, std::uint64_t server_epoch, const std::string& law,
             std::vector<wire::Contact>& items, wire::ContactSet& out) {
  const Mat3 R_WO = in.X_WO.R();
  for (std::size_t i = 0; i < in.size; ++i) {
    const ContactSnapshot::Item& from = in.items[i];
    wire::Contact& to = items[i];
    to.point_id = from.point_id;
    to.flags = from.flags;
    tact::to_wire(Vec3(in.X_WT.p + R_WO * from.r), to.p_W);
    tact::to_wire(Vec3(R_WO * from.N), to.N_W);
    tact::to_wire(Vec3(R_WO * from.g), to.grad_W);
    to.depth_m = from.depth_m;
    to.weight = from.weight;
    tact::to_wire(Vec3(from.weight * in.stiffness_n_per_m * from.depth_m * (R_WO * from.e)), to.force_W);
  }
  out = {};
  out.schema = wire::kSchema;
  out.server_epoch = server_epoch;
  out.pose_epoch = in.pose_epoch;
  out.pose_seq = in.pose_seq;
  out.pose_t_mono_ns = in.pose_t_mono_ns;
  tact::to_wire(in.X_WT, out.X_WT);
  tact::to_wire(in.X_WO, out.X_WO);
  tact::to_wire(in.F_W, out.F_W);
  wire::set_text(out.law, law);
  out.total_count = in.total;
  out.compute_ns = in.compute_ns;
  out.contacts._buffer = items.data();
  out.contacts._maximum = static_cast<std::uint32_t>(items.size());
  out.contacts._length = in.size;
}

void to_wire(const LoadedScene& scene, const SceneSpec& spec, const PipelineParams& params, std::uint64_t server_epoch,
             std::vector<wire::LoadedPart>& parts, wire::SceneInfo& out) {
  constexpr std::size_t kMaxParts = 32;  // the wire's bound
  parts.assign(std::min(scene.parts.size(), kMaxParts), {});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    wire::set_text(parts[i].what, scene.parts[i].what);
    parts[i].seconds = scene.parts[i].seconds;
    parts[i].bytes = scene.parts[i].bytes;
  }
  out = {};
  out.schema = wire::kSchema;
  out.server_epoch = server_epoch;
  wire::set_text(out.scene, spec.name);
  wire::set_text(out.field_path, scene.field_path.string());
  wire::set_text(out.obstacle_mesh_path, scene.obstacle_mesh_path.string());
  wire::set_text(out.tool_mesh_path, scene.tool_mesh_path.string());
  out.field_hash = scene.field.content_hash();
  out.shell_hash = scene.shell->content_hash;
  out.voxel_m = scene.field.voxel_m();
  out.points = static_cast<std::uint32_t>(scene.shell->size());
  tact::to_wire(scene.shell->X_TM, out.X_TM);
  tact::to_wire(spec.X_WO, out.X_WO);
  tact::to_wire(scene.shell->inertia_shape_m2, out.inertia_shape_m2);
  out.gyration_radius_m = scene.shell->gyration_radius_m;
  out.tool_radius_m = scene.shell->bounding_radius_m;
  out.stiffness_n_per_m = params.stiffness_n_per_m;
  out.x_max_m = params.x_max_m;
  wire::set_text(out.law, params.law);
  out.params_version = params.version;
  wire::set_text(out.notes, scene.notes);
  out.loaded._buffer = parts.data();
  out.loaded._maximum = out.loaded._length = static_cast<std::uint32_t>(parts.size());
}

std::uint32_t faults_of(std::uint32_t status) noexcept {
  static_assert(bit(Status::overflow) == tact_haptic_CONTACT_OVERFLOW &&
                bit(Status::sign_doubtful) == tact_haptic_CONTACT_SIGN_DOUBTFUL &&
                bit(Status::past_mid_surface) == tact_haptic_CONTACT_PAST_MID_SURFACE &&
                bit(Status::beyond_band) == tact_haptic_CONTACT_BEYOND_BAND &&
                bit(Status::capped) == tact_haptic_CONTACT_CAPPED &&
                bit(Status::pose_invalid) == tact_haptic_CONTACT_POSE_INVALID);
  std::uint32_t faults = 0;
  if (status & bit(Status::overflow)) faults |= tact::bit(Fault::contacts_full);
  if (status & bit(Status::sign_doubtful)) faults |= tact::bit(Fault::sign_doubtful);
  if (status & bit(Status::past_mid_surface)) faults |= tact::bit(Fault::past_mid_surface);
  if (status & bit(Status::beyond_band)) faults |= tact::bit(Fault::beyond_band);
  if (status & bit(Status::pose_invalid)) faults |= tact::bit(Fault::not_finite);
  return faults;
}

}  // namespace tact::contact
