#pragma once
#include <string>

namespace tact::bench {

/// One bake, in a process of its own so that its peak memory is its own: `who` is "tact" or "openvdb". Prints one line
/// of JSON. For tact-bench itself.
int bake_child(const std::string& who, const std::string& scene, int cells);

}  // namespace tact::bench
