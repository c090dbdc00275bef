#pragma once
#include <map>
#include <memory>
#include <string>

#include "support/process.hpp"

namespace tact::test {

/// The stand-in arm as a test has it: a process, and words to move it and to ask what it felt (arm_program.cpp).
class Arm {
 public:
  /// Starts the program; `port`: 0 any, else the one it had before.
  explicit Arm(int port = 0);
  ~Arm();

  int port() const { return port_; }
  /// As device.address wants it.
  std::string address() const { return "127.0.0.1#" + std::to_string(port_); }
  Process& process() { return *process_; }

  void say(const std::string& words);  ///< fails the test unless the arm answers ok
  std::map<std::string, double> get();
  double get(const std::string& key) { return get().at(key); }
  std::string calls();  ///< names, in order, since the last virtOpen; of the cyclic ones the first

  void grip(bool held) { say(held ? "dead_man 1" : "dead_man 0"); }

 private:
  std::string ask(const std::string& words);

  ScratchDir dir_;
  std::unique_ptr<Process> process_;
  int port_ = 0, control_port_ = 0, socket_ = -1;
};

/// The stand-in library; `incomplete`: one that lacks virtDetachVO.
std::filesystem::path stand_in_library(bool incomplete = false);

}  // namespace tact::test
