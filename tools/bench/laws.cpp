// What a law costs, by contacts, by how much their normals differ, and by what was weighed before.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"
#include "contact/response/assemble.hpp"
#include "contact/stiffness/law.hpp"
#include "contact/traversal/traversal.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

constexpr std::size_t kTicks = 25;  // of a walk

/// Contact sets of one shell: walks of kTicks sets, each set near the one before, the walks far from each other.
struct Course {
  contact::LawParams params;
  std::vector<contact::ContactBuffer> sets;
  std::vector<Pose> X_OT;  ///< where the traversal finds them; none: it does not
};

contact::ContactBuffer copy_of(const contact::ContactBuffer& from) {
  contact::ContactBuffer set(from.size);
  set.size = from.size;
  for (std::size_t i = 0; i < from.size; ++i) {
    set.point_id[i] = from.point_id[i];
    set.r[i] = from.r[i], set.N[i] = from.N[i], set.g[i] = from.g[i];
    set.depth_m[i] = from.depth_m[i];
  }
  return set;
}

/// A sheet of 50,000 points, flat (one normal) or bent to a dome (all normals differ).
contact::Pointshell sheet(bool flat) {
  constexpr std::uint32_t kPoints = 50000;
  contact::Pointshell shell;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const double share = (i + 0.5) / kPoints, slope = flat ? 0 : 0.9 * std::sqrt(share),
                 angle = M_PI * (3 - std::sqrt(5.0)) * i;
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    shell.position_T.push_back((0.05 * std::sqrt(share) * along).cast<float>());
    shell.normal_T.push_back((std::sqrt(1 - slope * slope) * Vec3::UnitZ() - slope * along).cast<float>());
  }
  shell.radius_m.assign(kPoints, 0.f);
  shell.area_m2.assign(kPoints, 1e-6f);
  shell.child_begin.assign(kPoints, 0);
  shell.child_end.assign(kPoints, 0);
  shell.level_begin = {0, kPoints};
  shell.bounding_radius_m = 0.05;
  return shell;
}

/// In contact are the n points nearest to a place that moves at 0.1 m/s, depths up to half a millimetre.
Course over_sheet(const contact::Pointshell& shell, std::size_t n, std::size_t walks) {
  Course course;
  course.params.cluster_radius_m = 2e-4;  // nearer than any two points: nothing merges
  std::mt19937 rng(40);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<std::uint32_t> ids(shell.size());
  Vec3 place = Vec3::Zero(), way = place;
  for (std::size_t i = 0; i < walks * kTicks; ++i) {
    if (i % kTicks == 0) {
      place = 0.03 * Vec3(any(rng), any(rng), 0);
      way = 1e-4 * Vec3(any(rng), any(rng), 0).normalized();
    }
    place += way;
    const auto distance = [&](std::uint32_t id) { return (shell.position_T[id].cast<double>() - place).squaredNorm(); };
    std::iota(ids.begin(), ids.end(), 0u);
    const auto end = ids.begin() + static_cast<std::ptrdiff_t>(n);
    std::nth_element(ids.begin(), end, ids.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
    std::sort(ids.begin(), end);  // as the traversal finds them
    contact::ContactBuffer set(n);
    for (std::size_t k = 0; k < n; ++k) {
      set.point_id[k] = ids[k];
      set.r[k] = shell.position_T[ids[k]].cast<double>();
      set.N[k] = set.g[k] = shell.normal_T[ids[k]].cast<double>();
      set.depth_m[k] = 5e-4 * (0.1 + 0.9 * std::fabs(std::sin(static_cast<double>(ids[k]))));
    }
    set.size = n;
    course.sets.push_back(std::move(set));
  }
  return course;
}

/// The tool goes at 0.1 m/s and 0.5 rad/s from poses with about n contacts.
Course through_scene(const LoadedScene& scene, contact::Traversal& traversal, std::size_t n, std::size_t walks) {
  Course course;
  course.params = contact::pipeline_params(scene.spec.contact, scene.field.voxel_m(), 1, 1).law_params;
  const auto near = poses_along(scene, "cheat", 20000, 0.08, 0.3, 40);
  std::mt19937 rng(41);
  std::uniform_real_distribution<double> any(-1, 1);
  contact::ContactBuffer found(scene.shell->size());
  for (Pose X_WM : with_contacts(scene, near, n - n / 7, n + n / 7, walks)) {
    const Vec3 way = 1e-4 * Vec3(any(rng), any(rng), any(rng)).normalized(),
               turn = 5e-4 * Vec3(any(rng), any(rng), any(rng)).normalized();
    for (std::size_t tick = 0; tick < kTicks; ++tick) {
      X_WM = {X_WM.p + way, (exp_so3(turn) * X_WM.q).normalized()};
      course.X_OT.push_back(scene.X_OM(X_WM) * scene.shell->X_TM.inverse());
      traversal.find(course.X_OT.back(), found);
      course.sets.push_back(copy_of(found));
    }
  }
  return course;
}

/// Nanoseconds a contact.
struct Cost {
  Timings again, path, elsewhere, assemble;
};

Cost time_law(contact::Law& law, const Course& course, contact::Traversal* traversal, std::size_t rounds) {
  Cost cost;
  std::size_t most = 0;
  for (const auto& set : course.sets) most = std::max(most, set.size);
  contact::ContactBuffer contacts(most);
  const auto weigh = [&] {
    const auto n = static_cast<double>(contacts.size);
    return 1e9 * seconds_of([&] { law.weigh(contacts); }) / n;
  };
  const auto tick = [&](std::size_t i) {
    if (traversal != nullptr) {
      traversal->find(course.X_OT[i], contacts);
    } else {
      contacts = course.sets[i];
    }
    const auto n = static_cast<double>(contacts.size);
    const double ns = weigh();
    const double sums_s = seconds_of([&] { keep(contact::assemble(contacts, law, 1e4, 1, Twist{})); });
    cost.assemble.add(1e9 * sums_s / n);
    return ns;
  };
  const std::size_t walks = course.sets.size() / kTicks;
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t walk = 0; walk < walks; ++walk) {
      for (std::size_t k = 0; k < kTicks; ++k) {
        contacts = course.sets[walk * kTicks];
        const double ns = weigh();
        if (k > 1) cost.again.add(ns);
      }
    }
    for (std::size_t i = 0; i < course.sets.size(); ++i) {
      const double ns = tick(i);
      if (i % kTicks != 0) cost.path.add(ns);
    }
    for (std::size_t k = 0; k < kTicks; ++k) {
      for (std::size_t walk = 0; walk < walks; ++walk) cost.elsewhere.add(tick(walk * kTicks + k));
    }
  }
  return cost;
}

}  // namespace

