#include "bench/scene.hpp"

#include <cstdio>

#include "contact/bake/baked_scene.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {

std::unique_ptr<contact::ContactPipeline> LoadedScene::pipeline(const std::string& law) const {
  ContactSpec contact = spec.contact;
  if (!law.empty()) contact.law = law;
  return std::make_unique<contact::ContactPipeline>(
      field, shell, static_cast<std::size_t>(contact.capacity),
      contact::pipeline_params(contact, field.voxel_m(), spec.coupling.mass_kg, 1));
}

contact::ToolQuery LoadedScene::query(const Pose& X_WM) const {
  contact::ToolQuery query;
  query.X_WT = X_WM * shell->X_TM.inverse();
  query.X_WO = spec.X_WO;
  return query;
}

Pose LoadedScene::X_OM(const Pose& X_WM) const { return spec.X_WO.inverse() * X_WM; }

LoadedScene load_scene_by_name(const std::string& name, const std::function<void(SceneSpec&)>& change) {
  LoadedScene scene;
  scene.spec = load_scene(find_scene(name));
  if (change) change(scene.spec);
  bool told = false;
  scene.baked = contact::ensure_baked(scene.spec, cache_dir(MachineSpec{}), [&](const contact::BakeStep&) {
    if (!told) std::fprintf(stderr, "tact-bench: baking %s (kept in the cache)\n", name.c_str());
    return told = true;
  });
  static_cast<lockstep::Bodies&>(scene) = lockstep::open_bodies(scene.baked);
  scene.obstacle_O = load_mesh(scene.baked.obstacle.mesh);
  scene.tool_M = load_mesh(scene.baked.tool.mesh);
  return scene;
}

std::vector<Pose> poses_along(const LoadedScene& scene, const std::string& script, std::size_t count, double shift_m,
                              double turn_rad, unsigned seed) {
  const HandMotion motion = load_hand_motion(scene.spec.scripts.at(script).hand_csv);
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto ball = [&] {
    for (;;) {
      const Vec3 v(any(rng), any(rng), any(rng));
      if (v.squaredNorm() <= 1) return v;
    }
  };
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    Pose X = motion.X_WM[rng() % motion.X_WM.size()];
    // Turned about the middle of the tool, so that turn and shift are independent.
    const Vec3 middle = X * (scene.shell->X_TM.inverse().p);
    const Quat turn = exp_so3(turn_rad * ball());
    X.p = middle + turn * (X.p - middle) + shift_m * ball();
    X.q = (turn * X.q).normalized();
    poses.push_back(X);
  }
  return poses;
}

std::vector<Pose> poses_tick_by_tick(const LoadedScene& scene, const std::string& script) {
  const HandMotion motion = load_hand_motion(scene.spec.scripts.at(script).hand_csv);
  std::vector<Pose> poses;
  std::size_t k = 0;  // frame before the tick
  for (double t = motion.time_s.front(); t <= motion.time_s.back(); t += 1e-3) {
    while (k + 2 < motion.time_s.size() && motion.time_s[k + 1] <= t) ++k;
    const double share = (t - motion.time_s[k]) / (motion.time_s[k + 1] - motion.time_s[k]);
    const Pose &a = motion.X_WM[k], &b = motion.X_WM[k + 1];
    poses.push_back({a.p + share * (b.p - a.p), a.q.slerp(share, b.q)});
  }
  return poses;
}

std::vector<Pose> with_contacts(const LoadedScene& scene, const std::vector<Pose>& poses, std::size_t fewest,
                                std::size_t most, std::size_t count, double deepest_m) {
  const auto pipeline = scene.pipeline("none");
  std::vector<Pose> found;
  for (const Pose& X_WM : poses) {
    if (found.size() == count) break;
    const auto& result = pipeline->step(scene.query(X_WM));
    const std::size_t n = result.contact_count;
    if (n >= fewest && n <= most && result.max_depth_m <= deepest_m) found.push_back(X_WM);
  }
  if (found.empty()) throw SetupError("scene " + scene.spec.name + ": no pose of the benchmark is in such contact");
  return found;
}

}  // namespace tact::bench
