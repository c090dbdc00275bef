// A library with the C interface of Haption's VirtuoseAPI 4.x, for tests: plain names, no SONAME, everything else
// hidden. It enforces the rules its documentation states, and what they suggest where it is silent, and drives an arm
// in a process of its own (arm_program.cpp). Written for Tact; nothing of the vendor's is in it.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "virtuose/arm_wire.hpp"

#define EXPORT extern "C" __attribute__((visibility("default")))

namespace {

using namespace tact::standin;

enum Error {
  kNone = 0,
  kCommunication = 2,
  kInvalidContext = 3,
  kWrongFormat = 5,
  kTimeOut = 6,
  kIncorrectValue = 9,
  kDiscontinuity = 12,
  kWrongMode = 17,
  kCallTime = 19,
  kAlready = 22
};
constexpr int kTypeNone = 0, kTypeImpedance = 3, kTypeVirtmech = 5;
constexpr double kLeap_m = 0.05, kLeap_rad = 0.5;  // of a set-point, from one call to the next

struct Context {
  std::uint32_t magic = kMagic, session = 0;
  int socket = -1, error = kNone, type = -1;
  float timeout_s = 0.1F;
  float force_factor = 1, speed_factor = 1, time_step = 0;
  int indexing = 0;
  bool positioned = false, attached = false, cut = false;
  float set_point[7] = {};
  State state;
  std::int64_t received_ns = 0;
};

int g_error = kNone;  // of a null context

std::int64_t now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

Context* valid(void* handle) {
  auto* c = static_cast<Context*>(handle);
  if (c == nullptr || c->magic != kMagic) {
    g_error = kInvalidContext;
    return nullptr;
  }
  return c;
}

int fail(Context* c, int error) {
  c->error = error;
  return -1;
}

bool send(Context* c, Order order, const char* call, const float* values = nullptr, int count = 0, int number = 0) {
  Command command;
  command.session = c->session;
  command.order = order;
  command.number = number;
  for (int i = 0; i < count; ++i) command.values[i] = values[i];
  std::strncpy(command.call, call, sizeof command.call - 1);
  return ::send(c->socket, &command, sizeof command, MSG_DONTWAIT | MSG_NOSIGNAL) == sizeof command;
}

void drain(Context* c) {
  State state;
  while (::recv(c->socket, &state, sizeof state, MSG_DONTWAIT) == sizeof state) {
    if (state.magic != kMagic || state.session != c->session) continue;
    c->state = state;
    c->received_ns = now_ns();
    if (state.link != Link::up) c->cut = true;
  }
}

void wait_for_state(Context* c, double seconds) {
  const std::int64_t until = now_ns() + static_cast<std::int64_t>(seconds * 1e9);
  const std::int64_t before = c->received_ns;
  for (std::int64_t left; c->received_ns == before && !c->cut && (left = until - now_ns()) > 0;) {
    pollfd waiting{c->socket, POLLIN, 0};
    const timespec limit{left / 1'000'000'000, left % 1'000'000'000};
    if (::ppoll(&waiting, 1, &limit, nullptr) < 0) break;
    drain(c);
    if ((waiting.revents & POLLERR) != 0) {  // nobody there: as silent as an arm that is off
      int pending = 0;
      socklen_t size = sizeof pending;
      ::getsockopt(c->socket, SOL_SOCKET, SO_ERROR, &pending, &size);
      const timespec pause{0, 1'000'000};
      ::nanosleep(&pause, nullptr);
    }
  }
}

/// Newest state, no older than the timeout; waits for one at most that long.
int refresh(Context* c) {
  drain(c);
  if (c->cut) return fail(c, kCommunication);
  const double age = static_cast<double>(now_ns() - c->received_ns) * 1e-9;
  if (age <= static_cast<double>(c->timeout_s)) return 0;
  wait_for_state(c, static_cast<double>(c->timeout_s));
  if (c->cut) return fail(c, kCommunication);
  return static_cast<double>(now_ns() - c->received_ns) * 1e-9 > 2 * static_cast<double>(c->timeout_s)
             ? fail(c, kTimeOut)
             : 0;
}

bool finite(const float* v, int n) {
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(v[i])) return false;
  }
  return true;
}

bool is_pose(const float* v) {
  const float norm = std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
  return finite(v, 7) && std::abs(norm - 1) < 1e-3F;
}

