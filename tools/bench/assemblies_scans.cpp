// Scans and CAD of Debian's libcgal-demo pressed together in the rig: does the depth keep to the load over k?
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "bench/assemblies.hpp"
#include "fault/fault.hpp"
#include "lockstep/press.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

namespace fs = std::filesystem;

const fs::path kArchive = "/usr/share/doc/libcgal-dev/data.tar.gz";
constexpr double kForce_n = 10;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "tact-bench-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw SetupError(name + ": cannot make a folder here");
    path_ = name;
  }
  ~Folder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A mesh of the archive, its middle at the origin, its longest side `size_m`: a file in metres.
fs::path scaled(const std::string& name, double size_m, const fs::path& folder) {
  const std::string member = "data/meshes/" + name + ".off";
  const std::string command = "tar xzf " + kArchive.string() + " -C " + folder.string() + " " + member;
  if (std::system(command.c_str()) != 0) throw SetupError(kArchive.string() + ": cannot take " + member + " out of it");
  std::ifstream in(folder / member);
  std::string word;
  std::size_t vertices = 0, faces = 0, edges = 0;
  if (!(in >> word >> vertices >> faces >> edges) || word != "OFF") throw SetupError(member + ": not an OFF file");
  std::vector<Vec3> points(vertices);
  Eigen::AlignedBox3d box;
  for (Vec3& p : points) {
    in >> p.x() >> p.y() >> p.z();
    box.extend(p);
  }
  fs::path file = folder / (name + "-" + number(1e3 * size_m) + ".off");
  std::ofstream out(file);
  out.precision(9);
  out << "OFF\n" << vertices << ' ' << faces << " 0\n";
  for (const Vec3& p : points) {
    out << (size_m / box.sizes().maxCoeff() * (p - box.center())).transpose() << '\n';
  }
  for (std::string line; std::getline(in, line);) out << line << '\n';
  if (!in.eof() || !out.flush()) throw SetupError(file.string() + ": cannot be made of " + member);
  return file;
}

/// The hand moves the tool, turned at random, from well outside along a random line towards the obstacle's middle.
lockstep::Experiment press_from(const Assembly& assembly, const std::string& law, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto any = [&] { return Eigen::Vector4d(normal(random), normal(random), normal(random), normal(random)); };
  const Quat q(any().normalized());
  const Vec3 from = any().head<3>().normalized();
  lockstep::Experiment setup;
  setup.session.scene = assembly.spec;
  setup.session.scene.contact.law = law;
  setup.bodies = assembly.bodies;
  const double far = 0.1 + assembly.bodies.shell->bounding_radius_m;
  constexpr int kSteps = 2000;
  for (int i = 0; i <= kSteps; ++i) {
    setup.motion_WM.time_s.push_back(1e-3 * i);
    setup.motion_WM.X_WM.push_back({from * far * (1 - static_cast<double>(i) / kSteps), q});
  }
  lockstep::shorten_to_press(setup);
  lockstep::set_stiffness(setup.session.scene, kForce_n / (0.5 * assembly.voxel_m()), kForce_n, assembly.voxel_m());
  return setup;
}

/// The rub of a press (lockstep/press.hpp) at the end of the motion.
void append_rub(HandMotion& motion) {
  const Pose X = motion.X_WM.back();
  const double begin_s = motion.time_s.back();
  constexpr int kSteps = 60;
  for (int i = 1; i <= kSteps; ++i) {
    const double phase = 2 * std::numbers::pi * i / kSteps;
    const double one = std::sin(phase), two = std::sin(2 * phase), three = std::sin(3 * phase);
    Vec6 x;
    x << 0.004 * Vec3(one, two, three), 0.02 * Vec3(two, three, one);
    motion.time_s.push_back(begin_s + lockstep::kRub_s * i / kSteps);
    motion.X_WM.push_back(displaced(X, x));
  }
}

/// How it lies there, pressed and rubbed, half a second of it.
struct Rest {
  bool touching = false;
  double force_n = 0;    ///< resultant of the contacts, mean
  double ripple_n = 0;   ///< of the force, root mean square about the mean
  double carried_n = 0;  ///< the contacts' forces, added without their directions, at the end
  double turn = 0;       ///< of the field's gradient at a contact from one tick to the next, the largest
  double sway_m = 0;     ///< of the tool's origin, largest from its mean
  double depth_m = 0, contacts = 0;
};

