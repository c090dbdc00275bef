// What `tact doctor` looks at. Each check says what it found and what to do; only what keeps a session from running at
// all fails, what makes it late or slow warns.
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vector>

#include "cli/commands.hpp"
#include "coupling/device/virtuose/virtuose_library.hpp"
#include "fault/fault.hpp"
#include "link/participant.hpp"
#include "link/roudi_probe.hpp"
#include "rt/realtime.hpp"

namespace tact::cli {
namespace {

enum class Level { ok, warn, fail };
const char* name_of(Level level) { return level == Level::ok ? "ok" : level == Level::warn ? "warn" : "fail"; }

struct Finding {
  std::string check;
  Level level;
  std::string found, advice;  ///< advice: empty when ok
};

constexpr const char* kRtSetup =
    "run deploy/realtime/rt_setup.sh (installed: share/tact/realtime) as root and log in again, or run as root";

std::string first_line(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
  std::string folder;
  while (std::getline(folders, folder, ':')) {
    const std::string candidate = folder + "/" + name;
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

Finding realtime_priority() {
  int error = 0;
  std::thread attempt([&error] {
    sched_param parameter{};
    parameter.sched_priority = 80;
    error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameter);
  });
  attempt.join();
  if (error == 0) return {"real-time priority", Level::ok, "SCHED_FIFO 80 allowed", ""};
  return {"real-time priority", Level::warn, std::string("SCHED_FIFO 80 refused: ") + std::strerror(error),
          std::string("ticks will be late under load: ") + kRtSetup};
}

Finding locked_memory() {
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  const std::string missing = rt::lock_memory();
  ::munlockall();
  if (missing.empty()) return {"locked memory", Level::ok, "mlockall allowed", ""};
  return {"locked memory", Level::warn, missing, kRtSetup};
}

Finding shared_memory() {
  constexpr double kNeeded_mb = 80;  // RouDi: 66 MB of management data, the pools, and some air
  struct statvfs info {};
  if (::statvfs("/dev/shm", &info) != 0) {
    return {"shared memory", Level::fail, std::string("/dev/shm: ") + std::strerror(errno),
            "mount a tmpfs on /dev/shm, or run with --transport udp"};
  }
  const double unit_mb = static_cast<double>(info.f_frsize) / 1e6;
  const double total_mb = static_cast<double>(info.f_blocks) * unit_mb,
               free_mb = static_cast<double>(info.f_bavail) * unit_mb;
  char found[96];
  std::snprintf(found, sizeof found, "/dev/shm: %.0f MB, %.0f MB free; %.0f MB needed", total_mb, free_mb, kNeeded_mb);
  const bool in_use = probe_roudi(std::chrono::milliseconds{0}) == RoudiState::reachable;
  if (free_mb >= kNeeded_mb || in_use) return {"shared memory", Level::ok, found, ""};
  return {"shared memory", Level::fail, found,
          "mount -o remount,size=128m /dev/shm (docker: --shm-size=128m), or run with --transport udp"};
}

Finding roudi() {
  const std::string program = find_program("iox-roudi");
  if (program.empty()) {
    return {"RouDi", Level::fail, "no iox-roudi in PATH", "apt-get install iceoryx, or run with --transport udp"};
  }
  switch (probe_roudi(std::chrono::milliseconds{500})) {
    case RoudiState::reachable:
      return {"RouDi", Level::ok, "running and reachable", ""};
    case RoudiState::absent:
      return {"RouDi", Level::ok, program + "; not running: the first session starts it", ""};
    case RoudiState::hung:
      return {"RouDi", Level::warn, "running, but reads no messages",
              "end the sessions that run, then iox-roudi itself"};
    case RoudiState::forbidden:
      return {"RouDi", Level::fail, std::string(kRoudiSocket) + " belongs to another user",
              "join that user's sessions' primary group (systemd units: tact), or end them"};
  }
  return {"RouDi", Level::fail, "unknown state", ""};
}

Finding dds() {
  try {
    Session session;
    session.name = "doctor-" + std::to_string(::getpid());
    session.machine.transport = "udp";
    const Participant participant(wire::Channel::session, session);
    std::string found = "a participant on the loopback interface works";
    if (const char* uri = std::getenv("CYCLONEDDS_URI"); uri != nullptr && *uri != '\0') {
      return {
          "DDS", Level::warn, found + "; CYCLONEDDS_URI is set",
          "Tact brings its own profiles (share/tact/dds); unset CYCLONEDDS_URI if services do not find one another"};
    }
    return {"DDS", Level::ok, found, ""};
  } catch (const SetupError& e) {
    return {"DDS", Level::fail, e.what(), "ip link set lo up; reinstall Tact if its profiles are missing"};
  }
}

Finding dma_latency() {
  const rt::CpuDmaLatency held;
  if (held.missing().empty()) return {"CPU idle states", Level::ok, "/dev/cpu_dma_latency can be held at 0", ""};
  return {"CPU idle states", Level::warn, held.missing(), kRtSetup};
}

Finding cpu_features() {
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2"), fma = __builtin_cpu_supports("fma");
  if (avx2 && fma) return {"CPU features", Level::ok, "AVX2 and FMA", ""};
  return {"CPU features", Level::warn, std::string(avx2 ? "" : "no AVX2 ") + (fma ? "" : "no FMA"),
          "everything works, the contact computation takes several times as long"};
}

Finding cpu_count() {
  const auto n = std::thread::hardware_concurrency();
  const std::string found = std::to_string(n) + (n == 1 ? " CPU" : " CPUs");
  if (n >= 2) return {"CPUs", Level::ok, found, ""};
  return {"CPUs", Level::warn, found,
          "coupling and contact server want a CPU each: on one, every wrench is late by the other's work"};
}

Finding realtime_throttling() {
  const std::string runtime = first_line("/proc/sys/kernel/sched_rt_runtime_us");
  const std::string period = first_line("/proc/sys/kernel/sched_rt_period_us");
  if (runtime.empty()) return {"real-time throttling", Level::ok, "not used by this kernel", ""};
  const std::string found = "sched_rt_runtime_us = " + runtime + " of " + period;
  if (runtime == "-1" || std::atol(runtime.c_str()) * 2 >= std::atol(period.c_str())) {
    return {"real-time throttling", Level::ok, found + ": more than our threads use, they sleep every tick", ""};
  }
  return {"real-time throttling", Level::warn, found,
          "above that share real-time threads stand still for the rest of a period, ticks are missed: sysctl "
          "kernel.sched_rt_runtime_us=950000"};
}

Finding clock_source() {
  const std::string source = first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (source.empty()) return {"clock", Level::ok, "not told by this kernel", ""};
  if (source == "tsc" || source == "kvm-clock" || source == "hyperv_clocksource_tsc_page") {
    return {"clock", Level::ok, source + ": read without a system call", ""};
  }
  return {"clock", Level::warn, source,
          "each look at the time is a system call of up to microseconds, several a tick: boot with clocksource=tsc if "
          "the machine's is sound (dmesg | grep -i tsc)"};
}

Finding cpu_governor() {
  const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (governor.empty()) return {"CPU frequency", Level::ok, "not ours to scale here", ""};
  if (governor == "performance") return {"CPU frequency", Level::ok, "governor performance", ""};
  return {"CPU frequency", Level::warn, "governor " + governor,
          "between ticks the clock falls, a tick takes up to several times as long: cpupower frequency-set -g "
          "performance"};
}

Finding kernel() {
  utsname name{};
  ::uname(&name);
  const std::string version = name.version;
  std::string model = version.find("PREEMPT_RT") != std::string::npos        ? "PREEMPT_RT"
                      : version.find("PREEMPT_DYNAMIC") != std::string::npos ? "PREEMPT_DYNAMIC"
                      : version.find("PREEMPT") != std::string::npos         ? "PREEMPT"
                                                                             : "no preemption";
  const std::string found = std::string(name.release) + ", " + model;
  if (model == "PREEMPT_RT") return {"kernel", Level::ok, found, ""};
  return {"kernel", Level::warn, found,
          "fine for a simulated device; for a real one install linux-image-rt-amd64: outliers of milliseconds go away"};
}

/// What the machine file names can be loaded. Whether the arm answers only a session asks: it takes one client.
Finding haptic_device(const std::filesystem::path& machine_file) {
  Session session;
  try {
    load_machine_file(machine_file, session);
    const MachineSpec& machine = session.machine;
    if (machine.device != "virtuose") return {"haptic device", Level::ok, machine.device, ""};
    const std::string library = coupling::virtuose::load_library(machine.virtuose.library).name;
    return {"haptic device", Level::ok, "virtuose, library " + library + " loads and has all calls", ""};
  } catch (const SetupError& e) {
    return {"haptic device", Level::fail, e.what(), "mend the machine file; --device simulated needs no arm"};
  }
}

std::vector<Finding> look(const std::filesystem::path& machine_file) {
  return {cpu_count(),
          cpu_features(),
          kernel(),
          realtime_priority(),
          locked_memory(),
          realtime_throttling(),
          dma_latency(),
          cpu_governor(),
          clock_source(),
          shared_memory(),
          roudi(),
          dds(),
          haptic_device(machine_file)};
}

}  // namespace

int doctor(const std::filesystem::path& machine_file, bool json) {
  const auto findings = look(machine_file);
  bool failed = false;
  auto list = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    failed |= f.level == Level::fail;
    list.push_back({{"check", f.check}, {"level", name_of(f.level)}, {"found", f.found}, {"advice", f.advice}});
    if (json) continue;
    std::printf("%-5s %-22s %s\n", name_of(f.level), f.check.c_str(), f.found.c_str());
    if (!f.advice.empty()) std::printf("%-5s %-22s -> %s\n", "", "", f.advice.c_str());
  }
  if (json) std::printf("%s\n", list.dump(2).c_str());
  return failed ? 1 : 0;
}

}  // namespace tact::cli
