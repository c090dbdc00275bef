#include <algorithm>
#include <cmath>
#include <thread>

#include "latency/latency.hpp"
#include "latency/real_time.hpp"
#include "rt/tick.hpp"

namespace tact::latency {

Spread spread_of(std::vector<std::int64_t> ns) {
  if (ns.empty()) return {};
  std::sort(ns.begin(), ns.end());
  const auto at = [&ns](double p) {
    const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(ns.size())));
    return 1e-3 * static_cast<double>(ns[std::max<std::size_t>(rank, 1) - 1]);
  };
  return {ns.size(), at(0.5), at(0.99), at(0.999), at(1)};
}

Figure wakeup(const Effort& effort) {
  RealTime real_time;
  Figure figure;
  const auto count = static_cast<std::size_t>(effort.seconds * effort.rate_hz);
  std::vector<std::int64_t> late(count);
  figure.conditions = real_time.run("latency", kLoopPriority, effort.cpu, [&] {
    rt::Ticker ticker(static_cast<std::int64_t>(std::llround(1e9 / effort.rate_hz)));
    for (std::int64_t& ns : late) {
      const rt::Tick tick = ticker.wait();
      ns = tick.woke_ns - tick.due_ns;
      figure.missed += tick.skipped;
    }
  });
  figure.spread = spread_of(std::move(late));
  return figure;
}

}  // namespace tact::latency
