#include "contact/bake/bake_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "fault/fault.hpp"

extern char** environ;

namespace tact::contact {
namespace {

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    int fds[2];
    if (::pipe2(fds, O_CLOEXEC) != 0)
      throw SetupError(std::string("bake: cannot make a pipe: ") + std::strerror(errno));
    read = fds[0];
    write = fds[1];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_write();
    ::close(read);
  }
  void close_write() {
    if (write >= 0) ::close(write);
    write = -1;
  }
};

/// Kills and reaps the child whatever happens.
class Child {
 public:
  Child(const std::vector<std::string>& command, int out) {
    std::vector<char*> arguments;
    for (const std::string& a : command) arguments.push_back(const_cast<char*>(a.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, out, 1);
    // A parent that blocks signals or runs in real time hands neither on.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    const int error = ::posix_spawn(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) {
      pid_ = -1;
      throw SetupError(command[0] + ": cannot start the bake: " + std::strerror(error) +
                       ": is Tact installed completely?");
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ < 0) return;
    ::kill(pid_, SIGKILL);
    wait();
  }
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

void read_line(const std::string& line, const BakeProgress& progress, ChildEnd& end, BakeStep& last) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) return;  // a parser's chatter
  if (json.contains("error") && json["error"].is_string()) end.error = json["error"];
  if (!json.contains("part")) return;
  last = {json.value("part", ""), json.value("stage", ""), json.value("fraction", 0.0)};
  end.last_part = last.part;
  if (progress && !progress(last)) throw SetupError("bake: cancelled");
}

}  // namespace

ChildEnd run_bake_child(const std::vector<std::string>& command, const BakeProgress& progress) {
  Pipe out;
  Child child(command, out.write);
  out.close_write();
  ChildEnd end;
  std::string text;
  char buffer[4096];
  BakeStep last;
  for (;;) {
    // A child that has nothing to say for a while must not keep the caller from cancelling.
    pollfd ready{out.read, POLLIN, 0};
    const int events = ::poll(&ready, 1, 50);
    if (events == 0 && progress && !last.part.empty() && !progress(last)) throw SetupError("bake: cancelled");
    if (events <= 0) continue;
    const ssize_t n = ::read(out.read, buffer, sizeof(buffer));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    text.append(buffer, static_cast<std::size_t>(n));
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n')) {
      read_line(text.substr(0, at), progress, end, last);
      text.erase(0, at + 1);
    }
  }
  const int status = child.wait();
  end.good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) throw SetupError("bake: cancelled");
    end.how = signal == SIGKILL ? "was killed (out of memory?)" : std::string("crashed (") + ::strsignal(signal) + ")";
  } else if (!end.good) {
    end.how = "left with code " + std::to_string(WEXITSTATUS(status));
  }
  return end;
}

}  // namespace tact::contact