bool is_leap(const float* a, const float* b) {
  const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  const double dot = std::abs(static_cast<double>(a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6]));
  return std::sqrt(dx * dx + dy * dy + dz * dz) > kLeap_m || 2 * std::acos(std::min(1.0, dot)) > kLeap_rad;
}

/// A setting that must come before the command type.
int set_early(void* handle, float value, float most, float Context::*member, const char* call) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  send(c, Order::note, call);
  if (c->type != -1) return fail(c, kCallTime);
  if (!(value > 0 && value <= most)) return fail(c, kIncorrectValue);
  c->*member = value;
  return 0;
}

int set_frame(void* handle, const float* frame, const char* call) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  send(c, Order::note, call);
  return is_pose(frame) ? 0 : fail(c, kIncorrectValue);
}

template <class T>
int get_number(void* handle, std::int32_t State::*member, T* out) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (refresh(c) != 0) return -1;
  *out = static_cast<T>(c->state.*member);
  return 0;
}

template <std::size_t N>
int get_floats(void* handle, float (State::*member)[N], float* out) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (refresh(c) != 0) return -1;
  std::memcpy(out, c->state.*member, sizeof(float) * N);
  return 0;
}

}  // namespace

EXPORT void* virtOpen(const char* name) {
  const char* hash = name != nullptr ? std::strchr(name, '#') : nullptr;
  const int port = hash != nullptr ? std::atoi(hash + 1) : 0;
  char host[64] = {};
  if (hash == nullptr || port <= 0 || port > 65535 || hash - name >= static_cast<std::ptrdiff_t>(sizeof host)) {
    g_error = kWrongFormat;
    return nullptr;
  }
  std::memcpy(host, name, static_cast<std::size_t>(hash - name));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (std::strcmp(host, "localhost") == 0) std::strcpy(host, "127.0.0.1");
  if (::inet_pton(AF_INET, host, &address.sin_addr) != 1) {
    g_error = kWrongFormat;
    return nullptr;
  }
  auto* c = new Context;
  c->session = static_cast<std::uint32_t>(now_ns()) ^ static_cast<std::uint32_t>(::getpid());
  c->socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  bool answered = c->socket >= 0 && ::connect(c->socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  if (answered) {
    send(c, Order::hello, "virtOpen");
    wait_for_state(c, 0.3);
    answered = c->received_ns != 0 && !c->cut;
  }
  if (!answered) {
    g_error = c->cut ? kCommunication : kTimeOut;
    if (c->socket >= 0) ::close(c->socket);
    delete c;
    return nullptr;
  }
  return c;
}

EXPORT int virtClose(void* handle) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  send(c, Order::bye, "virtClose");
  ::close(c->socket);
  c->magic = 0;
  delete c;
  return 0;
}

EXPORT int virtGetErrorCode(void* handle) {
  if (handle == nullptr) return g_error;
  Context* c = valid(handle);
  return c != nullptr ? c->error : g_error;
}

EXPORT int virtAPIVersion(int* major, int* minor) {
  *major = 4;
  *minor = 0;
  return 0;
}

EXPORT int virtGetDeviceID(void* handle, int* type, int* serial) {
  if (valid(handle) == nullptr) return -1;
  *type = 3;
  *serial = 42;
  return 0;
}

EXPORT int virtSetTimeoutValue(void* handle, float seconds) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  send(c, Order::note, "virtSetTimeoutValue");
  if (!(seconds > 0)) return fail(c, kIncorrectValue);
  c->timeout_s = seconds;
  return 0;
}

EXPORT int virtSetIndexingMode(void* handle, int mode) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (mode < 0 || mode > 7 || mode == 5) return fail(c, kIncorrectValue);
  c->indexing = mode;
  send(c, Order::indexing, "virtSetIndexingMode", nullptr, 0, mode);
  return 0;
}

EXPORT int virtSetForceFactor(void* handle, float factor) {
  return set_early(handle, factor, 100, &Context::force_factor, "virtSetForceFactor");
}
EXPORT int virtSetSpeedFactor(void* handle, float factor) {
  return set_early(handle, factor, 100, &Context::speed_factor, "virtSetSpeedFactor");
}
EXPORT int virtSetTimeStep(void* handle, float seconds) {
  return set_early(handle, seconds, 0.1F, &Context::time_step, "virtSetTimeStep");
}
EXPORT int virtSetBaseFrame(void* handle, float* frame) { return set_frame(handle, frame, "virtSetBaseFrame"); }
EXPORT int virtSetObservationFrame(void* handle, float* frame) {
  return set_frame(handle, frame, "virtSetObservationFrame");
}

