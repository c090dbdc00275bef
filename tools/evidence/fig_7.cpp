// [P] fig. 7: a box on two walls, one with far fewer contacts: normals alike, torques not.
#include <algorithm>
#include <cmath>

#include "bench/presses.hpp"
#include "evidence/experiments.hpp"
#include "evidence/play.hpp"
#include "evidence/snapshot.hpp"

namespace tact::evidence {
namespace {

using bench::number;
using bench::Report;

struct Wall {
  std::size_t contacts = 0;
  double depth_m = 0, weight = 0;
};
struct AtRest {
  Wall a, b;  ///< the broad one, the narrow one
  double tilt_deg = 0;
  std::optional<view::ViewScene> view;

  double ratio() const { return std::max(a.depth_m, b.depth_m) / std::min(a.depth_m, b.depth_m); }
};

AtRest look(const bench::LoadedScene& scene, const std::string& law_name, lockstep::Lockstep& rig) {
  AtRest rest;
  const auto& contacts = rig.pipeline().contacts();
  const double x_OT = (rig.answer().X_WO.inverse() * rig.answer().X_WT).p.x();
  for (std::size_t i = 0; i < contacts.size; ++i) {
    Wall& wall = x_OT + contacts.r[i].x() < 0 ? rest.a : rest.b;
    ++wall.contacts;
    wall.depth_m = std::max(wall.depth_m, contacts.depth_m[i]);
    wall.weight += contacts.weight[i];
  }
  const Mat3 R_WM = (rig.trace().X_WT * scene.shell->X_TM).q.toRotationMatrix();
  rest.tilt_deg = 180 / M_PI * std::acos(std::clamp(R_WM(2, 2), -1.0, 1.0));
  rest.view = view_of(scene, law_name, rig);
  return rest;
}

}  // namespace

void fig_7(const bench::Effort&, Report& report) {
  const bench::LoadedScene scene = bench::load_scene_by_name("two-walls");
  std::vector<lockstep::Experiment> setups;
  for (const std::string& name : laws()) {
    setups.push_back(experiment_of(scene, "press"));
    law(name)(setups.back());
  }
  std::vector<AtRest> rests(setups.size());
  play_all(setups, [&](std::size_t i, lockstep::Lockstep& rig) { rests[i] = look(scene, laws()[i], rig); });
  const double voxel = scene.field.voxel_m();
  std::vector<Report::Row> rows;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const AtRest& r = rests[i];
    const bool both = r.a.contacts > 0 && r.b.contacts > 0;
    rows.push_back({laws()[i], std::to_string(r.a.contacts) + " + " + std::to_string(r.b.contacts),
                    number(r.a.weight) + " : " + number(r.b.weight), number(r.a.depth_m / voxel),
                    number(r.b.depth_m / voxel), both ? number(r.ratio()) + " : 1" : "", number(r.tilt_deg)});
  }
  report.say("The walls bear the same load. k " + bench::newtons_per_metre(bench::stated_stiffness(setups[0])) +
             "N/m, F_max 10 N; depth in voxels of " + number(1e3 * voxel) + " mm, half a voxel is what [P] promises.");
  report.table({"law", "contacts", "weights", "depth, broad wall", "depth, narrow wall", "depths", "tilt, degrees"},
               rows);
  for (const std::size_t i : {3u, 4u}) {
    report.picture("Box on two walls by " + laws()[i], [&](const auto& jpeg) {
      snapshot(*rests[i].view, {-1.4, 0.05, 1.8}, jpeg);
    });
  }
  const AtRest &three = rests[2], &six = rests[3], &ours = rests[4];
  report.claim("1,014 contacts: 6-DoF scaling balances the walls; global and 3-DoF scaling go through the narrow one",
               "weights " + number(six.a.weight) + " : " + number(six.b.weight) + " by adaptive-6dof, depths " +
                   number(six.ratio()) + " : 1 (3-DoF " + number(three.ratio()) + " : 1, potential " +
                   number(ours.ratio()) + " : 1)",
               six.ratio() < 2                     ? bench::Holds::yes
               : six.ratio() < 0.5 * three.ratio() ? bench::Holds::partly
                                                   : bench::Holds::no,
               "Eq. 12 sums the likeness of normals and of torques; on flat walls all normals are alike, so the narrow "
               "wall's contacts are divided by those of the broad one whatever their torques.");
}

}  // namespace tact::evidence