Rest rest_of(lockstep::Experiment setup) {
  append_rub(setup.motion_WM);
  lockstep::Lockstep rig(setup);
  rig.run_script(2);
  Rest rest;
  constexpr int kTicks = 500;
  std::vector<Vec3> force, place;
  std::map<std::uint32_t, Vec3> gradient, before;  // by point
  for (int i = 0; i < kTicks; ++i) {
    const lockstep::TickTrace& trace = rig.tick();
    force.push_back(rig.answer().response_W.F.force);
    place.push_back(trace.X_WT.p);
    const contact::ContactBuffer& contacts = rig.pipeline().contacts();
    gradient.clear();
    for (std::size_t c = 0; c < contacts.size; ++c) {
      gradient[contacts.point_id[c]] = contacts.g[c];
      const auto last = before.find(contacts.point_id[c]);
      if (last != before.end()) rest.turn = std::max(rest.turn, (contacts.g[c] - last->second).norm());
    }
    before.swap(gradient);
    rest.contacts += static_cast<double>(trace.contact_count) / kTicks;
    rest.depth_m = std::max(rest.depth_m, trace.max_depth_m);
  }
  rest.touching = rig.trace().contact_count > 0;
  Vec3 mean = Vec3::Zero(), middle = Vec3::Zero();
  for (const Vec3& f : force) mean += f / kTicks;
  for (const Vec3& p : place) middle += p / kTicks;
  for (const Vec3& p : place) rest.sway_m = std::max(rest.sway_m, (p - middle).norm());
  for (const Vec3& f : force) rest.ripple_n += (f - mean).squaredNorm() / kTicks;
  rest.ripple_n = std::sqrt(rest.ripple_n);
  rest.force_n = mean.norm();
  const contact::ContactBuffer& contacts = rig.pipeline().contacts();
  for (std::size_t i = 0; i < contacts.size; ++i) {
    rest.carried_n += contacts.weight[i] * rig.answer().stiffness_n_per_m * contacts.depth_m[i];
  }
  return rest;
}

struct Pair {
  std::string name, fixed, held;
};

/// What came of the presses of one pair under one law.
struct Presses {
  int count = 0, stable = 0, slid_off = 0;
  double contacts = 0, force_n = 0, depth = 0;  ///< means of those that hold; depths in voxels
  double deepest = 0, over_pull = 0, over_carried = 0, ripple_n = 0, sway_m = 0, turn = 0;  ///< the largest
  std::string why;                                                                          ///< of those not stable
};

Presses press_all(const Assembly& assembly, const std::string& law, int directions) {
  std::mt19937 random(5);
  Presses all;
  for (all.count = 0; all.count < directions; ++all.count) {
    const lockstep::Experiment setup = press_from(assembly, law, random);
    const lockstep::Verdict verdict = lockstep::press(setup);
    const Rest rest = rest_of(setup);
    if (verdict.why == lockstep::Verdict::Why::lost && !rest.touching) {
      ++all.slid_off;
      continue;
    }
    const double k = kForce_n / (0.5 * assembly.voxel_m());
    all.contacts += rest.contacts;
    all.force_n += rest.force_n;
    all.depth += rest.depth_m / assembly.voxel_m();
    all.deepest = std::max(all.deepest, rest.depth_m / assembly.voxel_m());
    all.over_pull = std::max(all.over_pull, rest.depth_m * k / rest.force_n);
    all.over_carried = std::max(all.over_carried, rest.depth_m * k / rest.carried_n);
    all.ripple_n = std::max(all.ripple_n, rest.ripple_n);
    all.turn = std::max(all.turn, rest.turn);
    all.sway_m = std::max(all.sway_m, rest.sway_m);
    if (verdict.stable()) {
      ++all.stable;
    } else if (all.why.find(lockstep::name(verdict.why)) == std::string::npos) {
      all.why += (all.why.empty() ? "" : ", ") + std::string(lockstep::name(verdict.why));
    }
  }
  const double held = std::max(1, all.count - all.slid_off);
  all.contacts /= held;
  all.force_n /= held;
  all.depth /= held;
  return all;
}

}  // namespace

