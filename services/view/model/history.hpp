#pragma once
#include <cstddef>
#include <vector>

namespace tact::view {

/// One instant of the strips.
struct HistorySample {
  double time_s = 0;  ///< monotonic clock of the writer
  float force_n = 0, torque_nm = 0, contacts = 0, penetration_mm = 0, tick_us = 0;
};

/// The last samples in order of time: a ring of fixed capacity.
class History {
 public:
  History() = default;
  explicit History(std::size_t capacity) : capacity_(capacity) {}

  /// Appends; a step back in time (another process, another clock) forgets everything before it.
  void add(const HistorySample& sample);

  std::size_t size() const { return ring_.size(); }
  /// i = 0 is the oldest.
  const HistorySample& operator[](std::size_t i) const { return ring_[(first_ + i) % ring_.size()]; }

 private:
  std::size_t capacity_ = 1500, first_ = 0;
  std::vector<HistorySample> ring_;
};

}  // namespace tact::view
