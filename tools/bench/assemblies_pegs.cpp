// Round pegs in round holes of exact clearances: how far they can be moved and tilted, against the closed forms.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/assemblies.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

constexpr double kHole_m = 0.009, kEngaged_m = 0.008, kTouch_n = 0.5;

struct Fit {
  double diameter_m, clearance_m;  ///< of the hole; hole minus peg
  int cells;

  double peg_m() const { return diameter_m - clearance_m; }
  /// Largest tilt: the peg touches the rim of the mouth on one side, and with its own rim, kEngaged_m below, the wall
  /// on the other: D cos t - h sin t = d.
  double tilt_rad() const {
    return std::acos(peg_m() / std::hypot(diameter_m, kEngaged_m)) - std::atan2(kEngaged_m, diameter_m);
  }
};

Assembly bake_fit(const Fit& fit) {
  SceneSpec spec;
  spec.name = "peg-" + std::to_string(std::lround(1e3 * fit.diameter_m)) + "mm";
  constexpr double kSides = 256;  // so a flat and a corner are less than 1 um apart
  spec.obstacle.shape = "socket";
  spec.obstacle.shape_params = {{"hole_width_m", fit.diameter_m},
                                {"block_width_m", fit.diameter_m + 0.008},
                                {"depth_m", kHole_m},
                                {"floor_m", 0.004},
                                {"sides_count", kSides}};
  spec.tool.shape = "peg";
  spec.tool.shape_params = {{"width_m", fit.peg_m()}, {"height_m", 0.015}, {"sides_count", kSides}};
  spec.field_resolution = fit.cells;
  return bake_assembly(std::move(spec));
}

struct Measured {
  double play_m = 0, tilt_rad = 0;              ///< means over the directions
  double play_error_m = 0, tilt_error_rad = 0;  ///< the largest
};

/// `e`: the way across. A tilt leans the peg's foot that way.
class PegProbe {
 public:
  PegProbe(const Assembly& assembly, const std::string& law, const Fit& fit)
      : probe_(assembly, law), fit_(fit), reach_m_(fit.clearance_m + 3 * assembly.voxel_m()) {}

  double play(const Vec3& e) {
    const auto across = [&](double s) { return pose(e, s, 0); };
    const auto push = [&](double s) { return probe_.effort(across, s, 1e-6); };
    return falls_to(push, -kTouch_n, 0, reach_m_) - falls_to(push, kTouch_n, -reach_m_, 0);
  }

  /// Where the walls turn back with kTouch_n at both ends of kEngaged_m, the peg free to move across.
  double tilt(const Vec3& e) {
    const auto torque = [&](double t) {
      const double s =
          falls_to([&](double x) { return probe_.effort([&](double y) { return pose(e, y, t); }, x, 1e-6); }, 0,
                   -reach_m_, reach_m_ + kEngaged_m * t);
      return probe_.effort([&](double u) { return pose(e, s, u); }, t, 1e-6);
    };
    return falls_to(torque, -kTouch_n * kEngaged_m, 0, fit_.tilt_rad() + 3 * reach_m_ / kEngaged_m);
  }

 private:
  /// The rim of the foot that meets the wall stays kEngaged_m below the mouth; upright, the axis is s beside the
  /// hole's.
  Pose pose(const Vec3& e, double s, double tilt_rad) const {
    const Quat q = exp_so3(tilt_rad * e.cross(Vec3::UnitZ()));
    const double r = fit_.peg_m() / 2;
    const Vec3 rim = (s + r) * e + (kHole_m - kEngaged_m) * Vec3::UnitZ();
    return {rim - q * (r * e), q};
  }

  Probe probe_;
  const Fit fit_;
  double reach_m_;
};

