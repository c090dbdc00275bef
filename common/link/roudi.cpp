#include "link/roudi.hpp"

#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "fault/fault.hpp"
#include "link/roudi_probe.hpp"

extern char** environ;

namespace tact {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kLock = "/tmp/tact-roudi.lock";
constexpr const char* kUsers = "/tmp/tact-roudi.users";
constexpr const char* kPid = "/tmp/tact-roudi.pid";
constexpr const char* kLog = "/tmp/tact-roudi.log";
constexpr std::uint64_t kSharedMemoryNeeded = 80'000'000;  // 66 MB of management data, the pools, and some air

int open_shared_file(const char* path) {
  int file = ::open(path, O_RDWR | O_CLOEXEC);
  if (file < 0 && errno == ENOENT) {
    file = ::open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file >= 0) ::fchmod(file, 0666);  // other users of this machine count too
  }
  if (file < 0) throw SetupError(std::string(path) + ": cannot be opened: " + std::strerror(errno) + "; remove it");
  return file;
}

std::string tail_of(const char* path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  const std::string all = text.str();
  return all.size() > 600 ? all.substr(all.size() - 600) : all;
}

bool eventually(const auto& condition, milliseconds limit) {
  const auto until = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(milliseconds{10});
  }
  return true;
}

/// Of join_roudi(): a service joins once, on the thread that makes its participant. Who holds a lease has joined
/// already.
int leases = 0;
int joined_file = -1;
pid_t joined_parent = 0;

/// Field 22 of /proc/<pid>/stat; 0 when there is no such process or it is a zombie. A killed process whose first thread
/// is a zombie still holds its files while other threads end: field 20 counts them.
unsigned long long start_time_of(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string stat;
  std::getline(file, stat);
  const auto name_end = stat.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream rest(stat.substr(name_end + 1));
  std::array<std::string, 20> field;  // from the third
  for (std::string& f : field) rest >> f;
  const bool zombie = field[0] == "Z" || field[0] == "X";
  if (!rest || (zombie && std::stoi(field[17]) <= 1)) return 0;
  return std::stoull(field[19]);
}

}  // namespace

/// Exclusive right to start or stop RouDi while it lives.
class RoudiLease::Transition {
 public:
  Transition() : file_(open_shared_file(kLock)) {
    if (!eventually([this] { return ::flock(file_, LOCK_EX | LOCK_NB) == 0; }, seconds{30})) {
      ::close(file_);
      throw SetupError(std::string(kLock) + ": held by another process for 30 s (fuser " + kLock + " names it)");
    }
  }
  ~Transition() { ::close(file_); }
  Transition(const Transition&) = delete;
  Transition& operator=(const Transition&) = delete;

 private:
  int file_;
};

bool RoudiLease::Identity::running() const { return pid > 0 && start_time_of(pid) == start_time; }

void RoudiLease::Identity::kill() const {
  if (!running()) return;
  ::kill(pid, SIGKILL);
  eventually(
      [this] {
        ::waitpid(pid, nullptr, WNOHANG);  // reaps it when it was our child
        return !running();
      },
      seconds{5});
}

RoudiLease::Identity RoudiLease::recorded() {
  Identity identity;
  std::ifstream(kPid) >> identity.pid >> identity.start_time;
  return identity.running() ? identity : Identity{};
}

RoudiLease::RoudiLease(const fs::path& roudi_toml) : toml_(roudi_toml) {
  const Transition transition;
  users_file_ = open_shared_file(kUsers);
  try {
    if (::flock(users_file_, LOCK_EX | LOCK_NB) == 0) {
      // Nobody uses it: what crashed sessions left still knows dead clients. Take a fresh one.
      recorded().kill();
    }
    obtain();
  } catch (...) {
    ::close(users_file_);
    throw;
  }
  ::flock(users_file_, LOCK_SH);
  ++leases;
}

RoudiLease::~RoudiLease() {
  --leases;
  try {
    const Transition transition;
    const bool last = ::flock(users_file_, LOCK_EX | LOCK_NB) == 0;
    if (last && !foreign_) {
      // SIGTERM would make RouDi signal every client it ever registered, also the pids of crashed ones.
      identity_.kill();
      remove_leftovers();
    }
  } catch (const SetupError&) {  // the lock is stuck: leave RouDi to the next session
  }
  ::close(users_file_);
}

bool RoudiLease::is_alive() const {
  if (!foreign_ && !identity_.running()) return false;
  return probe_roudi(seconds{1}) == RoudiState::reachable;
}

void RoudiLease::restart() {
  const Transition transition;
  identity_.kill();
  obtain();
}