EXPORT int virtSetCommandType(void* handle, int type) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (type != kTypeNone && type != kTypeImpedance && type != kTypeVirtmech) return fail(c, kIncorrectValue);
  if (c->time_step == 0) return fail(c, kCallTime);
  c->type = type;
  send(c, Order::command_type, "virtSetCommandType", nullptr, 0, type);
  return 0;
}

EXPORT int virtSaturateTorque(void* handle, float force, float torque) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (!(force > 0 && torque > 0)) return fail(c, kIncorrectValue);
  const float limits[2] = {force, torque};
  send(c, Order::saturate, "virtSaturateTorque", limits, 2);
  return 0;
}

EXPORT int virtEnableForceFeedback(void* handle, int) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  send(c, Order::note, "virtEnableForceFeedback");
  return 0;
}

EXPORT int virtSetPowerOn(void* handle, int on) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->type == -1) return fail(c, kCallTime);
  send(c, Order::power, "virtSetPowerOn", nullptr, 0, on);
  return 0;
}

EXPORT int virtGetPowerOn(void* handle, int* on) { return get_number(handle, &State::power, on); }
EXPORT int virtGetDeadMan(void* handle, int* held) { return get_number(handle, &State::dead_man, held); }
EXPORT int virtGetEmergencyStop(void* handle, int* closed) { return get_number(handle, &State::chain, closed); }
EXPORT int virtIsInShiftPosition(void* handle, int* shift) { return get_number(handle, &State::shift, shift); }
EXPORT int virtGetAlarm(void* handle, unsigned* alarm) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (refresh(c) != 0) return -1;
  *alarm = c->state.alarm;
  return 0;
}
EXPORT int virtGetPosition(void* handle, float* pose) { return get_floats(handle, &State::pose, pose); }
EXPORT int virtGetSpeed(void* handle, float* twist) { return get_floats(handle, &State::twist, twist); }
EXPORT int virtGetForce(void* handle, float* wrench) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->type != kTypeVirtmech) return fail(c, kWrongMode);
  return get_floats(handle, &State::force, wrench);
}

EXPORT int virtSetForce(void* handle, float* wrench) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->cut) return fail(c, kCommunication);
  if (c->type != kTypeImpedance) return fail(c, kWrongMode);
  if (!finite(wrench, 6)) return fail(c, kIncorrectValue);
  send(c, Order::force, "virtSetForce", wrench, 6);
  return 0;
}

EXPORT int virtSetPosition(void* handle, float* pose) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->cut) return fail(c, kCommunication);
  if (c->type != kTypeVirtmech) return fail(c, kWrongMode);
  if (!is_pose(pose)) return fail(c, kIncorrectValue);
  if (is_leap(pose, c->positioned ? c->set_point : c->state.pose)) return fail(c, kDiscontinuity);
  std::memcpy(c->set_point, pose, sizeof c->set_point);
  c->positioned = true;
  send(c, Order::position, "virtSetPosition", pose, 7);
  return 0;
}

EXPORT int virtSetSpeed(void* handle, float* twist) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->cut) return fail(c, kCommunication);
  if (c->type != kTypeVirtmech) return fail(c, kWrongMode);
  if (!finite(twist, 6)) return fail(c, kIncorrectValue);
  send(c, Order::speed, "virtSetSpeed", twist, 6);
  return 0;
}

EXPORT int virtAttachQSVO(void* handle, float* stiffness, float* damping) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->type != kTypeVirtmech) return fail(c, kWrongMode);
  if (!c->positioned) return fail(c, kCallTime);
  if (c->attached) return fail(c, kAlready);
  float gains[12];
  for (int i = 0; i < 6; ++i) {
    if (!(stiffness[i] > 0 && stiffness[i] < 1e5F && damping[i] >= 0 && damping[i] < 1e4F)) {
      return fail(c, kIncorrectValue);
    }
    gains[i] = stiffness[i];
    gains[i + 6] = damping[i];
  }
  c->attached = true;
  send(c, Order::attach, "virtAttachQSVO", gains, 12);
  return 0;
}

#ifndef STAND_IN_INCOMPLETE
EXPORT int virtDetachVO(void* handle) {
  Context* c = valid(handle);
  if (c == nullptr) return -1;
  if (c->type != kTypeVirtmech) return fail(c, kWrongMode);
  if (!c->attached) return fail(c, kCallTime);
  c->attached = false;
  c->positioned = false;
  send(c, Order::detach, "virtDetachVO");
  return 0;
}
#endif
