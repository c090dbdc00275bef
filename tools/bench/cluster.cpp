// How many contacts are left by law `cluster`, [P] fig. 12: its actuator on the landing gear has 78, of which 7 remain.
#include "bench/benchmarks.hpp"
#include "bench/scene.hpp"

namespace tact::bench {

void bench_cluster(const Effort& effort, Report& report) {
  report.say(
      "Poses along the cheat with 70 to 86 contacts, up to 2 voxels deep. Spacing: the largest gap of the shell.");
  std::vector<Report::Row> rows;
  double at_half = 0, at_two = 0;
  for (const std::string name : {"engine", "landing-gear"}) {
    if (effort.quick && name == "landing-gear") continue;
    const LoadedScene scene = load_scene_by_name(name, [&](SceneSpec& spec) {
      if (effort.quick) spec.field_resolution = 512;
    });
    const double voxel = scene.field.voxel_m();
    const auto near = poses_along(scene, "cheat", 40000, 2 * voxel, 0.05, 29);
    const auto poses = with_contacts(scene, near, 70, 86, effort.scaled(50), 2 * voxel);
    const auto all = scene.pipeline("none");
    for (const double voxels : {0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0}) {
      LoadedScene with = scene;
      with.spec.contact.cluster_voxels = voxels;
      const auto clusters = with.pipeline("cluster");
      double before = 0, after = 0;
      for (const Pose& X_WM : poses) {
        const auto query = scene.query(X_WM);
        before += static_cast<double>(all->step(query).contact_count);
        after += static_cast<double>(clusters->step(query).contact_count);
      }
      const double n = static_cast<double>(poses.size());
      if (voxels == 0.5) at_half = after / before;
      if (voxels == 2.0) at_two = after / before;
      rows.push_back(
          {name, number(scene.shell->spacing_m / voxel), number(voxels), number(before / n), number(after / n)});
    }
  }
  report.table({"scene", "spacing, voxels", "contact.cluster_voxels", "contacts", "clusters"}, rows);
  report.claim(
      "78 contacts become 7 clusters at half a voxel",
      "at half a voxel " + number(100 * at_half) + " % of the contacts are left, at two voxels " +
          number(100 * at_two) + " %",
      at_half < 0.2  ? Holds::yes
      : at_two < 0.2 ? Holds::partly
                     : Holds::no,
      "Our points lie more than half a voxel apart (the column spacing), so hardly two are that near; a factor "
      "of ten needs clusters about two voxels wide. [P] does not say how dense its points are.");
}

}  // namespace tact::bench
