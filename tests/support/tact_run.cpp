#include "support/tact_run.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace tact::test {
namespace fs = std::filesystem;

namespace {
fs::path build_dir() { return fs::read_symlink("/proc/self/exe").parent_path().parent_path(); }
}  // namespace

fs::path TactRun::program() { return build_dir() / "bin" / "tact"; }

std::map<std::string, std::string> TactRun::environment() {
  return {{"TACT_CACHE", (build_dir() / "test-cache").string()}};
}

std::string TactRun::unique_name() {
  static int count = 0;
  std::string name = "t";
  return name.append(std::to_string(getpid())).append("-").append(std::to_string(++count));
}

std::vector<std::string> TactRun::command(std::vector<std::string> arguments) const {
  std::vector<std::string> words{program(), "run"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"--session", session_, "--report", scratch_.path() / "report.json"});
  return words;
}

TactRun::TactRun(std::vector<std::string> arguments)
    : process_(command(std::move(arguments)), scratch_.path() / "output.txt", [this] {
        auto variables = environment();
        variables["XDG_RUNTIME_DIR"] = scratch_.path();
        return variables;
      }()) {}

int TactRun::wait(std::chrono::seconds limit) {
  const auto code = process_.wait(limit);
  EXPECT_TRUE(code.has_value()) << "tact run did not end\n" << output();
  return code.value_or(-1);
}

int TactRun::stop() {
  process_.signal(SIGINT);
  return wait(std::chrono::seconds{30});
}

nlohmann::json TactRun::report() const {
  std::ifstream in(scratch_.path() / "report.json");
  EXPECT_TRUE(in.good()) << "no report was written\n" << output();
  return in ? nlohmann::json::parse(in, nullptr, false) : nlohmann::json{};
}

bool TactRun::reported(const std::string& fault) const {
  const auto all = report();
  const auto faults = all.value("faults", nlohmann::json::array());
  return std::any_of(faults.begin(), faults.end(),
                     [&](const auto& one) { return one["name"].template get<std::string>() == fault; });
}

}  // namespace tact::test
