#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/run_options.hpp"

namespace tact::cli {

/// The subcommands of `tact`. Each returns the exit code; each throws SetupError for what a user can mend.
int run(const RunOptions& options);
int bake(const RunOptions& options, bool json);
int scenes(bool json);
int status(bool json);
/// `machine_file`: empty: this machine's, or none.
int doctor(const std::filesystem::path& machine_file, bool json);
/// Exit code 0: the same, 1: it differs. `factor` on the tolerances.
int replay(const std::filesystem::path& recording, double factor, bool json);
/// `png` empty: beside the recording, or no picture when there is a CSV.
int plot(const std::filesystem::path& recording, std::filesystem::path png, const std::filesystem::path& csv);
struct LatencyOptions {
  double rate_hz = 1000, seconds = 5, compute_us = 200;
  int cpu = -1;
  bool json = false, against_cyclictest = false;
};
/// Exit code 3 when the bar against cyclictest is missed.
int latency(const LatencyOptions& options);
/// The session in lockstep, on a clock that counts ticks.
struct ExperimentOptions {
  int delay_ticks = 0;        ///< of every reply, beyond the one tick it takes
  std::string replies;        ///< 1 arrives, 0 is lost; repeated
  std::filesystem::path csv;  ///< every tick; empty: none
  bool json = false;
};
int experiment(const RunOptions& options, const ExperimentOptions& more);
/// Becomes a program that only some builds have: tact-bench, tact-report. Throws SetupError when this one has not.
[[noreturn]] void become(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace tact::cli
