#include "virtuose/arm.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <sstream>

namespace tact::test {
namespace {

namespace fs = std::filesystem;
fs::path tests_dir() { return fs::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace

fs::path stand_in_library(bool incomplete) {
  return tests_dir() / (incomplete ? "virtuose_stand_in_incomplete.so" : "virtuose_stand_in.so");
}

Arm::Arm(int port) {
  process_ = std::make_unique<Process>(
      std::vector<std::string>{tests_dir() / "virtuose_stand_in_arm", std::to_string(port)}, dir_.path() / "arm.txt");
  EXPECT_TRUE(eventually([&] {
    std::istringstream said(process_->output());
    std::string word;
    return static_cast<bool>(said >> word >> port_ >> control_port_);
  })) << process_->output();
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(control_port_));
  EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const timeval limit{5, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
}

Arm::~Arm() { ::close(socket_); }

std::string Arm::ask(const std::string& words) {
  std::array<char, 4096> reply{};
  ::send(socket_, words.data(), words.size(), 0);
  const ssize_t n = ::recv(socket_, reply.data(), reply.size(), 0);
  return n > 0 ? std::string(reply.data(), static_cast<std::size_t>(n)) : "no answer";
}

void Arm::say(const std::string& words) { EXPECT_EQ(ask(words), "ok") << words; }

std::map<std::string, double> Arm::get() {
  std::map<std::string, double> values;
  std::istringstream in(ask("get"));
  std::string key;
  for (double value = 0; in >> key >> value;) values[key] = value;
  return values;
}

std::string Arm::calls() { return ask("calls"); }

}  // namespace tact::test
