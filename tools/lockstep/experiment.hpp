#pragma once
#include <functional>

#include "lockstep/lockstep.hpp"
#include "report/session_report.hpp"

namespace tact::lockstep {

/// Plays the whole script, as `tact run` does, and keeps the same books: keys and meaning as the session report, times
/// of computing zero. `each` sees every tick. Throws SetupError when there is nothing to play.
report::SessionReport run_experiment(Lockstep& rig, const Session& session,
                                     const std::function<void(const TickTrace&)>& each = {});

/// The first line and the lines of a CSV of ticks: time_s, pose of the tool, forces, torques, contacts, depth, ...
std::string trace_columns();
std::string trace_row(const TickTrace& trace);

}  // namespace tact::lockstep
