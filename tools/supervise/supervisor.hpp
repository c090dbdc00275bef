#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "link/roudi.hpp"
#include "service/stop_signal.hpp"
#include "session/session.hpp"
#include "supervise/child_process.hpp"
#include "supervise/console.hpp"
#include "supervise/policy.hpp"
#include "supervise/run_dir.hpp"
#include "supervise/session_monitor.hpp"

namespace tact::supervise {

/// Runs one session: holds a share of RouDi, starts tact-contact, tact-coupling and tact-view, follows their health,
/// restarts what dies, reports, and leaves nothing behind.
///
///   contact or coupling dies   restarted: its successor uses topic names of its own
///   ... and no fresh wrench    in 2 s: RouDi and both restarted together (a killed process can leave queues locked)
///   RouDi dies                 pairs go on: degraded; all restarted together when out of contact, or after 10 s
///   other bodies are served    coupling refuses them and is left alone; restarted for other reasons, it refuses again
///   view dies                  restarted; nobody waits for it
///   too many deaths            contact, coupling: the session ends with a fault; view: it goes on without
class Supervisor {
 public:
  /// Throws SetupError when the session cannot begin: name taken, port taken, no shared memory, report not writable.
  explicit Supervisor(Session session);
  ~Supervisor();

  /// Until the session ends. Returns the fault that ended it, empty when it ended as wished. Throws SetupError when a
  /// service could not be set up.
  std::string run();

 private:
  struct Service {
    explicit Service(std::string service_name) : name(std::move(service_name)) {}
    std::string name;  ///< "contact": program tact-contact
    std::unique_ptr<ChildProcess> child;
    RestartPolicy policy;
    std::optional<Time> start_at;  ///< set: dead, to be started then
    int restarts = 0;
    ProcessUse use;            ///< of the running child, last seen
    double peak_mb = 0;        ///< resident, of any of them
    double earlier_cpu_s = 0;  ///< of its predecessors
    double lived_s = 0;
    Time started{};
  };

  void start(Service& service);
  void stop(Service& service);
  void stop_all();
  /// RouDi and both haptic services, together: old and new clients of shared memory would match and exchange nothing.
  void restart_shared_memory(const std::string& why);

  void watch_services();
  void died(Service& service, Ending ending);
  void watch_scene();
  void watch_shared_memory();
  void watch_beginning();
  void measure();
  bool over();
  void show();
  std::string status_line() const;
  void announce();
  void write_report();
  void keep_flight_records();  ///< of coupling's last seconds before a fault: beside the report
  void note(const std::string& name, const std::string& detail);  ///< a fault: on the terminal and in the report

  Service& service(const std::string& name);
  std::filesystem::path log_of(const Service& service) const;
  bool shm() const { return session_.machine.transport == "shm"; }
  bool up(const Service& service) const;  ///< its present process has loaded and speaks
  bool fresh() const;                     ///< coupling works on fresh wrenches

  StopSignal stop_signal_;  // before any thread
  RunDir run_dir_;
  Session session_;
  Console console_;
  std::unique_ptr<RoudiLease> roudi_;
  std::unique_ptr<SessionMonitor> monitor_;
  std::vector<std::unique_ptr<Service>> services_;  ///< in the order of starting
  FreshWatch fresh_watch_;
  RoudiWatch roudi_watch_;
  RestartPolicy set_policy_{3};
  Time next_roudi_look_{}, next_measure_{}, next_show_{}, last_progress_{}, loading_since_{};
  std::optional<Time> script_done_at_;
  bool script_reported_ = false, url_shown_ = false, scene_changed_ = false;
  std::string fatal_;  ///< not empty: the session ends by this fault
};

}  // namespace tact::supervise
