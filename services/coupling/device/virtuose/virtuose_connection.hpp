#pragma once
#include <array>
#include <string>

#include "coupling/device/device.hpp"
#include "coupling/device/driver_spring.hpp"
#include "coupling/device/virtuose/virtuose_library.hpp"

namespace tact::coupling::virtuose {

/// What is told to the arm when it is opened.
struct Settings {
  std::string address;
  DeviceMode mode = DeviceMode::pseudo_admittance;
  double rate_hz = 1000;
  double timeout_s = 0.02;
  double force_factor = 1, speed_factor = 1;
  IndexingMode indexing = index_all;
  DriverSpring spring;                             ///< pseudo-admittance
  double force_limit_n = 30, torque_limit_nm = 3;  ///< a second limit in the controller, where the library knows it
};

/// A call that failed, and the library's reason. No call: all is well.
struct Failure {
  const char* call = nullptr;
  int code = 0;
  explicit operator bool() const noexcept { return call != nullptr; }
};

/// "virtSetTimeStep failed: error 19 (called too late or in the wrong order)".
std::string describe(const Failure& failure);

/// What the arm said in one round of reading: unchecked.
struct ArmState {
  std::array<float, 19> raw{};  ///< pose, twist, wrench as they came
  bool powered = false, dead_man = false, indexing = false;
  bool chain_closed = false;  ///< of the emergency stop: true is healthy
  unsigned alarm = 0;         ///< Alarm bits

  Pose X_WH() const noexcept;
  Twist V_WH() const noexcept;
  Wrench F_hand_W() const noexcept;
};

/// One context of the library and the order of its calls. Frames: base and observation are set to identity, so that the
/// library's environment, observation and base frames are one: ours is W. One thread at a time, except cut_power().
class Connection {
 public:
  Connection(const Calls& calls, const Settings& settings) : calls_(calls), settings_(settings) {}
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { close(); }

  const Settings& settings() const noexcept { return settings_; }
  bool is_open() const noexcept { return context_ != nullptr; }

  // These may block as long as the library does, and are not for a tick.

  /// Opens and configures: everything up to the command type, in the documented order; no power. Closed again when a
  /// call fails. An optional call that fails costs only what it does.
  Failure open();
  /// Motors on: they need seconds. The set-point is where the handle is, at rest, before; so nothing moves.
  Failure request_power();
  /// Pseudo-admittance: the set-point where the handle is, at rest, then the spring: rotation first. Impedance:
  /// nothing.
  Failure attach();
  /// Zero force, spring off, motors off, whatever the calls answer.
  void rest() noexcept;
  /// rest(), then closes.
  void close() noexcept;
  /// Type and serial number, version of the library: one line; empty where the library does not say.
  std::string identity() const;

  // In a tick: bounded by the library's timeout.

  Failure read(ArmState& state) noexcept;
  Failure write(const Wrench& F_W) noexcept;
  Failure write(const SetPoint& set_point) noexcept;
  /// read(), and zero force or the set-point where the handle is, at rest: what keeps the controller's watchdog content
  /// and the arm still.
  Failure hold(ArmState& state) noexcept;

  /// The last resort, while another thread hangs in a call: motors off, in one call. The library promises nothing for a
  /// second thread in a context; a hung loop under power is worse. Not together with open() or close().
  void cut_power() noexcept;

 private:
  Failure failed(const char* call) const noexcept { return {call, calls_.virtGetErrorCode(context_)}; }
  Failure configure();

  const Calls calls_;
  const Settings settings_;
  Context context_ = nullptr;
  bool attached_ = false;
};

}  // namespace tact::coupling::virtuose
