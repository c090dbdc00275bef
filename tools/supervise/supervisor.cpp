#include "supervise/supervisor.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>

#include "fault/fault.hpp"
#include "service/service_main.hpp"
#include "supervise/tcp_port.hpp"

namespace tact::supervise {
namespace {

using namespace std::chrono_literals;

constexpr auto kPoll = 20ms;
constexpr auto kGrace = 3s;            // from SIGTERM to SIGKILL: coupling calms its device first
constexpr auto kSilenceAtStart = 30s;  // without any progress a session that has not begun is given up
constexpr auto kRoudiLook = 250ms;
constexpr auto kAfterScript = 1s;

void require_writable(const char* key, const std::filesystem::path& path) {
  if (!path.empty() && !std::ofstream(path, std::ios::app)) {
    throw SetupError(std::string(key) + ": found \"" + path.string() +
                     "\", which cannot be written, expected a file in a folder that exists and is yours to write in");
  }
}

/// Ours to hold while the session lives; checked before anything is started.
Session prepared(Session session, const std::filesystem::path& run_dir) {
  session.run_dir = run_dir;
  if (session.machine.view) session.machine.port = usable_port(session.machine.bind, session.machine.port);
  return session;
}

}  // namespace

Supervisor::Supervisor(Session session)
    : run_dir_(session.name), session_(prepared(std::move(session), run_dir_.path())) {
  require_writable("run.report", session_.run.report);
  require_writable("run.plot", session_.run.plot);
  require_writable("run.record", session_.run.record);
  save_session(session_, run_dir_.path() / "session.toml");
  if (shm()) roudi_ = std::make_unique<RoudiLease>(share_dir() / "roudi.toml");
  monitor_ = std::make_unique<SessionMonitor>(session_);
  for (const char* name : {"contact", "coupling"}) services_.push_back(std::make_unique<Service>(name));
  if (session_.machine.view) services_.push_back(std::make_unique<Service>("view"));
}

Supervisor::~Supervisor() { stop_all(); }

std::string Supervisor::run() {
  last_progress_ = loading_since_ = Clock::now();
  for (const auto& s : services_) start(*s);
  while (!over()) {
    monitor_->poll(kPoll / 1ns);
    watch_services();
    watch_scene();
    watch_shared_memory();
    watch_beginning();
    measure();
    show();
  }
  const bool begun = monitor_->begun();
  measure();
  monitor_->end();
  stop_all();
  console_.clear_status();
  if (begun) write_report();
  return fatal_;
}

Supervisor::Service& Supervisor::service(const std::string& name) {
  for (const auto& s : services_) {
    if (s->name == name) return *s;
  }
  throw std::logic_error("no service " + name);
}

std::filesystem::path Supervisor::log_of(const Service& service) const {
  return run_dir_.path() / ("tact-" + service.name + ".log");
}

void Supervisor::start(Service& service) {
  service.start_at.reset();
  service.started = Clock::now();
  service.child = std::make_unique<ChildProcess>(
      libexec_dir() / ("tact-" + service.name),
      std::vector<std::string>{"--session", (run_dir_.path() / "session.toml").string()}, log_of(service));
}

void Supervisor::stop(Service& service) {
  service.start_at.reset();
  if (!service.child) return;
  service.child->signal(SIGTERM);
  const auto limit = Clock::now() + kGrace;
  while (!service.child->poll() && Clock::now() < limit) monitor_->poll(kPoll / 1ns);
  const Ending ending = service.child->finish(0ms);
  if (!ending.clean() && monitor_->begun()) {
    monitor_->faults().note(monitor_->elapsed_s(), "unclean_stop",
                            service.name + ": " + reason_of(ending, log_of(service)));
  }
  service.earlier_cpu_s += service.use.cpu_s;
  service.lived_s += std::chrono::duration<double>(Clock::now() - service.started).count();
  service.use.cpu_s = 0;
  service.child.reset();
}

void Supervisor::stop_all() {
  // In reverse: the view, then the device comes to rest, then the server it rests against.
  for (auto s = services_.rbegin(); s != services_.rend(); ++s) stop(**s);
}

void Supervisor::restart_shared_memory(const std::string& why) {
  note("shared_memory_restarted", why);
  if (!set_policy_.after_death(Clock::now())) {
    fatal_ = "shared memory had to be restarted too often: " + why + "; tact doctor looks for the cause";
    return;
  }
  Service &coupling = service("coupling"), &contact = service("contact");
  stop(coupling);
  stop(contact);
  roudi_->restart();
  for (Service* s : {&contact, &coupling}) {
    start(*s);
    ++s->restarts;
  }
  fresh_watch_.restarted();
}

void Supervisor::note(const std::string& name, const std::string& detail) {
  monitor_->faults().note(monitor_->elapsed_s(), name, detail);
  console_.line("! " + name + ": " + detail);
}

void Supervisor::watch_services() {
  for (const auto& s : services_) {
    if (!fatal_.empty()) return;
    if (s->child) {
      if (const auto& ending = s->child->poll()) died(*s, *ending);
    } else if (s->start_at && Clock::now() >= *s->start_at) {
      start(*s);
      ++s->restarts;
      note("service_restarted", s->name);
      if (s->name != "view") fresh_watch_.restarted();
    }
  }
}

void Supervisor::died(Service& service, Ending ending) {
  const std::string reason = reason_of(ending, log_of(service));
  service.earlier_cpu_s += service.use.cpu_s;
  service.lived_s += std::chrono::duration<double>(Clock::now() - service.started).count();
  service.use.cpu_s = 0;
  service.child.reset();
  if (!monitor_->begun() && ending.signal == 0 && ending.code == kExitSetupError) throw SetupError(reason);
  note("service_ended", service.name + ": " + reason);
  if (service.name != "view" && shm() && !roudi_->is_alive()) {
    restart_shared_memory("RouDi is gone, and " + service.name + " ended");
    return;
  }
  if (const auto delay = service.policy.after_death(Clock::now())) {
    service.start_at = Clock::now() + *delay;
  } else if (service.name == "view") {
    note("service_given_up", "view ended too often; the session goes on without it");
  } else {
    fatal_ = service.name + " ended too often: " + reason;
  }
}

bool Supervisor::up(const Service& service) const {
  const auto health = monitor_->alive(service.name);
  return health && service.child && health->pid == static_cast<std::uint32_t>(service.child->pid()) &&
         health->phase >= wire::kConnecting;
}

/// Other bodies under the same hand: coupling refuses them, and stays calm until a person restarts the session. So does
/// every coupling started again: the scene the session began with is kept in the run directory.
void Supervisor::watch_scene() {
  const auto coupling = monitor_->alive("coupling");
  const bool changed = coupling && (coupling->faults & bit(Fault::scene_changed)) != 0;
  if (changed && !scene_changed_) note(fault_names(bit(Fault::scene_changed)), coupling->detail);
  scene_changed_ = changed;
}

bool Supervisor::fresh() const {
  const auto coupling = monitor_->alive("coupling"), contact = monitor_->alive("contact");
  return coupling && contact && coupling->phase == wire::kActive && coupling->peer_epoch == contact->epoch &&
         (coupling->faults & bit(Fault::wrench_stale)) == 0;
}

void Supervisor::watch_shared_memory() {
  if (!shm() || !fatal_.empty()) return;
  const auto now = Clock::now();
  if (now >= next_roudi_look_) {
    next_roudi_look_ = now + kRoudiLook;
    const bool was_lost = roudi_watch_.lost();
    const bool in_contact = monitor_->device() && monitor_->device()->contact_count > 0;
    const bool restart = roudi_watch_.restart_now(now, roudi_->is_alive(), in_contact);
    if (!was_lost && roudi_watch_.lost())
      note(fault_names(bit(Fault::transport_degraded)), "RouDi is gone; the haptic pair goes on without it for now");
    if (restart) return restart_shared_memory("RouDi was gone");
  }
  // Refused, not stuck: new processes would refuse it again.
  if (fresh_watch_.stuck(now, up(service("contact")) && up(service("coupling")) && !scene_changed_, fresh())) {
    restart_shared_memory("no fresh wrench 2 s after a restart");
  }
}

void Supervisor::watch_beginning() {
  if (monitor_->begun()) return;
  const auto now = Clock::now();
  const auto contact = monitor_->alive("contact"), coupling = monitor_->alive("coupling");
  if (coupling && coupling->phase == wire::kActive && monitor_->scene() != nullptr) {
    monitor_->begin();
    announce();
    return;
  }
  if (contact && contact->phase == wire::kLoading) last_progress_ = now;
  if (now - last_progress_ < kSilenceAtStart) return;
  std::string said;
  for (const auto& s : services_) {
    const auto health = monitor_->latest(s->name);
    said += "; " + s->name + (health ? std::string(" says \"") + health->detail + "\"" : " is silent");
  }
  throw SetupError("the services found no contact with one another in 30 s" + said +
                   "; tact doctor looks for the cause");
}

void Supervisor::measure() {
  const auto now = Clock::now();
  if (now < next_measure_) return;
  next_measure_ = now + 1s;
  for (const auto& s : services_) {
    if (!s->child || s->child->poll()) continue;
    s->use = use_of(s->child->pid());
    s->peak_mb = std::max(s->peak_mb, s->use.resident_mb);
  }
}

bool Supervisor::over() {
  if (stop_signal_.requested() || !fatal_.empty()) return true;
  if (!monitor_->begun()) return false;
  if (session_.run.for_s > 0) return monitor_->elapsed_s() >= session_.run.for_s;
  const bool ends = scripted_hand(session_) || session_.machine.device == "playback";
  if (!ends || !monitor_->script_done()) return false;
  const auto now = Clock::now();
  if (!script_done_at_) script_done_at_ = now;
  if (now - *script_done_at_ < kAfterScript) return false;
  if (!session_.machine.view) return true;
  if (!script_reported_) {
    script_reported_ = true;
    console_.clear_status();
    write_report();
    console_.line("The script is done; the mouse in the browser moves the part now. Ctrl-C ends.");
  }
  return false;
}

}  // namespace tact::supervise