Measured measure(const Assembly& assembly, const std::string& law, const Fit& fit, int directions) {
  PegProbe probe(assembly, law, fit);
  Measured m;
  for (int i = 0; i < directions; ++i) {
    const double a = 0.1 + 2 * std::numbers::pi * i / directions;
    const Vec3 e(std::cos(a), std::sin(a), 0);
    const double play = probe.play(e), tilt = probe.tilt(e);
    m.play_m += play / directions;
    m.tilt_rad += tilt / directions;
    m.play_error_m = std::max(m.play_error_m, std::fabs(play - fit.clearance_m));
    m.tilt_error_rad = std::max(m.tilt_error_rad, std::fabs(tilt - fit.tilt_rad()));
  }
  return m;
}

}  // namespace

void bench_pegs(const Effort& effort, Report& report) {
  report.say(
      "Round pegs in round holes 9 mm deep; clearance is diametral (hole minus peg), the engineer's way. Play: from "
      "wall "
      "to wall, upright, pressed with 0.5 N each way. Tilt: the largest, the touching rim 8 mm below the mouth, "
      "pressed "
      "with 0.5 N at both ends; closed form D cos t - h sin t = d. Mean over directions round the axis, and the "
      "largest "
      "error of any. k = 10 N over half a voxel.");
  const int directions = effort.quick ? 3 : 8;
  double worst_play = 0, worst_tilt = 0, worst_share = 0, width = 0;
  std::vector<Report::Row> rows;
  // Clearances of 2.6 voxels (quick: 1.3), then voxels wider than the clearance.
  std::vector<Fit> fits;
  for (const auto& [diameter_mm, clearance_um, cells] :
       {std::tuple{8, 52.5, 768}, std::tuple{12, 103.0, 512}, std::tuple{16, 253.0, 256}}) {
    fits.push_back({1e-3 * diameter_mm, 1e-6 * clearance_um, effort.quick ? cells / 2 : cells});
  }
  fits.push_back({0.008, 52.5e-6, 96});
  if (!effort.quick) {
    fits.push_back({0.008, 52.5e-6, 32});
    fits.push_back({0.012, 103e-6, 96});
    fits.push_back({0.016, 253e-6, 64});
  }
  std::size_t warnings = 0;
  for (const Fit& fit : fits) {
    const Assembly assembly = bake_fit(fit);
    const double voxel = assembly.voxel_m();
    warnings += assembly.baked.obstacle.warnings.size() + assembly.baked.tool.warnings.size();
    for (const std::string& law : laws_for(effort)) {
      const Measured m = measure(assembly, law, fit, directions);
      if (voxel < fit.clearance_m) {
        worst_play = std::max(worst_play, m.play_error_m / voxel);
        worst_tilt = std::max(worst_tilt, m.tilt_error_rad * kEngaged_m / voxel);
      } else if (m.play_error_m / fit.clearance_m > worst_share) {
        worst_share = m.play_error_m / fit.clearance_m;
        width = voxel / fit.clearance_m;
      }
      rows.push_back(
          {number(1e3 * fit.diameter_m) + " mm", number(1e6 * fit.clearance_m), number(1e6 * voxel), law,
           number(1e6 * m.play_m), number(1e6 * m.play_error_m) + " = " + number(m.play_error_m / voxel),
           number(1e3 * m.tilt_rad), number(1e3 * fit.tilt_rad()),
           number(1e6 * m.tilt_error_rad * kEngaged_m) + " = " + number(m.tilt_error_rad * kEngaged_m / voxel)});
    }
  }
  report.table({"hole", "clearance, um", "voxel, um", "law", "play, um", "error, um = voxels", "tilt, mrad", "exact",
                "error at 8 mm, um = voxels"},
               rows);
  report.say("Where a voxel is wider than the clearance, half a voxel is no test: there play is off by up to " +
             number(100 * worst_share) + " % of the clearance, at a voxel " + number(width) +
             " times as wide. Distances are right at the grid's corners however wide it is; interpolation misses some "
             "h^2 / 8 R of a wall of radius R. The bakes gave " +
             std::to_string(warnings) + " warnings: clearance is between two bodies, and a bake sees one.");
  report.bar("play, voxel smaller than the clearance, largest error", worst_play, "voxels", false, 0.5);
  report.bar("tilt, the same, error at the touching rim", worst_tilt, "voxels", false, 0.5);
}

}  // namespace tact::bench
