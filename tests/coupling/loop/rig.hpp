#pragma once
#include <functional>
#include <memory>

#include "coupling/device/simulated_device.hpp"
#include "coupling/loop/coupling_loop.hpp"
#include "loop/half_space.hpp"

namespace tact::coupling {

/// The whole coupling in one thread on a fake clock: simulated device, loop, half-space.
struct Rig {
  struct Options {
    DeviceMode mode = DeviceMode::pseudo_admittance;
    double rate_hz = 1000;
    Vec3 start{0, 0, 0.01};
    HandMotion motion;
    double k = 10000, b = 0;  // of the wall
    int delay = 0;
    LoopParameters parameters;
    std::function<void(SimulatedDevice::Params&)> device;  // more of it
    TickQueue* records = nullptr;
    WorkspaceMapping::Params mapping;
    bool rotation_locked = false;
  };

  static LoopConfig config_of(const Options& o) {
    LoopConfig config;
    config.rate_hz = o.rate_hz;
    config.tool.rotation_locked = o.rotation_locked;
    config.reply_wait_share = 0;  // the server answers after the step, in the same thread
    config.mapping = o.mapping;
    config.tool.inertia_shape_m2 = Vec3(4e-4, 5e-4, 8e-4).asDiagonal();
    config.parameters = o.parameters;
    config.X_WT_start.p = o.start;
    config.gyration_radius_m = 0.025;
    config.tool_radius_m = 0.03;
    config.voxel_m = 1e-3;
    config.status_period_s = 0;  // each tick
    return config;
  }
  static SimulatedDevice::Params device_of(const Options& o) {
    SimulatedDevice::Params params;
    params.mode = o.mode;
    params.rate_hz = o.rate_hz;
    params.virtual_inertia_kg_m2 = 0.2 * 4e-4;
    if (o.device) o.device(params);
    return params;
  }

  static Pose to_device(const Options& o, const Pose& X_W) {
    return WorkspaceMapping(o.mapping, Pose{o.start, Quat::Identity()}).to_device(X_W);
  }
  static HandMotion motion_of_handle(const Options& o) {
    HandMotion motion = o.motion;
    for (Pose& X : motion.X_WM) X = to_device(o, X);
    return motion;
  }

  explicit Rig(const Options& o)
      : options(o),
        device(device_of(o), motion_of_handle(o), to_device(o, Pose{o.start, Quat::Identity()})),
        loop(config_of(o), device, *mail, o.records) {
    wall.k = o.k / 4;
    wall.x_max = 10.0 / o.k;
    wall.delay = o.delay;
    wall.b = o.b / 4;
  }

  void tick(std::uint64_t skipped = 0) {
    const auto period = static_cast<std::int64_t>(1e9 / options.rate_hz);
    now += period;
    loop.step({index++, now, now, period, skipped});
    wall.serve(*mail);
    mail->status.read(status);
  }
  void run(double seconds) {
    for (auto n = static_cast<int>(seconds * options.rate_hz); n > 0; --n) tick();
  }

  Options options;
  std::unique_ptr<Mailboxes> mail = std::make_unique<Mailboxes>();
  HalfSpace wall;
  SimulatedDevice device;
  CouplingLoop loop;
  LoopStatus status;
  std::uint64_t index = 0;
  std::int64_t now = rt::monotonic_ns();
};

/// From `start` straight to `end`, then hold.
inline HandMotion straight(const Vec3& start, const Vec3& end, double seconds) {
  return {{0, seconds}, {Pose{start, Quat::Identity()}, Pose{end, Quat::Identity()}}};
}

}  // namespace tact::coupling
