#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "fault/fault.hpp"
#include "link/health.hpp"
#include "supervise/child_process.hpp"
#include "supervise/run_dir.hpp"

namespace tact::cli {
namespace {

using Json = nlohmann::ordered_json;

/// What the services of one session say of themselves within half a second: they speak ten times a second.
Json listen(const Session& session) {
  const Participant participant(wire::Channel::session, session);
  HealthMonitor health(participant);
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds{500};
  while (std::chrono::steady_clock::now() < until) health.poll(20'000'000);
  Json services = Json::array();
  for (const char* name : {"contact", "coupling", "view"}) {
    const auto h = health.alive(name);
    if (!h) continue;
    services.push_back({{"name", name},
                        {"pid", h->pid},
                        {"phase", phase_name(h->phase)},
                        {"transport", h->transport},
                        {"shared_memory_proven", h->shared_memory_proven},
                        {"faults", fault_names(h->faults)},
                        {"memory_mb", supervise::use_of(static_cast<pid_t>(h->pid)).resident_mb},
                        {"detail", h->detail}});
  }
  return services;
}

void print(const Json& session) {
  std::printf("%s: scene %s, law %s, %s %s\n", session["session"].get<std::string>().c_str(),
              session["scene"].get<std::string>().c_str(), session["law"].get<std::string>().c_str(),
              session["device"].get<std::string>().c_str(), session["mode"].get<std::string>().c_str());
  for (const Json& s : session["services"]) {
    std::printf("  %-9s pid %-7d %-10s %5.0f MB  faults: %s  %s\n", s["name"].get<std::string>().c_str(),
                s["pid"].get<int>(), s["phase"].get<std::string>().c_str(), s["memory_mb"].get<double>(),
                s["faults"].get<std::string>().c_str(), s["detail"].get<std::string>().c_str());
  }
  if (session["services"].empty()) std::printf("  no service answers\n");
}

}  // namespace

int status(bool json) {
  Json sessions = Json::array();
  for (const auto& dir : supervise::running_sessions()) {
    try {
      const Session session = load_session(dir / "session.toml");
      sessions.push_back({{"session", session.name},
                          {"run_dir", dir.string()},
                          {"scene", session.scene.name},
                          {"law", session.scene.contact.law},
                          {"device", session.machine.device},
                          {"mode", session.machine.mode},
                          {"services", listen(session)}});
    } catch (const SetupError&) {  // it ended while we looked
    }
  }
  if (json) {
    std::printf("%s\n", sessions.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    return 0;
  }
  for (const Json& session : sessions) print(session);
  if (sessions.empty())
    std::printf("No session of this user is running (looked in %s).\n", supervise::run_root().c_str());
  return 0;
}

}  // namespace tact::cli
