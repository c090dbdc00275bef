// One contact tick, pose to wrench, against the collision library most users would pick.
#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/peers/fcl_peer.hpp"
#include "bench/scene.hpp"

namespace tact::bench {
namespace {

struct Case {
  const char* name;
  std::size_t fewest, most;
  double shift_m;  ///< off the scripted path, at random
};
constexpr Case kCases[] = {{"about 10", 5, 15, 0.003}, {"about 100", 75, 130, 0.003}, {"about 500", 380, 660, 0.012}};

std::string us(double seconds) { return number(1e6 * seconds); }

/// Where the time of a tick goes.
struct Parts {
  Timings traversal, law_time, assemble;
  double nodes = 0;

  Parts(const LoadedScene& scene, const std::vector<Pose>& poses) {
    const auto capacity = static_cast<std::size_t>(scene.spec.contact.capacity);
    const auto params =
        contact::pipeline_params(scene.spec.contact, scene.field.voxel_m(), scene.spec.coupling.mass_kg, 1);
    const auto law = contact::make_law(params.law, params.law_params, *scene.shell, capacity);
    contact::Traversal find(scene.field, scene.shell);
    contact::ContactBuffer contacts(capacity);
    for (int round = 0; round < 10; ++round) {
      for (const Pose& X_WM : poses) {
        const Pose X_OT = scene.X_OM(X_WM) * scene.shell->X_TM.inverse();
        contact::Findings found;
        traversal.add(seconds_of([&] { found = find.find(X_OT, contacts); }));
        law_time.add(seconds_of([&] { law->weigh(contacts); }));
        assemble.add(seconds_of([&] {
          keep(contact::assemble(contacts, *law, params.stiffness_n_per_m, params.damping_n_s_per_m, Twist{}));
        }));
        nodes += static_cast<double>(found.nodes_visited) / (10 * static_cast<double>(poses.size()));
      }
    }
  }
};

/// What a session does: one pose after the other, near the last one, nothing else in between.
void tick_by_tick(const LoadedScene& scene, Report& report) {
  const auto poses = with_contacts(scene, poses_tick_by_tick(scene, "cheat"), 75, 130, 5000);
  const auto pipeline = scene.pipeline();
  Timings time;
  double contacts = 0;
  for (const Pose& X_WM : poses) {
    const auto query = scene.query(X_WM);
    std::size_t found = 0;
    time.add(seconds_of([&] { found = pipeline->step(query).contact_count; }));
    contacts += static_cast<double>(found) / static_cast<double>(poses.size());
  }
  report.times(
      {"along the cheat, each ms", "poses", "contacts, mean", "tick p50", "p99"},
      {{"75 to 130", std::to_string(poses.size()), number(contacts), us(time.median()), us(time.percentile(0.99))}});
}

/// A scene of the paper's size, ticks alone: FCL would take its time.
void tick_alone(const std::string& name, const Effort& effort, Report& report) {
  const LoadedScene scene = load_scene_by_name(name);
  const auto near = poses_along(scene, "cheat", 20000, 0.002, 0.02, 30);
  const auto poses = with_contacts(scene, near, 20, 120, effort.scaled(300));
  const auto pipeline = scene.pipeline();
  Timings time;
  double contacts = 0;
  for (int round = 0; round < 10; ++round) {
    for (const Pose& X_WM : poses) {
      const auto query = scene.query(X_WM);
      time.add(seconds_of([&] { keep(pipeline->step(query).contact_count); }));
    }
  }
  for (const Pose& X_WM : poses) {
    contacts +=
        static_cast<double>(pipeline->step(scene.query(X_WM)).contact_count) / static_cast<double>(poses.size());
  }
  const Parts p(scene, poses);
  report.times(
      {name, "contacts, mean", "tick p50", "p99", "nodes", "traversal", "law", "assemble"},
      {{std::to_string(poses.size()) + " poses", number(contacts), us(time.median()), us(time.percentile(0.99)),
        number(p.nodes), us(p.traversal.median()), us(p.law_time.median()), us(p.assemble.median())}});
  report.bar(name + ", tick of 20 to 120 contacts, median ([P]: under 700)", 1e6 * time.median(), "us", false, 35);
}

}  // namespace

void bench_contact(const Effort& effort, Report& report) {
  constexpr unsigned kSeed = 20;
  const LoadedScene scene = load_scene_by_name("alpha");
  FclPair fcl(scene.obstacle_O, scene.tool_M);
  report.say("Alpha: traversal, law, wrench and derivatives, against fcl::collide of FCL " +
             std::string(FclPair::version()) +
             " (BVHModel<OBBRSS<double>>, all contacts); same poses, taking turns. Law: " + scene.spec.contact.law +
             ". Microseconds.");
  std::vector<Report::Row> rows, parts;
  double at_100 = 0;
  for (const Case& c : kCases) {
    const auto near = poses_along(scene, "cheat", 20000, c.shift_m, 10 * c.shift_m, kSeed);
    const auto poses = with_contacts(scene, near, c.fewest, c.most, effort.scaled(300));
    const auto pipeline = scene.pipeline();
    double contacts = 0, triangles = 0;
    for (const Pose& X : poses) {
      contacts += static_cast<double>(pipeline->step(scene.query(X)).contact_count);
      triangles += static_cast<double>(fcl.collide(scene.X_OM(X), SIZE_MAX));
    }
    const Pair t = alternate(
        poses.size(), 10, [&](std::size_t i) { keep(pipeline->step(scene.query(poses[i]))); },
        [&](std::size_t i) { keep(fcl.collide(scene.X_OM(poses[i]), SIZE_MAX)); });
    const auto mean = static_cast<double>(poses.size());
    rows.push_back({c.name, number(mean), number(contacts / mean), us(t.ours.median()), us(t.ours.percentile(0.99)),
                    number(triangles / mean), us(t.theirs.median()), us(t.theirs.percentile(0.99)), number(t.ratio()),
                    number(t.theirs.percentile(0.99) / t.ours.percentile(0.99))});
    if (c.fewest == 75) at_100 = t.ratio();
    const Parts p(scene, poses);
    parts.push_back({c.name, number(p.nodes), us(p.traversal.median()), number(1e9 * p.traversal.median() / p.nodes),
                     us(p.law_time.median()), us(p.assemble.median())});
  }
  report.times({"contacts", "poses", "mean", "Tact p50", "p99", "FCL contacts", "FCL p50", "p99", "ratio p50", "p99"},
               rows);
  report.times({"of that, p50", "nodes", "traversal", "ns a node", "law", "assemble"}, parts);
  tick_by_tick(scene, report);
  report.bar("contact tick, about 100 contacts, FCL / Tact at the median", at_100, "x", true, 10);
  if (!effort.quick) tick_alone("engine", effort, report);
}

}  // namespace tact::bench