void RoudiLease::obtain() {
  identity_ = recorded();
  foreign_ = false;
  if (identity_.pid > 0) return;
  switch (probe_roudi(seconds{1})) {
    case RoudiState::reachable:
      foreign_ = true;
      return;
    case RoudiState::hung:
      throw SetupError("RouDi: one that Tact did not start runs but reads no messages; kill iox-roudi and try again");
    case RoudiState::forbidden:
      require_roudi(milliseconds{0});
      return;
    case RoudiState::absent:
      start();
      return;
  }
}

void RoudiLease::start() {
  remove_leftovers();
  struct statvfs memory {};
  if (::statvfs("/dev/shm", &memory) != 0) {
    throw SetupError(std::string("/dev/shm: ") + std::strerror(errno) +
                     "; mount a tmpfs there, or choose transport = \"udp\"");
  }
  const std::uint64_t available = std::uint64_t{memory.f_bavail} * memory.f_frsize;
  if (available < kSharedMemoryNeeded) {
    throw SetupError("/dev/shm: " + std::to_string(available / 1'000'000) + " MB are free, RouDi needs " +
                     std::to_string(kSharedMemoryNeeded / 1'000'000) +
                     "; enlarge it (docker: --shm-size=128m; else: mount -o remount,size=128m /dev/shm), or choose "
                     "transport = \"udp\"");
  }
  if (!fs::exists(toml_)) throw SetupError(toml_.string() + ": no such file; reinstall Tact");

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  ::unlink(kLog);  // may be another user's
  posix_spawn_file_actions_addopen(&files, 1, kLog, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0644);
  posix_spawn_file_actions_adddup2(&files, 1, 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  const std::string toml = toml_.string();
  const char* const command[] = {"iox-roudi", "-c", toml.c_str(), "-m", "off", nullptr};
  pid_t pid = 0;
  const int error = ::posix_spawnp(&pid, command[0], &files, &attributes, const_cast<char* const*>(command), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error == ENOENT) {
    throw SetupError("iox-roudi: not found in PATH; install it (apt install iceoryx), or choose transport = \"udp\"");
  }
  if (error != 0) throw SetupError(std::string("iox-roudi: cannot be started: ") + std::strerror(error));

  bool ended = false;
  const bool ready = eventually(
      [&] {
        ended = ::waitpid(pid, nullptr, WNOHANG) != 0;
        return ended || (tail_of(kLog).find("RouDi is ready for clients") != std::string::npos &&
                         probe_roudi(milliseconds{0}) == RoudiState::reachable);
      },
      seconds{10});
  if (ended || !ready) {
    if (!ended) {
      ::kill(pid, SIGKILL);
      ::waitpid(pid, nullptr, 0);
    }
    throw SetupError(std::string("iox-roudi: ") + (ended ? "ended while starting" : "not ready after 10 s") +
                     "; its last words (" + kLog + "):\n" + tail_of(kLog));
  }
  identity_ = {pid, start_time_of(pid)};
  ::unlink(kPid);
  std::ofstream(kPid) << identity_.pid << ' ' << identity_.start_time << '\n';
}

void join_roudi() {
  if (joined_file >= 0 || leases > 0) return;
  joined_file = open_shared_file(kUsers);
  ::flock(joined_file, LOCK_SH);
  joined_parent = ::getppid();
}

bool leave_roudi() noexcept {
  if (joined_file < 0) return false;
  bool stopped = false;
  if (::getppid() != joined_parent) {
    try {
      const RoudiLease::Transition transition;
      const RoudiLease::Identity ours = RoudiLease::recorded();
      if (::flock(joined_file, LOCK_EX | LOCK_NB) == 0 && ours.pid > 0) {
        ours.kill();
        RoudiLease::remove_leftovers();
        stopped = true;
      }
    } catch (const std::exception&) {  // the next session's first lease cleans up
    }
  }
  ::close(std::exchange(joined_file, -1));
  return stopped;
}

void RoudiLease::remove_leftovers() {
  if (probe_roudi(milliseconds{0}) != RoudiState::absent) return;  // somebody else's by now
  ::unlink(kPid);
  ::unlink(kRoudiSocket);
  ::unlink("/tmp/roudi.lock");
  ::unlink("/tmp/iox-unique-roudi.lock");
  ::unlink("/dev/shm/iceoryx_mgmt");
  // The data segment is named by the group of the RouDi that made it.
  if (const group* own = ::getgrgid(::getgid())) ::unlink((std::string("/dev/shm/") + own->gr_name).c_str());
  // Sockets of clients that were killed: iceoryx_rt_<pid>_<time>.
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/tmp", ignored)) {
    const std::string name = entry.path().filename();
    if (name.rfind("iceoryx_rt_", 0) != 0) continue;
    const long pid = std::strtol(name.c_str() + 11, nullptr, 10);
    if (pid > 0 && ::kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH) ::unlink(entry.path().c_str());
  }
}

}  // namespace tact
