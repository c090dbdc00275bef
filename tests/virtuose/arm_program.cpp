// The stand-in arm: a process of its own, as the real arm's controller is. It talks to stand_in_library.cpp on one port
// of the loopback interface and to the test on another, in words; prints both and runs until it is told to end.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <sstream>
#include <string>

#include "virtuose/arm_model.hpp"

namespace tact::standin {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr std::int64_t kPeriod_ns = 1'000'000;

int listen_on_loopback(int& port) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  if (fd < 0 || ::bind(fd, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    std::perror("stand-in arm: socket");
    std::exit(1);
  }
  port = ntohs(address.sin_port);
  return fd;
}

class Program {
 public:
  explicit Program(int port)
      : port_(port), link_(listen_on_loopback(port_)), control_(listen_on_loopback(control_port_)) {
    std::printf("ports %d %d\n", port_, control_port_);
    std::fflush(stdout);
  }

  void run() {
    timespec due{};
    clock_gettime(CLOCK_MONOTONIC, &due);
    while (!ended_) {
      due.tv_nsec += kPeriod_ns;
      if (due.tv_nsec >= 1'000'000'000) {
        due.tv_nsec -= 1'000'000'000;
        ++due.tv_sec;
      }
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
      hear_library();
      hear_test();
      arm_.advance(kPeriod_s);
      if (session_ != 0 && arm_.watchdog_bit()) {
        tell(peer_, session_, Link::cut);
        session_ = 0;
      }
      if (session_ != 0 && !dropped_) tell(peer_, session_, Link::up);
    }
  }

 private:
  void hear_library() {
    Command command;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    while (::recvfrom(link_, &command, sizeof command, 0, reinterpret_cast<sockaddr*>(&from), &size) ==
           sizeof command) {
      if (command.magic != kMagic || dropped_) continue;
      if (command.order == Order::hello && session_ == 0) {
        session_ = command.session;
        peer_ = from;
        calls_.clear();
        arm_.open();
      } else if (command.session != session_) {
        tell(from, command.session, Link::refused);  // one at a time
        continue;
      }
      note(command);
      arm_.apply(command);
      if (command.order == Order::bye) {
        arm_.close();
        session_ = 0;
      }
    }
  }

  /// The order of calls: each of the configuration, the first of those that come every tick.
  void note(const Command& command) {
    const std::string call = std::string(" ") + command.call + ' ';
    const bool cyclic =
        command.order == Order::force || command.order == Order::position || command.order == Order::speed;
    if (calls_.size() > 2000 || (cyclic && calls_.find(call) != calls_.npos)) return;
    calls_ += calls_.empty() ? call : call.substr(1);
  }

  void tell(const sockaddr_in& to, std::uint32_t session, Link link) {
    if (!frozen_) arm_.state(state_);
    State state = state_;
    state.session = session;
    state.link = link;
    if (lie_ == "nan") state.pose[1] = std::numeric_limits<float>::quiet_NaN();
    if (lie_ == "quaternion") state.pose[6] *= 1.1F;
    if (lie_ == "jump") state.pose[0] += 0.2F;
    if (lie_once_) lie_.clear();
    ::sendto(link_, &state, sizeof state, MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }

  void hear_test() {
    std::array<char, 512> text{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    for (;;) {
      const ssize_t n =
          ::recvfrom(control_, text.data(), text.size() - 1, 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (n < 0) return;
      text[static_cast<std::size_t>(n)] = '\0';
      const std::string reply = obey(text.data());
      ::sendto(control_, reply.data(), reply.size(), 0, reinterpret_cast<sockaddr*>(&from), size);
    }
  }

  std::string obey(const char* text) {
    std::istringstream in(text);
    std::string word;
    in >> word;
    if (word == "get") return all();
    if (word == "calls") return calls_;
    if (word == "end") {
      ended_ = true;
    } else if (word == "dead_man") {
      in >> arm_.dead_man;
    } else if (word == "chain") {
      in >> arm_.chain;
    } else if (word == "power_off") {
      arm_.cut_power();
    } else if (word == "power_delay") {
      in >> arm_.power_delay_s;
    } else if (word == "power_needs_dead_man") {
      in >> arm_.power_needs_dead_man;
    } else if (word == "shift") {
      in >> arm_.shift;
    } else if (word == "alarm") {
      in >> arm_.alarm;
    } else if (word == "watchdog") {
      in >> arm_.watchdog_s;
    } else if (word == "hand") {
      in >> arm_.hand;
    } else if (word == "aim") {
      in >> arm_.p_aim.x() >> arm_.p_aim.y() >> arm_.p_aim.z();
    } else if (word == "place") {
      Pose X;
      in >> X.p.x() >> X.p.y() >> X.p.z() >> X.q.x() >> X.q.y() >> X.q.z() >> X.q.w();
      X.q.normalize();
      arm_.place(X);
    } else if (word == "freeze") {
      in >> frozen_;
    } else if (word == "lie") {
      lie_.clear();
      lie_once_ = false;
      in >> lie_;
    } else if (word == "lie_once") {
      in >> lie_;
      lie_once_ = true;
    } else if (word == "drop") {
      in >> dropped_;
    } else if (word == "reset") {
      arm_.reset_books();
    } else {
      return "?";
    }
    return "ok";
  }

  std::string all() const {
    std::ostringstream out;
    const ArmModel::Books& b = arm_.books();
    const Pose X = arm_.X_handle();
    out << "force_max " << b.force_max_n << " force_step_max " << b.force_step_max_n << " torque_max "
        << b.torque_max_nm << " reach_max " << b.reach_max_m << " moved_max " << b.moved_max_m << " writes " << b.writes
        << " bites " << b.watchdog_bites << " power_ons " << b.power_ons << " powered " << arm_.powered()
        << " attached " << arm_.attached() << " open " << (session_ != 0) << " type " << arm_.command_type()
        << " force_x " << arm_.F_motor().force.x() << " force_y " << arm_.F_motor().force.y() << " force_z "
        << arm_.F_motor().force.z() << " x " << X.p.x() << " y " << X.p.y() << " z " << X.p.z() << " set_speed "
        << arm_.set_speed().norm();
    for (int i = 0; i < 12; ++i) out << " gain" << i << ' ' << arm_.gains()[i];
    return out.str();
  }

  int port_, control_port_ = 0;
  int link_, control_;
  ArmModel arm_;
  State state_;
  sockaddr_in peer_{};
  std::uint32_t session_ = 0;
  std::string calls_, lie_;
  bool frozen_ = false, dropped_ = false, lie_once_ = false, ended_ = false;
};

}  // namespace
}  // namespace tact::standin

int main(int argc, char** argv) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  sched_param priority{};
  priority.sched_priority = 85;  // a controller is not late because a computer is busy
  if (::sched_setscheduler(0, SCHED_FIFO, &priority) == 0) ::mlockall(MCL_CURRENT);
  tact::standin::Program(argc > 1 ? std::atoi(argv[1]) : 0).run();
  return 0;
}
