#include "record/replay.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "record/plot.hpp"

namespace tact::cli {

int replay(const std::filesystem::path& recording, double factor, bool json) {
  record::Tolerance tolerance;
  for (double* t : {&tolerance.force_n, &tolerance.torque_nm, &tolerance.position_m, &tolerance.rotation_rad}) {
    *t *= factor;
  }
  const record::ReplayResult r = record::replay(recording, tolerance);
  if (json) {
    nlohmann::ordered_json out{{"same", r.same()},     {"ticks", r.ticks},           {"unreplayed", r.unreplayed},
                               {"gaps", r.gaps},       {"from_start", r.from_start}, {"ended_early", r.ended_early},
                               {"session", r.session}, {"scene", r.scene},           {"reason", r.reason}};
    for (const auto& q : r.quantities) {
      out["largest_difference"].push_back({{"quantity", q.name},
                                           {"unit", q.unit},
                                           {"difference", q.largest},
                                           {"tolerance", q.tolerance},
                                           {"tick", q.at_tick}});
    }
    if (r.first) out["first"] = {{"tick", r.first->tick}, {"what", r.first->what}};
    std::printf("%s\n", out.dump(2).c_str());
    return r.same() ? 0 : 1;
  }
  std::printf("%s, session %s, scene %s%s%s\n", r.reason.empty() ? "Whole session" : "Flight record", r.session.c_str(),
              r.scene.c_str(), r.reason.empty() ? "" : ": ", r.reason.c_str());
  std::printf("%llu ticks replayed%s; %llu before a snapshot, %llu gaps%s\n", static_cast<unsigned long long>(r.ticks),
              r.from_start ? " from the beginning" : "", static_cast<unsigned long long>(r.unreplayed),
              static_cast<unsigned long long>(r.gaps), r.ended_early ? "; the file ends in mid-record" : "");
  for (const auto& q : r.quantities) {
    std::printf("  %-20s largest difference %9.3g %-3s (tolerance %g)", q.name, q.largest, q.unit, q.tolerance);
    if (q.largest > 0) std::printf(" at tick %llu", static_cast<unsigned long long>(q.at_tick));
    std::printf("\n");
  }
  if (r.first) {
    std::printf("Differs first at tick %llu: %s\n", static_cast<unsigned long long>(r.first->tick),
                r.first->what.c_str());
  } else {
    std::printf("The same.\n");
  }
  return r.same() ? 0 : 1;
}

int plot(const std::filesystem::path& recording, std::filesystem::path png, const std::filesystem::path& csv) {
  if (!csv.empty()) {
    record::write_csv(recording, csv);
    std::printf("CSV: %s\n", csv.c_str());
    if (png.empty()) return 0;
  }
  if (png.empty()) png = std::filesystem::path(recording).replace_extension(".png");
  record::plot(recording, png);
  std::printf("Plot: %s\n", png.c_str());
  return 0;
}

}  // namespace tact::cli
