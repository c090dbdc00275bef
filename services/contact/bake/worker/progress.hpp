#pragma once
#include <functional>
#include <stdexcept>

namespace tact::contact {

/// Called with the stage and how much of it is done, 0 to 1, from one thread at a time. Returning false cancels: the
/// bake stops within milliseconds and throws Cancelled.
using StageProgress = std::function<bool(const char* stage, double fraction)>;

struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace tact::contact
