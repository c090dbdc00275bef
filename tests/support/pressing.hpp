#pragma once
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "support/observer.hpp"
#include "support/tact_run.hpp"

namespace tact::test {

/// A session whose simulated hand presses the peg against the wall and stays.
class Pressing {
 public:
  explicit Pressing(std::vector<std::string> more = {}) : run(arguments(std::move(more))), observer(run.session()) {}

  bool settled() {
    return eventually([&] { return observer.active() && observer.in_steady_contact(); }, std::chrono::seconds{120});
  }
  pid_t pid(const std::string& service) {
    const auto health = observer.health(service);
    return health ? static_cast<pid_t>(health->pid) : -1;
  }
  /// Where the view listens; 0: nowhere.
  unsigned short view_port() {
    const auto file = run.run_dir() / "view_url";
    if (!eventually([&] { return std::filesystem::exists(file); })) return 0;
    std::string url;
    std::ifstream(file) >> url;
    return static_cast<unsigned short>(std::stoi(url.substr(url.rfind(':') + 1)));
  }

  TactRun run;
  Observer observer;

 private:
  static std::vector<std::string> arguments(std::vector<std::string> more) {
    std::vector<std::string> words{"peg", "--script", "press", "--for", "300s"};
    if (std::find(more.begin(), more.end(), "--view") == more.end()) more.insert(more.end(), {"--view", "off"});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

}  // namespace tact::test
