#pragma once
#include <atomic>
#include <memory>

namespace tact::contact {

/// Hands objects that own memory to one real-time thread, which neither allocates nor frees: any other thread submits
/// a new one, the real-time thread adopts it when it next looks and leaves the old one to be freed by a later submit.
///
///   submit:  delete retired_.exchange(null)      what the reader left
///            delete pending_.exchange(next)      replaced before it was ever adopted
///   current: if retired_ is empty and pending_ is not: retired_ = current; current = pending_.exchange(null)
///
/// The reader adopts only while `retired_` is empty, so nothing is ever overwritten and lost. release by the thread
/// that gives an object away, acquire by the one that takes it.
template <class T>
class Handover {
 public:
  explicit Handover(std::unique_ptr<T> first) : current_(first.release()) {}
  ~Handover() {
    delete current_;
    delete pending_.load();
    delete retired_.load();
  }
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;

  /// Any thread but the real-time one, one at a time. Frees what is no longer used.
  void submit(std::unique_ptr<T> next) {
    // In this order: once the slot behind is free, what waits is taken by the next current().
    delete pending_.exchange(next.release(), std::memory_order_acq_rel);
    delete retired_.exchange(nullptr, std::memory_order_acq_rel);
  }

  /// The real-time thread: the newest object, its own until it calls again. Does not allocate, free, lock or throw.
  T& current() noexcept {
    if (pending_.load(std::memory_order_relaxed) != nullptr && retired_.load(std::memory_order_relaxed) == nullptr) {
      if (T* next = pending_.exchange(nullptr, std::memory_order_acq_rel)) {
        retired_.store(current_, std::memory_order_release);
        current_ = next;
      }
    }
    return *current_;
  }

 private:
  T* current_;
  std::atomic<T*> pending_{nullptr};
  std::atomic<T*> retired_{nullptr};
};

}  // namespace tact::contact
