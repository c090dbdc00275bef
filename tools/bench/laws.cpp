// What a law costs, by contacts and by how much their normals differ.
#include <algorithm>
#include <cmath>

#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "contact/response/assemble.hpp"
#include "contact/stiffness/law.hpp"

namespace tact::bench {
namespace {

/// n points in contact on a disc (one normal) or on a dome (all normals differ), depths up to half a millimetre.
struct Patch {
  contact::Pointshell shell;
  contact::ContactBuffer contacts;

  Patch(std::size_t n, bool flat) : contacts(n) {
    contacts.size = n;
    for (std::size_t i = 0; i < n; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      const double angle = M_PI * (3 - std::sqrt(5.0)) * static_cast<double>(i),
                   slope = flat ? 0 : 0.9 * std::sqrt(share);
      const Vec3 r = 0.05 * std::sqrt(share) * Vec3(std::cos(angle), std::sin(angle), 0);
      const Vec3 N(-slope * std::cos(angle), -slope * std::sin(angle), std::sqrt(1 - slope * slope));
      shell.position_T.push_back(r.cast<float>());
      shell.normal_T.push_back(N.cast<float>());
      contacts.point_id[i] = static_cast<std::uint32_t>(i);
      contacts.r[i] = r;
      contacts.N[i] = contacts.g[i] = N;
      contacts.depth_m[i] = 5e-4 * (0.1 + 0.9 * std::fabs(std::sin(static_cast<double>(i))));
    }
    shell.radius_m.assign(n, 0.f);
    shell.area_m2.assign(n, 1e-6f);
    shell.child_begin.assign(n, 0);
    shell.child_end.assign(n, 0);
    shell.level_begin = {0, static_cast<std::uint32_t>(n)};
    shell.bounding_radius_m = 0.05;
  }
};

}  // namespace

void bench_laws(const Effort& effort, Report& report) {
  report.say(
      "Law (weigh) and the sums of the response (assemble), nanoseconds a contact. Flat: equal normals; dome: all "
      "differ.");
  std::vector<Report::Row> rows;
  double worst_200 = 0, worst_10000 = 0;
  for (const std::string_view name : contact::law_names()) {
    for (const bool flat : {true, false}) {
      Report::Row row{std::string(name), flat ? "flat" : "dome"};
      for (const std::size_t n : {200u, 10000u}) {
        Patch patch(n, flat);
        const auto law = contact::make_law(name, {}, patch.shell, n);
        Timings weigh, sums;
        for (std::size_t k = 0; k < effort.scaled(n == 200 ? 5000 : 500); ++k) {
          weigh.add(seconds_of([&] { law->weigh(patch.contacts); }));
          sums.add(seconds_of([&] { keep(contact::assemble(patch.contacts, *law, 1e4, 1, Twist{})); }));
        }
        const auto ns = [&](double s) { return 1e9 * s / static_cast<double>(n); };
        row.insert(row.end(),
                   {number(ns(weigh.median())), number(ns(weigh.percentile(0.99))), number(ns(sums.median()))});
        double& worst = n == 200 ? worst_200 : worst_10000;
        worst = std::max(worst, ns(weigh.median()));
      }
      rows.push_back(row);
    }
  }
  report.times({"law", "normals", "n = 200 p50", "p99", "assemble", "n = 10000 p50", "p99", "assemble"}, rows);
  report.bar("dearest law, n = 200", worst_200, "ns a contact", false, 40);
  report.bar("dearest law, n = 10 000", worst_10000, "ns a contact", false, 100);
}

}  // namespace tact::bench
