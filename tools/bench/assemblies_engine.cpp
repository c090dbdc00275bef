// One part of 2CylinderEngine.glb, a tappet in its bore between camshaft and push rod, is pulled out of all the others
// and put back; then it is pulled where there is no way.
#include <algorithm>
#include <cmath>

#include "bench/assemblies.hpp"
#include "lockstep/lockstep.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

const std::filesystem::path kFile = "/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb";
const std::string kPart = "nodes[75]";  // what assimp calls it: the nodes of this file have no names
const Vec3 kWay = -Vec3::UnitX();       // out of the bore
constexpr double kOut_m = 0.1, kPress_m = 0.003, kCheat_m = 0.03;

Assembly bake_engine(int cells) {
  SceneSpec spec;
  spec.name = "engine-part";
  spec.obstacle.mesh = kFile.string() + "#!" + kPart;
  spec.tool.mesh = kFile.string() + "#" + kPart;
  spec.obstacle.unit = spec.tool.unit = "mm";
  spec.field_resolution = cells;
  return bake_assembly(std::move(spec));
}

/// Where the tappet rests on its cam: there, the file has them overlap.
double seat_m(const Assembly& assembly) {
  Probe probe(assembly, "potential");
  const auto along = [](double s) { return Pose{s * kWay, Quat::Identity()}; };
  return falls_to([&](double s) { return probe.effort(along, s, 1e-6); }, 0.5, 0, 0.005);
}

struct Played {
  std::size_t contacts = 0;
  double depth_m = 0, force_n = 0;      ///< the largest
  double farthest_m = 0, across_m = 0;  ///< of the tool from the start, along the way and across
  Pose end;                             ///< of its mesh frame
};

Played play(const Assembly& assembly, const std::string& law, const HandMotion& motion) {
  lockstep::Experiment setup;
  setup.session.scene = assembly.spec;
  setup.session.scene.contact.law = law;
  setup.session.scene.start_X_WM = motion.X_WM.front();
  setup.bodies = assembly.bodies;
  setup.motion_WM = motion;
  lockstep::Lockstep rig(setup);
  Played played;
  rig.run_script(0.5, [&](const lockstep::TickTrace& trace) {
    const Pose X_WM = trace.X_WT * assembly.bodies.shell->X_TM;
    // Of the part's middle: the file's origin is far off, and turning would move it.
    const Vec3 moved = trace.X_WT.p - (motion.X_WM.front() * assembly.bodies.shell->X_TM.inverse()).p;
    played.contacts = std::max<std::size_t>(played.contacts, trace.contact_count);
    played.depth_m = std::max(played.depth_m, trace.max_depth_m);
    played.force_n = std::max(played.force_n, rig.answer().response_W.F.force.norm());
    played.farthest_m = std::max(played.farthest_m, moved.dot(kWay));
    played.across_m = std::max(played.across_m, (moved - moved.dot(kWay) * kWay).norm());
    played.end = X_WM;
  });
  return played;
}

/// Out along the way and back, at the end pressed on the seat. `off`, `lean`: how far the hand is off the axis, and how
/// it leans, once the part is out and until it is back in by a third.
HandMotion out_and_in(const Assembly& assembly, double seat, double off_m, double lean_rad) {
  const Vec3 middle = assembly.bodies.shell->X_TM.inverse().p, e = kWay.unitOrthogonal();
  const auto at = [&](double s, double share) {
    const Quat q = exp_so3(share * lean_rad * e);
    return Pose{middle - q * middle + s * kWay + share * off_m * e, q};
  };
  HandMotion motion;
  const auto go = [&](double time_s, double s, double share) {
    motion.time_s.push_back(time_s);
    motion.X_WM.push_back(at(s, share));
  };
  go(0, seat + 0.001, 0);
  go(0.3, seat + 0.001, 0);
  go(2, kOut_m, 0);
  go(2.3, kOut_m, 0);
  go(2.6, kOut_m, 1);
  go(3.2, 0.045, 1);
  go(4, 0.02, 0);
  go(4.6, seat - kPress_m, 0);
  go(5, seat - kPress_m, 0);
  return motion;
}

HandMotion cheat(double seat, const Vec3& to) {
  const Pose start{(seat + 0.001) * kWay, Quat::Identity()};
  return {{0, 0.3, 1.3, 2}, {start, start, {start.p + to, start.q}, {start.p + to, start.q}}};
}

}  // namespace

