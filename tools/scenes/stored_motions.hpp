#pragma once
#include <map>
#include <string>

#include "scenes/motion.hpp"

namespace tact::scenes {

/// The motions of deploy/scenes by file name. A test proves that the files are these.
std::map<std::string, HandMotion> stored_motions();

}  // namespace tact::scenes
