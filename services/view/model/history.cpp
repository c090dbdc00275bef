#include "view/model/history.hpp"

namespace tact::view {

void History::add(const HistorySample& sample) {
  if (!ring_.empty() && sample.time_s < (*this)[size() - 1].time_s) {
    ring_.clear();
    first_ = 0;
  }
  if (ring_.size() < capacity_) {
    ring_.push_back(sample);
  } else {
    ring_[first_] = sample;
    first_ = (first_ + 1) % capacity_;
  }
}

}  // namespace tact::view
