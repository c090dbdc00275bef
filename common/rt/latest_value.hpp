#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace tact::rt {

/// Latest-value mailbox, one writer thread and one reader thread, wait-free on both sides: a triple buffer.
///
///   writer owns one slot, reader owns one slot, the third waits in `middle_`; publishing and fetching each swap the
///   owned slot with the middle one in a single exchange.
///
///     writer: slots_[w] = value;  w = middle_.exchange(w | kNew)   release: the slot's content before its index
///     reader: if (middle_ has kNew)  r = middle_.exchange(r)       acquire: the index before the slot's content
///
/// Nobody waits; an unread value is overwritten; the reader never sees a torn value. Does not allocate: T is of fixed
/// size and trivially destructible (fixed-size Eigen members are, though they hide it from is_trivially_copyable).
template <class T>
class LatestValue {
  static_assert(std::is_copy_assignable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  void write(const T& value) noexcept {
    slots_[write_].value = value;
    write_ = middle_.exchange(write_ | kNew, std::memory_order_acq_rel) & kIndex;
  }

  /// Copies the newest value to `out` and returns true, or returns false when there is none since the last read.
  bool read(T& out) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kNew) == 0) return false;
    read_ = middle_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    out = slots_[read_].value;
    return true;
  }

 private:
  static constexpr std::uint32_t kNew = 4, kIndex = 3;
  struct alignas(64) Slot {
    T value{};
  };
  std::array<Slot, 3> slots_{};
  alignas(64) std::atomic<std::uint32_t> middle_{2};
  alignas(64) std::uint32_t write_ = 0;
  alignas(64) std::uint32_t read_ = 1;
};

}  // namespace tact::rt
