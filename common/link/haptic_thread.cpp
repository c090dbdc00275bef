#include "link/haptic_thread.hpp"

#include <thread>

namespace tact {

HapticThread::HapticThread(const rt::ThreadOptions& options, std::function<void(Control&)> body)
    : control_(std::make_shared<Control>()), thread_(options, [control = control_, body = std::move(body)] {
        body(*control);
        control->done.store(true, std::memory_order_release);
      }) {}

bool HapticThread::hung() {
  if (!hung_ && control_->guard.abandon_if_stuck(kWriteLimit)) leave_behind();
  return hung_;
}

bool HapticThread::finish() {
  control_->stop.store(true, std::memory_order_relaxed);
  for (int looks = 0; !hung() && !control_->done.load(std::memory_order_acquire); ++looks) {
    if (looks >= kFinishLimit && control_->guard.abandon()) {
      leave_behind();
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
  }
  if (!hung_) thread_.join();
  return !hung_;
}

void HapticThread::leave_behind() {
  hung_ = true;
  thread_.detach();
}

}  // namespace tact
