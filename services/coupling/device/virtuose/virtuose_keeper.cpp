#include "coupling/device/virtuose/virtuose_keeper.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>

#include "fault/fault.hpp"
#include "rt/tick.hpp"

namespace tact::coupling::virtuose {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kOpenPatience = 6000 * kMs;  // the controller's watchdog: 2 s
constexpr std::int64_t kOpenAgain = 500 * kMs;
constexpr std::int64_t kPoll = 10 * kMs;         // keeps the controller's watchdog content
constexpr std::int64_t kPowerWait = 5000 * kMs;  // relays and brakes
constexpr std::int64_t kGrace = 20 * kMs, kCutPatience = 60 * kMs;
constexpr std::int64_t kEndPatience = 3000 * kMs;

void sleep_ns(std::int64_t ns) {
  const timespec t{ns / 1'000'000'000, ns % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &t, nullptr);
}

std::string alarm_words(unsigned alarm) {
  std::string words;
  const auto add = [&](unsigned bit_, const char* text) {
    if ((alarm & bit_) == 0) return;
    words += (words.empty() ? "" : ", ") + std::string(text);
    alarm &= ~bit_;
  };
  add(alarm_overheat, "a motor is too hot: the arm reduces its force until it has cooled");
  add(alarm_saturated, "the motor currents are at their maximum");
  add(alarm_callback_overrun, "callback overrun");
  add(alarm_position, "the arm's position is wrong: calibrate it");
  add(alarm_low_battery, "low battery");
  if (alarm != 0) {
    char text[32];
    std::snprintf(text, sizeof text, "unknown alarm 0x%x", alarm);
    add(alarm, text);
  }
  return words;
}

std::string words_of(const News& n) {
  char number[64];
  switch (n.kind) {
    case News::opened:
      return "open";
    case News::lost:
      return "lost: " + describe(n.failure) + "; it is opened again as soon as it answers";
    case News::lost_silent:
      std::snprintf(number, sizeof number, "%.2f s", n.value);
      return std::string("lost: held by a hand, yet nothing it says has changed for ") + number;
    case News::not_yet_back:
      return "cannot be opened again yet: " + describe(n.failure);
    case News::not_finite:
      return "refused what the arm says: not a number";
    case News::not_a_rotation:
      std::snprintf(number, sizeof number, "%.4f", n.value);
      return std::string("refused what the arm says: a quaternion of norm ") + number;
    case News::jump:
      std::snprintf(number, sizeof number, "%.1f mm or as much turn", n.value * 1e3);
      return std::string("refused what the arm says: a jump of ") + number + " from one reading to the next";
    case News::position_error:
      return "refused what the arm says: it reports an error of its position; calibrate it";
    case News::emergency_stop:
      return "the emergency stop is pressed: no force until it is released";
    case News::no_power:
      return "the motors are off although they were asked for: press the arm's power button";
    case News::powered:
      return "the motors are on";
    case News::release_first:
      return "let go of the handle's dead-man sensor once: force begins with the next grip";
    case News::alarm_on:
      return "alarm: " + alarm_words(static_cast<unsigned>(n.value));
    case News::alarm_off:
      return "alarm over: " + alarm_words(static_cast<unsigned>(n.value));
  }
  return {};
}

}  // namespace

bool is_sane(const ArmState& state) noexcept {
  for (const float v : state.raw) {
    if (!std::isfinite(v)) return false;
  }
  return std::abs(state.X_WH().q.norm() - 1) < 1e-3;
}

Keeper::Keeper(const Library& library, const Settings& settings)
    : library_name_(library.name), connection_(library.calls, settings) {
  const std::int64_t until = rt::monotonic_ns() + kOpenPatience;
  Failure failure;
  while ((failure = connection_.open()) && std::string(failure.call) == "virtOpen" && rt::monotonic_ns() < until) {
    sleep_ns(kOpenAgain);
  }
  if (failure) {
    throw SetupError("machine: device.address: virtuose " + settings.address + ": " + describe(failure) +
                     "; is the arm on, its local service running, nobody else connected? (library " + library_name_ +
                     ")");
  }
  ArmState state;
  if (!connection_.read(state) && is_sane(state)) park(state);
  tell({News::opened, {}, 0});
}

void Keeper::start() {
  thread_ = std::make_unique<rt::Thread>(rt::ThreadOptions{.name = "virtuose"}, [this] { run(); });
}

bool Keeper::stop() {
  if (thread_ == nullptr) return true;
  stop_.store(true);
  bell_.ring();
  const std::int64_t until = rt::monotonic_ns() + kEndPatience;
  while (!ended_.load() && rt::monotonic_ns() < until) sleep_ns(kMs);
  if (ended_.load()) {
    thread_->join();
    return true;
  }
  thread_->detach();
  return false;
}

void Keeper::give_back(Why why) noexcept {
  why_.store(why, std::memory_order_relaxed);
  owner_.store(Owner::keeper, std::memory_order_release);
  bell_.ring();
}

void Keeper::cut() noexcept {
  cut_.store(true);
  bell_.ring();
  if (thread_ == nullptr) return;  // there never was power
  const std::int64_t until = rt::monotonic_ns() + kCutPatience;
  while (!cut_done_.load() && !ended_.load() && rt::monotonic_ns() < until) sleep_ns(kMs);
}

void Keeper::run() {
  while (!stop_.load()) serve_once();
  connection_.close();
  ended_.store(true);
}

void Keeper::serve_once() {
  if (cut_.load()) {
    if (!cut_done_.load()) do_cut();
    return pause(100 * kMs);
  }
  if (loop_owns()) return pause(100 * kMs);
  const Why why = why_.load(std::memory_order_relaxed);
  if (why == Why::lost) {
    faults_.store(bit(Fault::device_lost));
    connection_.close();
  } else if (why != Why::start) {
    connection_.rest();
  }
  if (!connection_.is_open() && !reopen()) return pause(kOpenAgain);
  why_.store(Why::start, std::memory_order_relaxed);
  if (prepare()) {
    told_emergency_ = told_lost_ = told_data_ = false;
    faults_.store(0);
    owner_.store(Owner::loop, std::memory_order_release);
  }
}

void Keeper::do_cut() noexcept {
  const std::int64_t until = rt::monotonic_ns() + kGrace;
  while (loop_owns() && rt::monotonic_ns() < until) sleep_ns(kMs);
  if (loop_owns()) {
    connection_.cut_power();
  } else {
    connection_.rest();
  }
  cut_done_.store(true);
}

bool Keeper::reopen() {
  faults_.store(bit(Fault::device_lost));
  if (const Failure failure = connection_.open()) {
    if (!told_lost_) tell({News::not_yet_back, failure, 0});
    told_lost_ = true;
    return false;
  }
  tell({News::opened, {}, 0});
  return true;
}

void Keeper::park(const ArmState& state) noexcept { pose_.write(state.X_WH()); }

/// Until the arm is sane and its emergency stop released; false: lost, or interrupted.
bool Keeper::wait_until_well() {
  while (!interrupted()) {
    ArmState state;
    if (const Failure failure = connection_.hold(state)) {
      tell({News::lost, failure, 0});
      why_.store(Why::lost, std::memory_order_relaxed);
      return false;
    }
    const bool sane = is_sane(state) && (state.alarm & alarm_position) == 0;
    if (sane) park(state);
    if (!state.chain_closed && !told_emergency_) tell({News::emergency_stop, {}, 0});
    told_emergency_ = told_emergency_ || !state.chain_closed;
    if (!sane && !told_data_) {
      tell({(state.alarm & alarm_position) != 0 ? News::position_error : News::not_finite, {}, 0});
    }
    told_data_ = told_data_ || !sane;
    faults_.store((sane ? 0 : bit(Fault::device_data)) |
                  (state.chain_closed && state.alarm == 0 ? 0 : bit(Fault::device_alarm)));
    if (sane && state.chain_closed) return true;
    pause(kPoll);
  }
  return false;
}

/// From motors off to ready for the loop. False: to be begun again.
bool Keeper::prepare() {
  if (!wait_until_well()) return false;
  Failure failure = connection_.request_power();
  const std::int64_t until = rt::monotonic_ns() + kPowerWait;
  ArmState state;
  while (!failure && !interrupted()) {
    failure = connection_.hold(state);
    if (failure) break;
    if (!state.chain_closed || !is_sane(state)) return false;
    park(state);
    if (state.powered || rt::monotonic_ns() > until) break;
    pause(kPoll);
  }
  if (interrupted()) return false;
  if (!failure) failure = connection_.attach();
  if (failure) {
    tell({News::lost, failure, 0});
    why_.store(Why::lost, std::memory_order_relaxed);
    return false;
  }
  // Some arms report no power before the dead-man sensor is held: the loop goes on watching.
  if (state.powered) tell({News::powered, {}, 0});
  if (state.dead_man) tell({News::release_first, {}, 0});
  return true;
}

std::vector<std::string> Keeper::take_news() {
  std::vector<std::string> words;
  News news;
  while (news_.pop(news)) {
    std::string text = "virtuose " + connection_.settings().address + ": " + words_of(news);
    if (news.kind == News::opened) text += ", library " + library_name_;
    words.push_back(std::move(text));
  }
  return words;
}

}  // namespace tact::coupling::virtuose
