// An M16 bolt in its nut: the way along the axis a turn makes, and the play between the flanks.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/assemblies.hpp"
#include "lockstep/lockstep.hpp"
#include "math/exp_log.hpp"
#include "shapes/thread.hpp"

namespace tact::bench {
namespace {

constexpr double kPull_n = 1, kBelow_m = 0.01;  // the bolt's tip below the nut before it is turned
const shapes::Thread kThread{0.016, 0.002, 200e-6};

Assembly bake_bolt(int cells) {
  SceneSpec spec;
  spec.name = "bolt-nut";
  spec.obstacle.shape = "nut";
  spec.obstacle.shape_params = {{"diameter_m", kThread.diameter_m}, {"pitch_m", kThread.pitch_m}};
  spec.tool.shape = "bolt";
  spec.tool.shape_params = {{"diameter_m", kThread.diameter_m},
                            {"pitch_m", kThread.pitch_m},
                            {"allowance_m", kThread.allowance_m},
                            {"length_m", 0.03}};
  spec.points = 40000;
  spec.field_resolution = cells;
  return bake_assembly(std::move(spec));
}

/// The bolt free in the rig: pulled down onto its flanks, then turned by a hand that does not move along.
struct Driven {
  double turns = 0, way_m = 0;          ///< of the bolt, from when it bore to the end
  double force_n = 0, depth_m = 0;      ///< along the axis at the end; the largest while it was turned
  double off_axis_m = 0, lean_rad = 0;  ///< the largest
};

Driven drive(const Assembly& assembly, const std::string& law) {
  constexpr double kDown_m = 0.001, kBears_s = 1, kTurn_s = 4;
  constexpr int kSteps = 72;
  lockstep::Experiment setup;
  setup.session.scene = assembly.spec;
  setup.session.scene.contact.law = law;
  setup.session.scene.start_X_WM.p.z() = -kBelow_m;
  setup.bodies = assembly.bodies;
  HandMotion& hand = setup.motion_WM;
  hand = {{0, 0.2}, {setup.session.scene.start_X_WM, setup.session.scene.start_X_WM}};
  for (int i = 0; i <= kSteps; ++i) {
    hand.time_s.push_back(0.2 + kBears_s + kTurn_s * i / kSteps);
    hand.X_WM.push_back({Vec3(0, 0, -kBelow_m - kDown_m), exp_so3(Vec3(0, 0, 2 * std::numbers::pi * i / kSteps))});
  }
  lockstep::Lockstep rig(setup);
  Driven driven;
  Pose last = setup.session.scene.start_X_WM;
  double turned = 0, begin_z = 0, begin_turned = 0;
  rig.run_script(0.5, [&](const lockstep::TickTrace& trace) {
    const Pose X_WM = trace.X_WT * assembly.bodies.shell->X_TM;
    turned += log_so3(X_WM.q * last.q.conjugate()).z();
    last = X_WM;
    if (rig.status().script_time_s < 0.2 + kBears_s) {
      begin_z = X_WM.p.z();
      begin_turned = turned;
      return;
    }
    driven.depth_m = std::max(driven.depth_m, trace.max_depth_m);
    driven.lean_rad = std::max(driven.lean_rad, std::acos(std::min(1.0, (X_WM.q * Vec3::UnitZ()).z())));
    const Vec3 middle = X_WM * Vec3(0, 0, kBelow_m + 0.0065);  // of the engaged length
    driven.off_axis_m = std::max(driven.off_axis_m, std::hypot(middle.x(), middle.y()));
    driven.force_n = rig.answer().response_W.F.force.z();
  });
  driven.turns = (turned - begin_turned) / (2 * std::numbers::pi);
  driven.way_m = last.p.z() - begin_z;
  return driven;
}

}  // namespace

void bench_thread(const Effort& effort, Report& report) {
  report.say(
      "An M16 bolt in its nut, pitch 2 mm, six and a half threads engaged, 0.2 mm of diametral allowance. Turned by "
      "steps through a "
      "turn and a half; at each the way along the axis where it bears 1 N up, and 1 N down. Exact: pitch times turns, "
      "and "
      "play = allowance x tan 30 degrees.");
  const double pitch = kThread.pitch_m, play = kThread.axial_play_m();
  const int steps = effort.quick ? 12 : 96;
  double worst = 0, worst_play = 0;
  std::vector<Report::Row> rows;
  const std::vector<int> resolutions = effort.quick ? std::vector{192} : std::vector{128, 256, 512};
  for (const int cells : resolutions) {
    const Assembly assembly = bake_bolt(cells);
    const double voxel = assembly.voxel_m();
    for (const std::string& law : laws_for(effort)) {
      Probe probe(assembly, law);
      std::vector<double> up, down;
      for (int i = 0; i <= steps * 3 / 2; ++i) {
        const double turns = static_cast<double>(i) / steps;
        const Quat q = exp_so3(Vec3(0, 0, 2 * std::numbers::pi * turns));
        // Five pitches below where they were made the thread is the same again.
        const double lead = pitch * turns - kBelow_m;
        const auto force = [&](double z) { return probe.at({Vec3(0, 0, lead + z), q}).response_W.F.force.z(); };
        up.push_back(lead + falls_to(force, -kPull_n, 0, 0.4 * pitch));
        down.push_back(lead + falls_to(force, kPull_n, -0.4 * pitch, 0));
      }
      double turn_mean = 0, turn_error = 0, helix_error = 0, play_mean = 0, play_error = 0;
      const auto n = static_cast<double>(up.size());
      for (std::size_t i = 0; i < up.size(); ++i) {
        play_mean += (up[i] - down[i]) / n;
        play_error = std::max(play_error, std::fabs(up[i] - down[i] - play));
        for (const auto* z : {&up, &down}) {
          helix_error = std::max(helix_error, std::fabs((*z)[i] - z->front() - pitch * static_cast<double>(i) / steps));
          const std::size_t turned = i + static_cast<std::size_t>(steps);
          if (turned >= z->size()) continue;
          const double turn = (*z)[turned] - (*z)[i];
          turn_mean += turn / (2 * (n - steps));
          turn_error = std::max(turn_error, std::fabs(turn - pitch));
        }
      }
      worst = std::max({worst, turn_error / voxel, helix_error / voxel});
      worst_play = std::max(worst_play, play_error / voxel);
      const auto both = [&](double metres) { return number(1e6 * metres) + " = " + number(metres / voxel); };
      rows.push_back({number(1e6 * voxel), law, number(1e3 * turn_mean), both(turn_error), both(helix_error),
                      number(1e6 * play_mean), number(1e6 * play), both(play_error)});
    }
  }
  report.table({"voxel, um", "law", "way a turn, mm", "error, um = voxels", "off the helix, um = voxels", "play, um",
                "exact", "error, um = voxels"},
               rows);
  report.bar("way a turn and on the way there, largest error", worst, "voxels", false, 0.5);
  report.bar("axial play, largest error", worst_play, "voxels", false, 0.5);

  report.say(
      "The same bolt free in the rig: a hand pulls it down onto its flanks, then turns it once and stays where it is "
      "along "
      "the axis: only the thread can move the bolt.");
  rows.clear();
  double worst_driven = 0;
  const Assembly assembly = bake_bolt(effort.quick ? 192 : 256);
  for (const std::string& law : laws_for(effort)) {
    const Driven d = drive(assembly, law);
    const double error = d.way_m - pitch * d.turns;
    if (law == "potential") worst_driven = std::fabs(error) / assembly.voxel_m();
    rows.push_back({law, number(d.turns), number(1e3 * d.way_m), number(1e6 * error),
                    number(error / assembly.voxel_m()), number(d.force_n), number(d.depth_m / assembly.voxel_m()),
                    number(1e6 * d.off_axis_m), number(1e3 * d.lean_rad)});
  }
  report.table({"law", "turns", "way, mm", "off pitch x turns, um", "voxels", "axial force at the end, N",
                "depth, voxels", "off the axis, um", "lean, mrad"},
               rows);
  report.bar("potential: way of the driven bolt, error", worst_driven, "voxels", false, 0.5);
}

}  // namespace tact::bench
