#include "service/service_main.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "fault/fault.hpp"
#include "link/participant.hpp"
#include "link/roudi.hpp"
#include "log/log.hpp"

namespace tact {

int service_main(const char* name, int argc, char** argv, const std::function<int(const ServiceOptions&)>& serve) {
  ServiceOptions options;
  CLI::App app{"A service of Tact. `tact run` starts it; by hand only to look for faults.", name};
  app.add_option("--session", options.session_file, "Session file written by `tact run`")->required();
  app.add_flag("--check", options.check_only, "Open and validate everything, serve nothing, leave");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitSetupError;
  }

  open_log(name);
  int code = kExitSetupError;
  try {
    code = serve(options);
  } catch (const SetupError& e) {
    log_error(e.what());
  } catch (const std::exception& e) {
    log_error("unexpected: ", e.what());
    code = kExitFault;
  }
  flush_log();
  const bool alone = leave_roudi();
  // Endpoints of a dead peer may hang when destroyed: leave without destructors.
  if (endpoints_abandoned() || alone) std::_Exit(code);
  return code;
}

}  // namespace tact
