#include <cstdio>

#include "cli/commands.hpp"
#include "supervise/supervisor.hpp"

namespace tact::cli {

int run(const RunOptions& options) {
  Session session = resolve(options);
  if (!options.write_session.empty()) {
    session.run_dir = "/run/tact/" + session.name;
    save_session(session, options.write_session);
    std::printf("Session %s written to %s\n", session.name.c_str(), options.write_session.c_str());
    return 0;
  }
  supervise::Supervisor supervisor(std::move(session));
  const std::string fault = supervisor.run();
  if (fault.empty()) return 0;
  std::fprintf(stderr, "tact: %s\n", fault.c_str());
  return 1;
}

}  // namespace tact::cli