void bench_laws(const Effort& effort, Report& report) {
  report.say(
      "Law (weigh) and the sums of the response (assemble), nanoseconds a contact. Flat: equal normals; dome: all "
      "differ; engine: real poses. Again: one set again and again, nothing but a copy in between. Path: sets a "
      "millisecond apart, at 0.1 m/s and, on engine, 0.5 rad/s. Elsewhere: the same sets, each far from the one "
      "before. "
      "On path and elsewhere the sums run between two calls, on engine the traversal too.");
  const LoadedScene scene = load_scene_by_name("engine");
  contact::Traversal traversal(scene.field, scene.shell);
  const contact::Pointshell flat = sheet(true), dome = sheet(false);
  std::vector<Report::Row> rows;
  for (const std::size_t n : {200u, 10000u}) {
    const std::size_t walks = effort.scaled(n == 200 ? 40 : 5);
    struct Case {
      const char* name;
      const contact::Pointshell& shell;
      contact::Traversal* traversal;
      Course course;
    };
    const Case cases[] = {{"flat", flat, nullptr, over_sheet(flat, n, walks)},
                          {"dome", dome, nullptr, over_sheet(dome, n, walks)},
                          {"engine", *scene.shell, &traversal, through_scene(scene, traversal, n, walks)}};
    double dearest = 0;
    for (const std::string_view name : contact::law_names()) {
      for (const Case& c : cases) {
        const auto law = contact::make_law(name, c.course.params, c.shell, c.shell.size());
        const Cost cost = time_law(*law, c.course, c.traversal, n == 200 ? 5 : 2);
        Report::Row row{std::string(name), c.name, std::to_string(n)};
        for (const Timings* t : {&cost.again, &cost.path, &cost.elsewhere}) {
          row.insert(row.end(), {number(t->median()), number(t->percentile(0.99))});
        }
        row.push_back(number(cost.assemble.median()));
        rows.push_back(row);
        dearest = std::max(dearest, cost.path.median());
      }
    }
    report.bar("dearest law along a path, n = " + std::to_string(n), dearest, "ns a contact", false,
               n == 200 ? 40 : 100);
  }
  report.times({"law", "normals", "n", "again p50", "p99", "path p50", "p99", "elsewhere p50", "p99", "assemble"},
               rows);
}

}  // namespace tact::bench
