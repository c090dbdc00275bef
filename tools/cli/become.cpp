#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "cli/commands.hpp"
#include "fault/fault.hpp"

namespace tact::cli {

void become(const std::string& name, const std::vector<std::string>& arguments) {
  const auto program = libexec_dir() / name;
  if (!std::filesystem::exists(program)) {
    throw SetupError(
        program.string() +
        ": this build has no benchmarks: they need FCL and OpenVDB to compare with. Install libfcl-dev and "
        "libopenvdb-dev (tools/setup --tests) and build again");
  }
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  throw SetupError(program.string() + ": cannot start it: " + std::strerror(errno));
}

}  // namespace tact::cli
