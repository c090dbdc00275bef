#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "coupling/device/virtuose/virtuose_connection.hpp"
#include "rt/doorbell.hpp"
#include "rt/latest_value.hpp"
#include "rt/spsc_ring.hpp"
#include "rt/thread.hpp"

namespace tact::coupling::virtuose {

/// Why the device loop gave the arm back.
enum class Why : int { start, lost, refused, emergency_stop, no_power, cut };

/// What a person should read, from whichever thread has the arm: written without allocation, put into words later.
struct News {
  enum Kind : int {
    opened,
    lost,
    lost_silent,  ///< no call failed, but nothing changes
    not_yet_back,
    not_finite,
    not_a_rotation,
    jump,
    position_error,
    emergency_stop,
    no_power,
    powered,
    release_first,
    alarm_on,
    alarm_off
  } kind = opened;
  Failure failure;
  double value = 0;
};

/// Has the arm whenever the device loop has not: opens it, waits until it is sane and its emergency stop released,
/// switches its motors on, which takes seconds, and only then hands it to the loop; takes it back when the loop lost
/// it, refused its data or found its motors off, rests it and begins again. So whatever may take long happens here, in
/// a thread that is not real-time, and the context always belongs to exactly one thread:
///
///   keeper: open - wait - power on - attach --(owner = loop)--> loop: read, write, read, write
///     ^------------- rest or reopen <---------(owner = keeper)-----------+ give_back(why)
class Keeper {
 public:
  /// Opens the arm; virtOpen is repeated for kOpenPatience, which outlasts the controller's own watchdog: it may still
  /// hold the connection of a process that was killed. Throws SetupError. No power is asked for before start().
  Keeper(const Library& library, const Settings& settings);
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  void start();
  /// Rests and closes the arm. False when the thread hangs in the library: then *this must not be destroyed.
  bool stop();

  // For the loop. Real time.

  bool loop_owns() const noexcept { return owner_.load(std::memory_order_acquire) == Owner::loop; }
  Connection& connection() noexcept { return connection_; }
  void give_back(Why why) noexcept;
  bool cut_requested() const noexcept { return cut_.load(std::memory_order_relaxed); }
  /// While the keeper has the arm: the newest pose, where there is one, and tact::Fault bits.
  bool parked_pose(Pose& X_WH) noexcept { return pose_.read(X_WH); }
  std::uint32_t parked_faults() const noexcept { return faults_.load(std::memory_order_relaxed); }
  void tell(const News& news) noexcept { news_.push(news); }  // by whoever has the arm

  /// Motors off, for good, from any thread. Gives the loop kGrace to let go of the arm, and returns when the power is
  /// cut, after kCutPatience in any case.
  void cut() noexcept;

  std::vector<std::string> take_news();

 private:
  enum class Owner : int { keeper, loop };

  void run();
  void serve_once();
  void do_cut() noexcept;
  bool reopen();
  bool prepare();
  bool wait_until_well();
  void park(const ArmState& state) noexcept;
  bool interrupted() const noexcept { return stop_.load() || cut_.load(); }
  void pause(std::int64_t ns) noexcept { bell_.wait(ns); }

  const std::string library_name_;
  Connection connection_;
  std::atomic<Owner> owner_{Owner::keeper};
  std::atomic<Why> why_{Why::start};
  std::atomic<bool> stop_{false}, cut_{false}, cut_done_{false}, ended_{false};
  std::atomic<std::uint32_t> faults_{0};
  rt::LatestValue<Pose> pose_;
  rt::SpscRing<News> news_{64};
  rt::Doorbell bell_;
  bool told_emergency_ = false, told_lost_ = false, told_data_ = false;
  std::unique_ptr<rt::Thread> thread_;
};

/// Usable as a pose at all: finite and a unit quaternion (floats: within 1e-3).
bool is_sane(const ArmState& state) noexcept;

}  // namespace tact::coupling::virtuose
