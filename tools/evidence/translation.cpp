// [P] section 4's remark: haptics of three degrees of freedom are those of six without torque.
#include <algorithm>
#include <cmath>

#include "bench/presses.hpp"
#include "evidence/experiments.hpp"
#include "evidence/play.hpp"
#include "math/exp_log.hpp"

namespace tact::evidence {

using bench::number;
using bench::Report;

void translation_only(const bench::Effort& effort, Report& report) {
  std::vector<Report::Row> rows;
  double turned_deg = 0;
  int through = 0;
  const std::vector<std::pair<const char*, const char*>> contests =
      effort.quick ? std::vector<std::pair<const char*, const char*>>{{"two-walls", "press"}}
                   : std::vector<std::pair<const char*, const char*>>{
                         {"two-walls", "press"}, {"peg", "press"}, {"cone", "insert"}, {"alpha", "cheat"}};
  for (const auto& [name, script] : contests) {
    const bench::LoadedScene scene = bench::load_scene_by_name(name);
    std::vector<lockstep::Experiment> setups;
    for (const bool locked : {true, false}) {
      for (const std::string& l : laws()) {
        setups.push_back(experiment_of(scene, script));
        law(l)(setups.back());
        setups.back().session.scene.coupling.rotation_locked = locked;
      }
    }
    const auto played = play_all(setups);
    for (std::size_t i = 0; i < laws().size(); ++i) {
      const Played &locked = played[i], &free = played[i + laws().size()];
      for (const auto& tick : locked.ticks) {
        turned_deg =
            std::max(turned_deg, 180 / M_PI * log_so3(tick.X_WT.q * locked.ticks.front().X_WT.q.conjugate()).norm());
      }
      through += scene.spec.goal_X_WM && locked.report.goal_reached ? 1 : 0;
      rows.push_back({std::string(name) + " " + script, laws()[i], number(locked.quasi_static_voxels()),
                      number(free.quasi_static_voxels()), number(locked.report.stats.force_step_rms_n),
                      number(free.report.stats.force_step_rms_n)});
    }
  }
  report.say("coupling.rotation = \"locked\": the tool moves and does not turn. Beside it the same with rotation.");
  report.table({"scene", "law", "locked: quasi-static, voxels", "free", "locked: force step rms, N", "free"}, rows);
  report.claim("the method works for three degrees of freedom as well",
               "the tool turns by at most " + number(turned_deg) + " degrees; " +
                   (through == 0 ? "nothing slips through" : std::to_string(through) + " runs slip through"),
               turned_deg < 1e-6 && through == 0 ? bench::Holds::yes : bench::Holds::partly,
               "Without rotation a tool cannot evade by tilting, so it goes less deep where it would have tilted.");
}

}  // namespace tact::evidence
