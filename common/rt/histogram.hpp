#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tact::rt {

/// Log-spaced counts of durations, the wire's Histogram_: bucket b holds [2^(b/8), 2^((b+1)/8)) ns, so a percentile is
/// right to 9 %. Adding is a few instructions, does not allocate; one thread.
class Histogram {
 public:
  static constexpr std::size_t kBuckets = 288;

  void add(std::int64_t ns) noexcept {
    const double v = ns < 1 ? 1.0 : static_cast<double>(ns);
    auto b = static_cast<std::size_t>(8.0 * std::log2(v));
    if (b >= kBuckets) b = kBuckets - 1;
    ++counts[b];
    ++n;
    if (v > max_ns) max_ns = v;
  }

  void merge(const Histogram& other) noexcept {
    for (std::size_t b = 0; b < kBuckets; ++b) counts[b] += other.counts[b];
    n += other.n;
    if (other.max_ns > max_ns) max_ns = other.max_ns;
  }

  /// Smallest bucket end with at least fraction p of the counts below it, never above the maximum; 0 when empty.
  double percentile_ns(double p) const noexcept {
    if (n == 0) return 0;
    const double wanted = p * static_cast<double>(n);
    std::uint64_t sum = 0;
    for (std::size_t b = 0; b < kBuckets; ++b) {
      sum += counts[b];
      if (static_cast<double>(sum) >= wanted) {
        const double end = std::exp2(static_cast<double>(b + 1) / 8.0);
        return end < max_ns ? end : max_ns;
      }
    }
    return max_ns;
  }

  std::array<std::uint32_t, kBuckets> counts{};
  std::uint64_t n = 0;
  double max_ns = 0;
};

}  // namespace tact::rt
