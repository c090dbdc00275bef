#include "supervise/policy.hpp"

#include <algorithm>

namespace tact::supervise {

std::optional<Duration> RestartPolicy::after_death(Time now) {
  while (!deaths_.empty() && now - deaths_.front() > std::chrono::minutes{1}) deaths_.pop_front();
  deaths_.push_back(now);
  if (deaths_.size() > limit_) return std::nullopt;
  if (deaths_.size() == 1) return Duration::zero();
  const auto doublings = std::min<std::size_t>(deaths_.size() - 2, 6);
  return std::chrono::milliseconds{250} * (1 << doublings);
}

bool FreshWatch::stuck(Time now, bool both_up, bool fresh) {
  if (!armed_) return false;
  if (fresh) {
    armed_ = false;
    return false;
  }
  if (!both_up) {
    since_.reset();
    return false;
  }
  if (!since_) since_ = now;
  if (now - *since_ < kPatience) return false;
  armed_ = false;
  return true;
}

bool RoudiWatch::restart_now(Time now, bool roudi_alive, bool in_contact) {
  if (roudi_alive) {
    lost_.reset();
    free_.reset();
    return false;
  }
  if (!lost_) lost_ = now;
  if (in_contact) {
    free_.reset();
  } else if (!free_) {
    free_ = now;
  }
  const bool now_is_the_time = now - *lost_ >= kLongest || (free_ && now - *free_ >= kOutOfContact);
  if (now_is_the_time) {
    lost_.reset();
    free_.reset();
  }
  return now_is_the_time;
}

}  // namespace tact::supervise
