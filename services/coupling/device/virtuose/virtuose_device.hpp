#pragma once
#include <array>
#include <memory>

#include "coupling/device/virtuose/virtuose_keeper.hpp"

namespace tact::coupling::virtuose {

/// A Haption Virtuose through the vendor's library, in both modes: IMPEDANCE (3) and, for pseudo-admittance, VIRTMECH
/// (5) with virtAttachQSVO, whose spring is ours to state, as the gate needs it. The clock is our own grid; the
/// controller's watchdog (2 s without an update: motors off) stays on.
///
/// Engaged: motors on, dead-man held, emergency stop closed, not indexing, and armed: the dead-man was seen released
/// since the arm was last prepared, so that force never begins in a hand that only happened to hold on. Data that are
/// not finite, no rotation, or a jump are refused at once (trusted = false) and end the engagement after kRefusedMax
/// ticks; a failing call, or a held arm that never changes a bit, ends it at once. Then the Keeper has the arm.
class VirtuoseDevice final : public HapticDevice {
 public:
  static constexpr int kRefusedMax = 20;

  struct Params {
    Settings settings;
    double stale_after_s = 0.25;  ///< 0: never
    bool check_only = false;      ///< no power, ever
  };

  /// Opens the arm; may take seconds. Throws SetupError.
  VirtuoseDevice(const Library& library, const Params& params);
  ~VirtuoseDevice() override;

  const DeviceCapabilities& capabilities() const noexcept override { return capabilities_; }
  rt::Tick wait_tick() noexcept override { return ticker_.wait(); }
  DeviceReading read() noexcept override;
  void write(const Wrench& F_W) noexcept override;
  void write(const SetPoint& set_point) noexcept override;
  SetPoint last_set_point() const noexcept override { return set_point_; }
  std::vector<std::string> take_news() override { return keeper_->take_news(); }
  void power_off() noexcept override { keeper_->cut(); }

 private:
  void begin_service() noexcept;
  DeviceReading parked() noexcept;
  DeviceReading give_back(Why why, const News& news) noexcept;
  void watch_alarms(unsigned alarm, std::int64_t now_ns) noexcept;
  bool refused(const ArmState& state, std::int64_t now_ns, News& why) const noexcept;
  bool power_is_due(const ArmState& state, std::int64_t now_ns) noexcept;

  const Params params_;
  DeviceCapabilities capabilities_;
  rt::Ticker ticker_;
  std::unique_ptr<Keeper> keeper_;

  DeviceReading good_;  // pose and twist last trusted
  SetPoint set_point_;
  bool serving_ = false, armed_ = false, begun_ = false;
  bool gripped_ = false;           // last reading: motors on and dead-man held
  std::array<float, 19> raw_{};    // last
  std::int64_t changed_ns_ = 0;    // when raw_ last changed
  std::int64_t unpowered_ns_ = 0;  // since when the motors are off in a hand; 0: they are not
  int refused_ticks_ = 0;
  unsigned alarm_ = 0;  // as told
  std::int64_t alarm_told_ns_ = 0;
};

}  // namespace tact::coupling::virtuose
