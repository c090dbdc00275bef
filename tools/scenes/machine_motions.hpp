#pragma once
#include "scenes/motion.hpp"

namespace tact::scenes {

/// How a part is built into a machine, and how it is not: see deploy/scenes/README.md. Both from the same pose to the
/// same pose; `insert` never touches, `cheat` runs straight through thin parts.
struct MachineMotions {
  HandMotion insert, cheat;
};

MachineMotions engine_motions();
MachineMotions landing_gear_motions();

}  // namespace tact::scenes
