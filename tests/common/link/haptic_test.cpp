// Two real processes, real RouDi.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "link/roudi.hpp"
#include "session/session.hpp"
#include "support/process.hpp"

namespace tact {
namespace {

class Haptic : public ::testing::TestWithParam<const char*> {
 protected:
  test::Process start(const char* what, const char* log) {
    return {{TACT_PEER, what, session_, GetParam()}, dir_.path() / log};
  }
  bool shm() const { return std::string(GetParam()) == "shm"; }

  const test::ScratchDir dir_;
  const RoudiLease lease_{share_dir() / "roudi.toml"};
  const std::string session_ = std::to_string(::getpid()) + "-t";
};

bool says(const test::Process& process, const std::string& text, int times = 1) {
  return test::eventually([&] {
    const std::string output = process.output();
    std::size_t at = 0;
    for (int i = 0; i < times; ++i, ++at) {
      at = output.find(text, at);
      if (at == std::string::npos) return false;
    }
    return true;
  });
}

TEST_P(Haptic, PosesAreAnsweredAndTheTransportIsProven) {
  auto contact = start("contact", "contact");
  auto coupling = start("coupling", "coupling");
  ASSERT_TRUE(says(coupling, "answered=")) << coupling.output() << contact.output();
  std::printf("%s: %s", GetParam(), coupling.output().c_str());
  EXPECT_TRUE(says(coupling, shm() ? "answered=1 no_datagrams=1" : "answered=1 no_datagrams=0"));
}

TEST_P(Haptic, OthersDatagramsDoNotSpoilTheProof) {
  std::atomic<bool> stop{false};
  std::thread other([&stop] {
    const int file = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(9);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    while (!stop) {  // never to catch up: on a starved machine that would be all it does
      for (int i = 0; i < 30; ++i) ::sendto(file, &to, 16, 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    ::close(file);
  });
  auto contact = start("contact", "contact");
  auto coupling = start("coupling", "coupling");
  EXPECT_TRUE(says(coupling, shm() ? "answered=1 no_datagrams=1" : "answered=1 no_datagrams=0")) << coupling.output();
  stop = true;
  other.join();
}

TEST_P(Haptic, AKilledServerIsReplacedByANewIncarnation) {
  auto coupling = start("coupling", "coupling");
  for (int times = 1; times <= 3; ++times) {
    auto contact = start("contact", "contact");
    ASSERT_TRUE(says(coupling, "answered=1", times)) << coupling.output();
    contact.signal(SIGKILL);
    ASSERT_TRUE(says(coupling, "peer lost", times)) << coupling.output();
  }
}

TEST_P(Haptic, AKilledCouplingIsReplacedByANewIncarnation) {
  auto contact = start("contact", "contact");
  for (int times = 1; times <= 3; ++times) {
    auto coupling = start("coupling", "coupling");
    ASSERT_TRUE(says(coupling, "answered=1")) << coupling.output() << contact.output();
    coupling.signal(SIGKILL);
  }
}

INSTANTIATE_TEST_SUITE_P(Transports, Haptic, ::testing::Values("shm", "udp"),
                         [](const auto& chosen) { return std::string(chosen.param); });

}  // namespace
}  // namespace tact
