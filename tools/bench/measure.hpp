#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

namespace tact::bench {

/// Wall-clock time of one call, in seconds.
template <class F>
double seconds_of(F&& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Keeps the compiler from dropping work whose result nobody reads.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "r,m"(value) : "memory");
}

/// Times of one thing, in seconds.
class Timings {
 public:
  void add(double s) { s_.push_back(s); }
  std::size_t count() const { return s_.size(); }
  /// Fraction p of the times are not longer. @pre count() > 0
  double percentile(double p) const {
    std::vector<double> sorted = s_;
    const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(sorted.size() - 1) + 0.5);
    std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
    return sorted[static_cast<std::size_t>(at)];
  }
  double median() const { return percentile(0.5); }

 private:
  std::vector<double> s_;
};

struct Pair {
  Timings ours, theirs;
  double ratio() const { return theirs.median() / ours.median(); }
};

/// Calls ours(i) and theirs(i) for i < count in turn, who is first changing every time, `rounds` times over: on a
/// shared machine both meet the same disturbances.
template <class A, class B>
Pair alternate(std::size_t count, std::size_t rounds, A&& ours, B&& theirs) {
  Pair pair;
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool we_begin = (i + round) % 2 == 0;
      if (we_begin) pair.ours.add(seconds_of([&] { ours(i); }));
      pair.theirs.add(seconds_of([&] { theirs(i); }));
      if (!we_begin) pair.ours.add(seconds_of([&] { ours(i); }));
    }
  }
  return pair;
}

}  // namespace tact::bench
