#include "evidence/snapshot.hpp"

#include <thread>

#include "file/whole_file.hpp"
#include "view/control/studio.hpp"
#include "view/render/gauss_map.hpp"
#include "view/render/sheet.hpp"

namespace tact::evidence {

view::ViewScene view_of(const bench::LoadedScene& scene, const std::string& law, lockstep::Lockstep& rig) {
  view::ViewScene seen;
  seen.info.name = scene.spec.name;
  seen.info.law = law;
  seen.info.server_epoch = 1;
  seen.info.field_path = scene.baked.obstacle.data;
  seen.info.field_hash = scene.baked.obstacle.hash;
  seen.info.obstacle_mesh_path = scene.baked.obstacle.mesh;
  seen.info.tool_mesh_path = scene.baked.tool.mesh;
  seen.info.voxel_m = rig.voxel_m();
  seen.info.points = static_cast<std::uint32_t>(scene.shell->size());
  seen.info.X_TM = scene.shell->X_TM;
  seen.info.X_WO = scene.spec.X_WO;
  seen.info.tool_radius_m = scene.shell->bounding_radius_m;
  const contact::ContactResult& answer = rig.answer();
  seen.info.stiffness_n_per_m = answer.stiffness_n_per_m;
  seen.info.x_max_m = answer.x_max_m;
  seen.device.X_WT = answer.X_WT;
  seen.device.X_WH = rig.trace().X_WH;
  seen.device.X_WM = answer.X_WT * scene.shell->X_TM;
  seen.device.contact_count = static_cast<std::uint32_t>(answer.contact_count);
  seen.device.max_depth_m = answer.max_depth_m;
  seen.contact_set.X_WT = answer.X_WT;
  seen.contact_set.X_WO = answer.X_WO;
  seen.contact_set.F_W = answer.response_W.F;
  seen.contact_set.total_count = seen.device.contact_count;
  const contact::ContactBuffer& contacts = rig.pipeline().contacts();
  const Mat3 R_WO = answer.X_WO.R();
  for (std::size_t i = 0; i < contacts.size; ++i) {
    const double force_n = contacts.weight[i] * answer.stiffness_n_per_m * contacts.depth_m[i];
    seen.contact_set.contacts.push_back({answer.X_WT.p + R_WO * contacts.r[i], R_WO * contacts.N[i],
                                         force_n * (R_WO * contacts.force_direction(i)), contacts.depth_m[i],
                                         contacts.weight[i]});
  }
  return seen;
}

void snapshot(const view::ViewScene& scene, const Look& look, const std::filesystem::path& jpeg) {
  constexpr int kHeight = 720, kPlot = 345;
  view::Studio studio(scene.info, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  view::Camera camera;
  camera.target_W = scene.device.X_WT.p;
  camera.yaw_rad = look.yaw_rad;
  camera.pitch_rad = look.pitch_rad;
  camera.distance_m = look.radii * scene.info.tool_radius_m / std::sin(0.5 * camera.fov_y_rad);
  const std::string title =
      scene.info.name + ": law " + scene.info.law + ", " + std::to_string(scene.device.contact_count) + " contacts";
  const view::Image sheet =
      view::compose_sheet(title, studio.picture(scene, camera, kHeight * 4 / 3, kHeight),
                          view::draw_gauss_map(scene, camera, kPlot), studio.slice(scene, camera, kPlot), {});
  write_whole(jpeg, view::encode_jpeg(sheet, 85));
}

}  // namespace tact::evidence
