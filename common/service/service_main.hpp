#pragma once
#include <filesystem>
#include <functional>

namespace tact {

struct ServiceOptions {
  std::filesystem::path session_file;  ///< written by `tact run`
  bool check_only = false;             ///< open and validate everything, move and serve nothing, then leave
};

/// Exit codes of every service. Supervisors decide by them: a set-up error is not worth a restart.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFault = 1;       ///< ended by a fault while running
inline constexpr int kExitSetupError = 2;  ///< could not be set up: the reason is the last line on stderr

/// The main of a service: parses `--session FILE [--check]`, names the log, runs `serve`, returns its exit code.
/// The one place where SetupError is caught; any other exception is reported as a defect of ours.
int service_main(const char* name, int argc, char** argv, const std::function<int(const ServiceOptions&)>& serve);

}  // namespace tact
