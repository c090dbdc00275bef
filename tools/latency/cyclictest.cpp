#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "latency/latency.hpp"
#include "latency/real_time.hpp"

namespace tact::latency {

std::optional<Figure> cyclictest(const Effort& effort) {
  if (std::system("command -v cyclictest >/dev/null 2>&1") != 0) return std::nullopt;
  const auto loops = static_cast<long>(effort.seconds * effort.rate_hz);
  std::string command = "cyclictest -q -m -t 1 -p " + std::to_string(kLoopPriority) + " -i " +
                        std::to_string(std::lround(1e6 / effort.rate_hz)) + " -l " + std::to_string(loops) +
                        " -h 20000";
  if (effort.cpu >= 0) command += " -a " + std::to_string(effort.cpu);
  Figure figure;
  FILE* out = popen((command + " 2>/dev/null").c_str(), "r");
  if (out == nullptr) return std::nullopt;
  // "000012 000345": 345 wake-ups were 12 us late. Its overflows are in the maximum only.
  std::vector<std::int64_t> late;
  char line[256];
  while (std::fgets(line, sizeof line, out) != nullptr) {
    long us = 0, n = 0, max_us = 0;
    if (std::sscanf(line, "%ld %ld", &us, &n) == 2) late.insert(late.end(), static_cast<std::size_t>(n), us * 1000);
    if (std::sscanf(line, "# Max Latencies: %ld", &max_us) == 1 && !late.empty()) late.back() = max_us * 1000;
  }
  const int status = pclose(out);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || late.empty()) {
    figure.error = "cyclictest ended with an error: " + command;
    return figure;
  }
  figure.spread = spread_of(std::move(late));
  figure.conditions = {.fifo = true, .locked = true, .awake = true, .priority = kLoopPriority};
  return figure;
}

}  // namespace tact::latency
