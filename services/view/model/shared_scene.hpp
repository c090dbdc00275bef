#pragma once
#include <mutex>

#include "view/model/view_scene.hpp"

namespace tact::view {

/// The scene between the thread that hears of it and the threads that draw and tell of it. None of them is real-time.
class SharedScene {
 public:
  template <class Change>
  void update(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(scene_);
  }
  ViewScene copy() const {
    const std::lock_guard lock(mutex_);
    return scene_;
  }

 private:
  mutable std::mutex mutex_;
  ViewScene scene_;
};

}  // namespace tact::view
