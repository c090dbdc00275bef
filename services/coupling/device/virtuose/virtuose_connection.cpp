#include "coupling/device/virtuose/virtuose_connection.hpp"

#include <algorithm>

namespace tact::coupling::virtuose {
namespace {

std::array<float, 7> to_floats(const Pose& X) {
  const Quat q = X.q.normalized();
  return {static_cast<float>(X.p.x()), static_cast<float>(X.p.y()), static_cast<float>(X.p.z()),
          static_cast<float>(q.x()),   static_cast<float>(q.y()),   static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

std::array<float, 6> to_floats(const Vec6& v) {
  std::array<float, 6> out{};
  for (std::size_t i = 0; i < 6; ++i) out[i] = static_cast<float>(v[static_cast<int>(i)]);
  return out;
}

Vec6 vec6(const float* v) { return Eigen::Map<const Eigen::Matrix<float, 6, 1>>(v).cast<double>(); }

}  // namespace

std::string describe(const Failure& failure) {
  return std::string(failure.call) + " failed: error " + describe_error(failure.code);
}

Pose ArmState::X_WH() const noexcept {
  const float* v = raw.data();
  return {Vec3(v[0], v[1], v[2]), Quat(v[6], v[3], v[4], v[5])};
}
Twist ArmState::V_WH() const noexcept { return Twist::from(vec6(raw.data() + 7)); }
Wrench ArmState::F_hand_W() const noexcept { return Wrench::from(vec6(raw.data() + 13)); }

// A failed call ends the function that makes it.
#define TACT_VIRTUOSE_CALL(name, ...)                                                \
  do {                                                                               \
    if (calls_.name(context_ __VA_OPT__(, ) __VA_ARGS__) != 0) return failed(#name); \
  } while (false)

Failure Connection::open() {
  context_ = calls_.virtOpen(settings_.address.c_str());
  if (context_ == nullptr) return failed("virtOpen");
  const Failure failure = configure();
  if (failure) close();
  return failure;
}

Failure Connection::configure() {
  const auto f = [](double v) { return static_cast<float>(v); };
  std::array<float, 7> identity = to_floats(Pose{});
  if (calls_.virtSetTimeoutValue != nullptr) TACT_VIRTUOSE_CALL(virtSetTimeoutValue, f(settings_.timeout_s));
  TACT_VIRTUOSE_CALL(virtSetIndexingMode, settings_.indexing);
  TACT_VIRTUOSE_CALL(virtSetForceFactor, f(settings_.force_factor));
  TACT_VIRTUOSE_CALL(virtSetSpeedFactor, f(settings_.speed_factor));
  TACT_VIRTUOSE_CALL(virtSetTimeStep, f(1 / settings_.rate_hz));
  TACT_VIRTUOSE_CALL(virtSetBaseFrame, identity.data());
  TACT_VIRTUOSE_CALL(virtSetObservationFrame, identity.data());
  TACT_VIRTUOSE_CALL(virtSetCommandType,
                     settings_.mode == DeviceMode::impedance ? command_impedance : command_virtual_mechanism);
  if (calls_.virtSaturateTorque != nullptr) {
    calls_.virtSaturateTorque(context_, f(settings_.force_limit_n), f(settings_.torque_limit_nm));
  }
  if (calls_.virtEnableForceFeedback != nullptr) calls_.virtEnableForceFeedback(context_, 1);
  return {};
}

Failure Connection::request_power() {
  ArmState state;
  if (const Failure failure = hold(state)) return failure;
  TACT_VIRTUOSE_CALL(virtSetPowerOn, 1);
  return {};
}

Failure Connection::attach() {
  if (settings_.mode == DeviceMode::impedance) return {};
  ArmState state;
  if (const Failure failure = hold(state)) return failure;
  const DriverSpring& s = settings_.spring;
  std::array<float, 6> stiffness{}, damping{};
  for (std::size_t i = 0; i < 3; ++i) {
    stiffness[i] = static_cast<float>(s.nm_per_rad);
    stiffness[i + 3] = static_cast<float>(s.n_per_m);
    damping[i] = static_cast<float>(s.nm_s_per_rad);
    damping[i + 3] = static_cast<float>(s.n_s_per_m);
  }
  TACT_VIRTUOSE_CALL(virtAttachQSVO, stiffness.data(), damping.data());
  attached_ = true;
  return {};
}

void Connection::rest() noexcept {
  if (context_ == nullptr) return;
  if (settings_.mode == DeviceMode::impedance) write(Wrench{});
  if (attached_) calls_.virtDetachVO(context_);
  attached_ = false;
  calls_.virtSetPowerOn(context_, 0);
}

void Connection::close() noexcept {
  if (context_ == nullptr) return;
  rest();
  calls_.virtClose(context_);
  context_ = nullptr;
}

std::string Connection::identity() const {
  std::string text;
  int a = 0, b = 0;
  if (calls_.virtGetDeviceID != nullptr && calls_.virtGetDeviceID(context_, &a, &b) == 0) {
    text = "device type " + std::to_string(a) + ", serial number " + std::to_string(b);
  }
  if (calls_.virtAPIVersion != nullptr && calls_.virtAPIVersion(&a, &b) == 0) {
    text += (text.empty() ? "" : ", ") + std::string("VirtuoseAPI ") + std::to_string(a) + "." + std::to_string(b);
  }
  return text;
}

Failure Connection::read(ArmState& state) noexcept {
  int dead_man = 0, chain = 0, power = 0, shift = 0;
  TACT_VIRTUOSE_CALL(virtGetPosition, state.raw.data());
  TACT_VIRTUOSE_CALL(virtGetSpeed, state.raw.data() + 7);
  if (settings_.mode == DeviceMode::pseudo_admittance) TACT_VIRTUOSE_CALL(virtGetForce, state.raw.data() + 13);
  TACT_VIRTUOSE_CALL(virtGetDeadMan, &dead_man);
  TACT_VIRTUOSE_CALL(virtGetEmergencyStop, &chain);
  TACT_VIRTUOSE_CALL(virtGetPowerOn, &power);
  TACT_VIRTUOSE_CALL(virtIsInShiftPosition, &shift);
  TACT_VIRTUOSE_CALL(virtGetAlarm, &state.alarm);
  state.dead_man = dead_man == 1;
  state.chain_closed = chain == 1;
  state.powered = power == 1;
  state.indexing = shift != 0;
  return {};
}

Failure Connection::write(const Wrench& F_W) noexcept {
  std::array<float, 6> wrench = to_floats(F_W.vector());
  TACT_VIRTUOSE_CALL(virtSetForce, wrench.data());
  return {};
}

Failure Connection::write(const SetPoint& set_point) noexcept {
  std::array<float, 7> pose = to_floats(set_point.X_W);
  std::array<float, 6> twist = to_floats(set_point.V_W.vector());
  TACT_VIRTUOSE_CALL(virtSetPosition, pose.data());
  TACT_VIRTUOSE_CALL(virtSetSpeed, twist.data());
  return {};
}

Failure Connection::hold(ArmState& state) noexcept {
  if (const Failure failure = read(state)) return failure;
  if (settings_.mode == DeviceMode::impedance) return write(Wrench{});
  const Pose X = state.X_WH();
  if (!X.finite() || X.q.norm() < 0.5) return {};  // nothing to repeat
  return write(SetPoint{X, {}});
}

void Connection::cut_power() noexcept {
  if (context_ != nullptr) calls_.virtSetPowerOn(context_, 0);
}

#undef TACT_VIRTUOSE_CALL

}  // namespace tact::coupling::virtuose
