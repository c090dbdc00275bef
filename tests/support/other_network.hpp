#pragma once
#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <future>
#include <stdexcept>
#include <string>

namespace tact::test {

/// Another network: a namespace of its own, joined to ours by a pair of virtual cards.
class OtherNetwork {
 public:
  OtherNetwork() {
    ready_ = run("ip netns add " + name_) &&
             run("ip link add " + card_ + "a type veth peer name " + card_ + "b netns " + name_) &&
             run("ip addr add 10.213.77.1/30 dev " + card_ + "a") && run("ip link set " + card_ + "a up") &&
             run("ip -n " + name_ + " addr add 10.213.77.2/30 dev " + card_ + "b") &&
             run("ip -n " + name_ + " link set " + card_ + "b up");
  }
  ~OtherNetwork() {
    run("ip link del " + card_ + "a");
    run("ip netns del " + name_);
  }
  bool ready() const { return ready_; }
  void cut() { run("ip link set " + card_ + "a down"); }

  /// Runs `work` in a thread whose sockets belong to the other network.
  template <class Work>
  auto inside(Work work) {
    return std::async(std::launch::async, [this, work] {
      const int fd = open(("/run/netns/" + name_).c_str(), O_RDONLY | O_CLOEXEC);
      if (fd < 0 || setns(fd, CLONE_NEWNET) != 0) throw std::runtime_error("cannot enter the other network");
      close(fd);
      return work();
    });
  }

 private:
  static bool run(const std::string& command) { return std::system((command + " 2>/dev/null").c_str()) == 0; }
  const std::string name_ = "tact-view-" + std::to_string(getpid());
  const std::string card_ = "tv" + std::to_string(getpid() % 100000);
  bool ready_ = false;
};

}  // namespace tact::test
