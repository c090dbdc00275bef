#include "supervise/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "fault/fault.hpp"

namespace tact::supervise {

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::filesystem::path& log) {
  if (::access(program.c_str(), X_OK) != 0) {
    throw SetupError(program.string() + ": cannot be run: " + std::strerror(errno) +
                     "; is Tact built or installed whole?");
  }
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (output < 0) throw SetupError(log.string() + ": cannot be written: " + std::strerror(errno));
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) {
    // Only async-signal-safe calls here.
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(127);  // it died before prctl
    const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::signal(SIGPIPE, SIG_DFL);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  const int error = errno;
  ::close(output);
  if (pid_ < 0) throw SetupError(program.string() + ": cannot be started: " + std::strerror(error));
  ::setpgid(pid_, pid_);  // also here: whoever is first
}

ChildProcess::~ChildProcess() {
  if (poll()) return;
  signal(SIGTERM);
  finish(std::chrono::seconds{1});
}

const std::optional<Ending>& ChildProcess::poll() {
  if (!ending_) {
    int status = 0;
    pid_t found;
    do {
      found = ::waitpid(pid_, &status, WNOHANG);
    } while (found < 0 && errno == EINTR);
    if (found == pid_) {
      ending_ = Ending{WIFEXITED(status) ? WEXITSTATUS(status) : 0, WIFSIGNALED(status) ? WTERMSIG(status) : 0};
    } else if (found < 0) {
      ending_ = Ending{127, 0};
    }
  }
  return ending_;
}

void ChildProcess::signal(int number) {
  if (!poll()) ::kill(pid_, number);
}

const Ending& ChildProcess::finish(std::chrono::milliseconds grace) {
  const auto limit = std::chrono::steady_clock::now() + grace;
  while (!poll() && std::chrono::steady_clock::now() < limit) std::this_thread::sleep_for(std::chrono::milliseconds{5});
  if (!poll()) {
    ::kill(-pid_, SIGCONT);
    ::kill(-pid_, SIGKILL);
    while (!poll()) std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  return *ending_;
}

std::string reason_of(const Ending& ending, const std::filesystem::path& log) {
  std::ifstream in(log);
  std::string line, last, error;
  while (std::getline(in, line)) {
    if (line.empty()) continue;
    last = line;
    // "<date> <time> <name> error <text>", as common/log writes.
    std::istringstream words(line);
    std::string date, time, name, level;
    if (words >> date >> time >> name >> level && level == "error") {
      std::getline(words >> std::ws, error);
    }
  }
  if (ending.signal == 0 && !error.empty()) return error;
  std::string how = ending.signal != 0
                        ? "killed by signal " + std::to_string(ending.signal) + " (" + ::strsignal(ending.signal) + ")"
                        : "ended with code " + std::to_string(ending.code);
  const bool from_outside = ending.signal == SIGKILL || ending.signal == SIGTERM;
  if (!last.empty() && !from_outside) how += "; its last words: " + last;
  return how;
}

ProcessUse use_of(pid_t pid) {
  ProcessUse use;
  const std::string folder = "/proc/" + std::to_string(pid);
  std::ifstream stat(folder + "/stat");
  std::string text((std::istreambuf_iterator<char>(stat)), {});
  const auto after_name = text.rfind(')');  // the name may hold spaces
  if (after_name == std::string::npos) return use;
  std::istringstream fields(text.substr(after_name + 1));
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0, system = 0, unused = 0, resident_pages = 0;
  fields >> user >> system;
  for (int i = 16; i < 24; ++i) fields >> unused;
  fields >> resident_pages;
  use.cpu_s = (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  use.resident_mb = resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
  return use;
}

}  // namespace tact::supervise
