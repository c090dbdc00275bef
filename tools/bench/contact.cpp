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

}  // namespace

void bench_contact(const Effort& effort, Report& report) {
  constexpr unsigned kSeed = 20;
  const LoadedScene scene = load_scene_by_name("alpha");
  FclPair fcl(scene.obstacle_O, scene.tool_M);
  report.say(
      "Alpha: traversal, law, wrench and derivatives, against fcl::collide (BVHModel<OBBRSS<double>>, all "
      "contacts); same poses, taking turns. Law: " +
      scene.spec.contact.law + ". Microseconds.");
  std::vector<Report::Row> rows;
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
  }
  report.table({"contacts", "poses", "mean", "Tact p50", "p99", "FCL contacts", "FCL p50", "p99", "ratio p50", "p99"},
               rows);
  report.bar("contact tick, about 100 contacts, FCL / Tact at the median", at_100, "x", true, 10);
}

}  // namespace tact::bench
