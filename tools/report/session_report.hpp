#pragma once
#include <tact_msgs.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "math/pose.hpp"

namespace tact::report {

using Stats = tact_msgs_msg_dds__SessionStats_;
using DeviceState = tact_msgs_msg_dds__DeviceState_;
using Histogram = tact_msgs_msg_dds__Histogram_;

/// Microseconds; zero where nothing was counted. Right to the histogram's 9 %.
struct Percentiles {
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
};
Percentiles percentiles(const Histogram& histogram);

/// Coupling's statistics count since its process began: one record an epoch, the newest of each kept, all of them
/// merged: counts and energies add up, means are weighed by ticks, maxima are maxima.
class StatsByEpoch {
 public:
  void see(const Stats& stats) { newest_[stats.epoch] = stats; }
  bool empty() const { return newest_.empty(); }
  Stats total() const;

 private:
  std::map<std::uint64_t, Stats> newest_;
};

/// How near the tool's mesh frame came to the goal. The nearest pose is the one whose larger share of the two
/// tolerances is smallest; the goal is reached when that share is at most one.
class GoalWatch {
 public:
  GoalWatch(std::optional<Pose> goal_X_WM, double tolerance_mm, double tolerance_deg);
  void see(const Pose& X_WM);

  bool reached() const { return share_ <= 1; }
  std::optional<double> distance_mm() const { return distance_mm_; }  ///< empty: no goal, or no pose seen
  std::optional<double> angle_deg() const { return angle_deg_; }

 private:
  std::optional<Pose> goal_;
  double tolerance_mm_, tolerance_deg_;
  double share_;
  std::optional<double> distance_mm_, angle_deg_;
};

struct FaultEvent {
  double time_s;  ///< since the session began
  std::string name, detail;
};

/// Faults with their times. A bit that comes and goes is noted when it appears, at most once a second for each name;
/// the list is bounded, and says so when it is full.
class FaultLog {
 public:
  static constexpr std::size_t kCapacity = 500;

  void note(double time_s, const std::string& name, const std::string& detail);
  /// Fault bits a service reports as now set.
  void see(double time_s, const std::string& service, std::uint32_t bits);
  const std::vector<FaultEvent>& events() const { return events_; }

 private:
  std::vector<FaultEvent> events_;
  std::map<std::string, std::uint32_t> last_bits_;
  std::map<std::string, double> last_time_s_;
};

/// One row of the plot.
struct Sample {
  double time_s, force_n, penetration_voxels, tick_us;
  std::uint32_t contacts;
};

struct LoadedPart {
  std::string what;
  double seconds;
  std::uint64_t bytes;
};

struct ServiceUse {
  std::string name;
  double cpu_percent;  ///< of one core, over the service's life
  double memory_mb;    ///< resident
  int restarts;
};

/// What a session was and did.
struct SessionReport {
  std::string session, scene, script, law, device, mode, coupling, transport;
  double stiffness_n_per_m = 0, voxel_m = 0, rate_hz = 0, duration_s = 0;
  bool saturation = true, shared_memory_proven = false;
  Stats stats{};
  bool goal_reached = false;
  std::optional<double> goal_distance_mm, goal_angle_deg;
  std::vector<FaultEvent> faults;
  std::vector<LoadedPart> loaded;
  std::vector<std::string> notes;  ///< of the bake: what it refused, repaired or doubts
  std::vector<ServiceUse> services;
};

/// Keys: the table in README.md. Stable: keys may be added, none renamed or removed.
std::string to_json(const SessionReport& report);
std::string to_table(const SessionReport& report);

/// Four strips over time: force, penetration with the half-voxel line, contacts, tick time; drawn by gnuplot.
/// Throws SetupError when gnuplot is missing or the file cannot be written.
void write_plot(const std::string& title, const std::vector<Sample>& samples, const std::filesystem::path& png);

}  // namespace tact::report