void bench_scans(const Effort& effort, Report& report) {
  if (!fs::exists(kArchive)) {
    report.say("Armadillo, bunny, anchor: left out, " + kArchive.string() +
               " is not there (libcgal-demo; tools/setup --tests).");
    return;
  }
  report.say(
      "Armadillo, bunny and anchor of libcgal-demo, the fixed one 100 mm long, the held one 60 mm, turned at random, "
      "pressed together with up to 10 N along random lines through the middle (seeded), rubbed and kept, in the rig. k "
      "= "
      "10 N over half a voxel. Stable: as tools/lockstep has it, half a second after the rub. Depth (the deepest "
      "point), "
      "F (resultant) and ripple of the force: two seconds after the rub. Carried: forces of all contacts added without "
      "their directions. Sway: of the tool meanwhile; turn of g: of the field's gradient at a contact from tick to "
      "tick. "
      "Slid off: nothing holds a tool without friction.");
  const Folder folder;
  std::vector<Pair> pairs{{"armadillo-bunny", "armadillo", "bunny00"}, {"bunny-anchor", "bunny00", "anchor_dense"}};
  if (!effort.quick) pairs.push_back({"anchor-armadillo", "anchor_dense", "armadillo"});
  std::vector<Report::Row> rows;
  Presses ours;
  int held = 0, restless = 0;  // under any law
  const std::vector<std::string> laws = effort.quick
                                            ? std::vector<std::string>{"none", "potential"}
                                            : std::vector<std::string>{"none", "global", "adaptive-6dof", "potential"};
  for (const Pair& pair : pairs) {
    SceneSpec spec;
    spec.name = pair.name;
    spec.obstacle.mesh = scaled(pair.fixed, 0.1, folder.path());
    spec.tool.mesh = scaled(pair.held, 0.06, folder.path());
    spec.obstacle.unit = spec.tool.unit = "m";
    spec.field_resolution = 256;
    spec.points = 10000;
    const Assembly assembly = bake_assembly(std::move(spec));
    for (const std::string& law : laws) {
      const Presses p = press_all(assembly, law, effort.quick ? 3 : 12);
      held += p.count - p.slid_off;
      restless += p.count - p.slid_off - p.stable;
      if (law == "potential") {
        ours.count += p.count - p.slid_off;
        ours.stable += p.stable;
        ours.over_carried = std::max(ours.over_carried, p.over_carried);
        ours.over_pull = std::max(ours.over_pull, p.over_pull);
        ours.ripple_n = std::max(ours.ripple_n, p.ripple_n);
      }
      rows.push_back({pair.name, law, number(p.contacts), number(p.force_n), number(p.depth), number(p.deepest),
                      number(p.over_pull), number(p.over_carried), number(p.ripple_n), number(1e6 * p.sway_m),
                      number(p.turn),
                      std::to_string(p.stable) + " of " + std::to_string(p.count - p.slid_off) +
                          (p.why.empty() ? "" : " (" + p.why + ")"),
                      std::to_string(p.slid_off)});
    }
    for (const auto* body : {&assembly.baked.obstacle, &assembly.baked.tool}) {
      for (const std::string& warning : body->warnings) report.say("  bake: " + warning.substr(warning.rfind('/') + 1));
    }
  }
  report.table({"fixed, held", "law", "contacts", "F, N", "depth, voxels", "largest", "largest / (F/k)",
                "largest / (carried/k)", "ripple, N", "sway, um", "turn of g", "stable", "slid off"},
               rows);
  report.bar("potential: presses that hold and are stable", ours.stable, "of " + std::to_string(ours.count), true,
             ours.count);
  report.bar("potential: deepest point over carried load / k", ours.over_carried, "", false, 1);
  report.say(
      "potential: deepest point over F/k, largest " + number(ours.over_pull) +
      ": above 1 where contacts push against one another, as a wedge's do; the pull alone bounds nothing there.");
  if (restless == 0) return;
  report.say(
      "Under all laws " + std::to_string(restless) + " of " + std::to_string(held) +
      " presses do not come to rest. Sway and turn of g say why: a contact lies where two cells of the field meet, "
      "the interpolated gradient turns there at once, and the tool is pushed to and fro across by micrometres.");
}

}  // namespace tact::bench