void bench_engine_part(const Effort& effort, Report& report) {
  if (!std::filesystem::exists(kFile)) {
    report.say("2CylinderEngine: left out, " + kFile.string() +
               " is not there (assimp-testmodels; tools/setup --tests).");
    return;
  }
  const Assembly assembly = bake_engine(effort.quick ? 256 : 512);
  const double voxel = assembly.voxel_m(), seat = seat_m(assembly);
  const Vec3 e = kWay.unitOrthogonal(), f = kWay.cross(e);
  Probe probe(assembly, "potential");
  const auto play_along = [&](const Vec3& across) {
    const auto force = [&](double s) {
      return probe.at({0.02 * kWay + s * across, Quat::Identity()}).response_W.F.force.dot(across);
    };
    return falls_to(force, -0.5, 0, voxel) - falls_to(force, 0.5, -voxel, 0);
  };
  report.say(
      "2CylinderEngine.glb, 0.74 m long, voxel " + number(1e3 * voxel) + " mm: a tappet (" + kPart +
      ", 15.5 mm across, 85 mm long), held, against all other nodes. As drawn it overlaps its cam by " +
      number(1e3 * seat) + " mm; its play in the bore, pressed with 0.5 N each way, is " + number(1e3 * play_along(e)) +
      " and " + number(1e3 * play_along(f)) +
      " mm. In the rig: from its seat out, to 100 mm from where it is drawn, back and onto the cam; also with the "
      "hand off the axis and leaning from outside until the part is half in. F_max 10 N over half a voxel.");
  const std::vector<std::string> laws = effort.quick
                                            ? std::vector<std::string>{"potential"}
                                            : std::vector<std::string>{"none", "global", "adaptive-6dof", "potential"};
  std::vector<Report::Row> rows;
  double short_of_out = 0, off_seat = 0;
  for (const auto& [how, off, lean] : {std::tuple{"straight", 0.0, 0.0},
                                       {"1 mm, 1 degree off", 1e-3, M_PI / 180},
                                       {"2 mm, 2 degrees off", 2e-3, 2 * M_PI / 180}}) {
    for (const std::string& law : laws) {
      const Played p = play(assembly, law, out_and_in(assembly, seat, off, lean));
      const double missing = kOut_m - seat - 0.001 - p.farthest_m, off_end = (p.end.p - seat * kWay).dot(kWay);
      if (law == "potential") {
        short_of_out = std::max(short_of_out, missing);
        off_seat = std::max(off_seat, std::fabs(off_end));
      }
      rows.push_back({how, law, std::to_string(p.contacts), number(p.depth_m / voxel), number(p.force_n),
                      number(1e3 * p.farthest_m), missing < 1e-4 ? "yes" : "no", number(1e3 * off_end),
                      std::fabs(off_end) < voxel ? "yes" : "no"});
    }
  }
  report.table(
      {"hand", "law", "most contacts", "depth, voxels", "force, N", "out, mm", "out", "end from seat, mm", "in"}, rows);
  report.bar("potential: short of being out", 1e3 * short_of_out, "mm", false, 0.1);
  report.bar("potential: from the seat at the end", off_seat / voxel, "voxels", false, 0.5);

  rows.clear();
  double farthest = 0;
  for (const auto& [where, to] : {std::pair<std::string, Vec3>{"across", e},
                                  {"across, back", -e},
                                  {"across, square to it", f},
                                  {"that, back", -f},
                                  {"into the cam", -kWay}}) {
    for (const std::string& law : laws) {
      const Played p = play(assembly, law, cheat(seat, kCheat_m * to));
      const double moved = where == "into the cam" ? -(p.end.p - seat * kWay).dot(kWay) : p.across_m;
      if (law == "potential") farthest = std::max(farthest, moved);
      rows.push_back({where, law, std::to_string(p.contacts), number(p.depth_m / voxel), number(p.force_n),
                      number(1e3 * moved), number(moved / voxel), moved < voxel ? "yes" : "no"});
    }
  }
  report.say(
      "Pulled by the hand (20 N, through a coupling that gives 10) 30 mm to where no way is: how far it goes; into the "
      "cam from the seat.");
  report.table({"pulled", "law", "most contacts", "depth, voxels", "force, N", "moved, mm", "voxels", "blocked"}, rows);
  report.bar("potential: moved where there is no way", farthest / voxel, "voxels", false, 1);
}

}  // namespace tact::bench
