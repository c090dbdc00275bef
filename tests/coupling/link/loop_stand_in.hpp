#pragma once
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "coupling/loop/mailboxes.hpp"
#include "session/session.hpp"

namespace tact::coupling {

using namespace std::chrono_literals;

inline Session make_session(const std::string& transport) {
  Session session;
  session.name = std::to_string(::getpid()) + "-link";
  session.machine.transport = transport;
  return session;
}

/// Stands for the device loop: a pose a millisecond, and the last reply.
class Loop {
 public:
  explicit Loop(Mailboxes& mail) : mail_(mail), thread_([this] { run(); }) {}
  ~Loop() {
    stop_ = true;
    thread_.join();
  }
  std::atomic<std::uint64_t> ticks{0}, replies{0}, wrong{0}, server_epoch{0};

 private:
  void run() {
    ToolSample sample;
    ContactReply reply;
    auto next = std::chrono::steady_clock::now();
    while (!stop_) {
      while (mail_.reply.read(reply)) {
        // The test's server answers F.x = seq; a reply of the proof would be out of range.
        if (reply.F_W.force.x() != static_cast<double>(reply.pose_seq) || reply.pose_seq > sample.seq) ++wrong;
        server_epoch = reply.server_epoch;
        ++replies;
      }
      ticks = ++sample.seq;
      mail_.tool.write(sample);
      mail_.tool_ready.ring();
      std::this_thread::sleep_until(next += 1ms);
    }
  }
  Mailboxes& mail_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace tact::coupling
