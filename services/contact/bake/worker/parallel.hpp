#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <mutex>

#include "contact/bake/worker/progress.hpp"

namespace tact::contact {

/// body(i) for i in [0, count) on all cores, with progress and cancellation. What body throws comes out here.
template <class Body>
void parallel_stage(const char* stage, std::size_t count, const StageProgress& progress, const Body& body) {
  std::atomic<std::size_t> done = 0;
  std::mutex mutex;
  const auto report = [&](double fraction) {
    if (progress && !progress(stage, fraction)) throw Cancelled();
  };
  report(0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    done += range.size();
    if (const std::unique_lock lock(mutex, std::try_to_lock); lock) {
      report(static_cast<double>(done) / static_cast<double>(count));
    }
  });
  report(1);
}

}  // namespace tact::contact
