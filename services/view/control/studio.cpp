#include "view/control/studio.hpp"

#include <chrono>

#include "fault/fault.hpp"
#include "log/log.hpp"
#include "view/render/field_slice.hpp"
#include "view/render/gauss_map.hpp"
#include "view/render/sheet.hpp"
#include "view/render/strips.hpp"

namespace tact::view {
namespace {

// The ball about the bounding boxes is larger than the bodies.
constexpr double kFrameShare = 0.85;

Placement placement(const ViewScene& scene, std::span<const Arrow> arrows = {}) {
  return {scene.info.X_WO, scene.device.X_WM, arrows};
}

}  // namespace

Studio::Studio(const SceneInfo& info, int threads) : info_(info) {
  const auto start = std::chrono::steady_clock::now();
  tool_M_ = load_mesh(info.tool_mesh_path);
  tracer_ = std::make_unique<RayTracer>(load_mesh(info.obstacle_mesh_path), tool_M_, threads);
  try {
    field_ = DistanceField::open(info.field_path, info.field_hash);
  } catch (const SetupError& error) {
    log_warn("no slice of the field: ", error.what());
  }
  ViewScene alone;
  alone.info = info;
  Vec3 centre_W;
  tracer_->bounds(placement(alone), centre_W, scene_radius_m_);
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool Studio::shows(const SceneInfo& info) const {
  return info.server_epoch == info_.server_epoch && info.obstacle_mesh_path == info_.obstacle_mesh_path &&
         info.tool_mesh_path == info_.tool_mesh_path && info.field_hash == info_.field_hash;
}

Camera Studio::home(const ViewScene& scene, double& radius_m) const {
  Vec3 centre_W;
  tracer_->bounds(placement(scene), centre_W, radius_m);
  return frame_ball(centre_W, kFrameShare * radius_m);
}

Image Studio::picture(const ViewScene& scene, const Camera& camera, int width, int height) {
  const auto arrows = contact_arrows(scene, 0.16 * scene_radius_m_);
  Image image(width, height);
  tracer_->trace(camera, placement(scene, arrows), image);
  return image;
}

Image Studio::slice(const ViewScene& scene, const Camera& camera, int size) {
  if (!field_ || !(scene.info.voxel_m > 0)) return {};
  const Mat3 R_OE = (scene.info.X_WO.inverse().q * camera.X_WE().q).toRotationMatrix();
  const SlicePlane plane = chooser_.choose(scene, R_OE.col(2), R_OE.col(1));
  const auto segments = cut(tool_M_, scene.info.X_WO.inverse() * scene.device.X_WM, plane);
  return draw_field_slice([this](const Vec3& p_O) { return field_->sample(p_O).value_m; }, plane, segments, scene,
                          size);
}

Image Studio::sheet(const ViewScene& scene, const Camera& camera) {
  constexpr int kPicture = 720, kPlot = 345, kCaption = 30;
  const std::string title = scene.info.name + ": law " + scene.info.law + ", k " +
                            std::to_string(std::lround(scene.info.stiffness_n_per_m)) + " N/m, " +
                            std::to_string(scene.device.contact_count) + " contacts";
  const int width = kPicture * 4 / 3;
  return compose_sheet(title, picture(scene, camera, width, kPicture), draw_gauss_map(scene, camera, kPlot),
                       slice(scene, camera, kPlot), draw_strips(scene, width + kPlot + 20, 400));
  static_assert(2 * kPlot + kCaption == kPicture);
}

}  // namespace tact::view
