#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace tact::contact {

/// How far a bake is.
struct BakeStep {
  std::string part;     ///< "obstacle", "tool"
  std::string stage;    ///< "distances", "blue noise", ...; "waiting" for another process that bakes the same
  double fraction = 0;  ///< of the stage
};
/// Return false to cancel.
using BakeProgress = std::function<bool(const BakeStep&)>;

/// How a child ended. An error it states itself comes as `error`; otherwise `how` says what became of it.
struct ChildEnd {
  bool good = false;
  std::string error;
  std::string how;        ///< "crashed (Segmentation fault)", "left with code 3"
  std::string last_part;  ///< the part it was at
};

/// Runs a program that prints one JSON object a line on stdout, {"part", "stage", "fraction"} or {"error"}; waits for
/// its end. `progress` is asked at least every 50 ms once the child has spoken. Throws SetupError when it cannot be
/// started, and when `progress` cancels (the child is killed).
ChildEnd run_bake_child(const std::vector<std::string>& command, const BakeProgress& progress);

}  // namespace tact::contact
