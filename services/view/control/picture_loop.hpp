#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "view/control/conversation.hpp"
#include "view/model/shared_scene.hpp"
#include "view/web/outbox.hpp"

namespace tact::view {

struct PictureOptions {
  int width = 640, height = 480;
  double max_frames_per_s = 20;
  double max_load = 0.5;  ///< of one processor: a busy picture comes less often
  int plot_every = 4;     ///< pictures between two sets of plots
};

/// Draws while somebody watches, in a thread of its own: picture, Gauss map, slice and strips as JPEG. When nobody
/// watches it sleeps, and until somebody does for the first time nothing is loaded.
class PictureLoop {
 public:
  using Publish = std::function<void(Slot, std::string bytes)>;

  PictureLoop(const PictureOptions& options, const SharedScene& scene, Conversation& conversation,
              std::function<bool()> watched, Publish publish);
  ~PictureLoop();

  double frames_per_s() const { return frames_per_s_; }          ///< over the last second or so; 0: not drawing
  double cpu_ms_per_frame() const { return cpu_ms_per_frame_; }  ///< of the drawing thread, plots included

 private:
  void run();

  PictureOptions options_;
  const SharedScene& scene_;
  Conversation& conversation_;
  std::function<bool()> watched_;
  Publish publish_;
  std::atomic<double> frames_per_s_{0}, cpu_ms_per_frame_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace tact::view
