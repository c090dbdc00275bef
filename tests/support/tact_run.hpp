#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.hpp"

namespace tact::test {

/// `tact run` as a user starts it, on real processes. Bakes are shared between tests through one cache.
class TactRun {
 public:
  explicit TactRun(std::vector<std::string> arguments);

  Process& process() { return process_; }
  /// Waits for the end; fails the test when it does not end. Returns the exit code.
  int wait(std::chrono::seconds limit = std::chrono::seconds{180});
  /// SIGINT, as Ctrl-C, then wait().
  int stop();
  std::string output() const { return process_.output(); }
  nlohmann::json report() const;
  /// Its faults[] have one of that name.
  bool reported(const std::string& fault) const;
  const std::string& session() const { return session_; }
  /// Where the session keeps its files while it runs.
  std::filesystem::path run_dir() const { return scratch_.path() / "tact" / session_; }

  /// The tact program, and where services are.
  static std::filesystem::path program();
  static std::map<std::string, std::string> environment();

 private:
  static std::string unique_name();
  std::vector<std::string> command(std::vector<std::string> arguments) const;

  ScratchDir scratch_;
  std::string session_ = unique_name();
  Process process_;
};

}  // namespace tact::test
