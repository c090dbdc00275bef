// Real RouDi. It belongs to the machine: when somebody else runs one these tests skip.
#include "link/roudi.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <memory>

#include "fault/fault.hpp"
#include "link/roudi_probe.hpp"
#include "session/session.hpp"
#include "support/process.hpp"

namespace tact {
namespace {

using namespace std::chrono_literals;

class Roudi : public ::testing::Test {
 protected:
  void SetUp() override {
    if (probe_roudi(100ms) == RoudiState::reachable) GTEST_SKIP() << "a RouDi is already running on this machine";
  }
  const std::filesystem::path toml_ = share_dir() / "roudi.toml";
};

TEST_F(Roudi, TheLastLeaseStopsItAndLeavesNothing) {
  auto first = std::make_unique<RoudiLease>(toml_);
  ASSERT_FALSE(first->foreign());
  const pid_t pid = first->pid();
  EXPECT_TRUE(first->is_alive());
  auto second = std::make_unique<RoudiLease>(toml_);
  EXPECT_EQ(second->pid(), pid);
  first.reset();
  EXPECT_TRUE(second->is_alive());
  EXPECT_EQ(probe_roudi(100ms), RoudiState::reachable);
  second.reset();
  EXPECT_EQ(probe_roudi(100ms), RoudiState::absent);
  EXPECT_NE(::kill(pid, 0), 0);
  EXPECT_TRUE(test::shared_memory_files().empty());
  EXPECT_FALSE(std::filesystem::exists("/tmp/roudi"));
  EXPECT_FALSE(std::filesystem::exists("/tmp/roudi.lock"));
  EXPECT_FALSE(std::filesystem::exists("/tmp/tact-roudi.pid"));
}

TEST_F(Roudi, TheShareOfAKilledHolderGoesWithIt) {
  auto own = std::make_unique<RoudiLease>(toml_);
  const pid_t holder = ::fork();
  if (holder == 0) {
    const RoudiLease lease(toml_);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(holder, &status, 0), holder);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(own->is_alive());
  own.reset();
  EXPECT_EQ(probe_roudi(100ms), RoudiState::absent);
  EXPECT_TRUE(test::shared_memory_files().empty());
}

TEST_F(Roudi, OneLeftByACrashedSessionIsReplaced) {
  const pid_t holder = ::fork();
  if (holder == 0) {
    const RoudiLease lease(toml_);
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(holder, nullptr, 0);
  ASSERT_EQ(probe_roudi(100ms), RoudiState::reachable);
  const std::uint64_t left = roudi_instance();
  {
    const RoudiLease lease(toml_);
    EXPECT_FALSE(lease.foreign());
    EXPECT_TRUE(lease.is_alive());
    EXPECT_NE(roudi_instance(), left);
  }
  EXPECT_EQ(probe_roudi(100ms), RoudiState::absent);
}

TEST_F(Roudi, ItsDeathIsNoticedAndItCanBeRestarted) {
  RoudiLease lease(toml_);
  const pid_t first = lease.pid();
  ::kill(first, SIGKILL);
  EXPECT_TRUE(test::eventually([&] { return !lease.is_alive(); }));
  lease.restart();
  EXPECT_TRUE(lease.is_alive());
  EXPECT_NE(lease.pid(), first);
}

TEST_F(Roudi, ALeaseNoticesThatAnotherSessionRestartedIt) {
  RoudiLease a(toml_), b(toml_);
  a.restart();
  EXPECT_TRUE(a.is_alive());
  EXPECT_FALSE(b.is_alive());
  b.restart();  // adopts
  EXPECT_EQ(b.pid(), a.pid());
  EXPECT_TRUE(a.is_alive());
}

TEST_F(Roudi, OneOfSomebodyElseIsUsedAndNeverStopped) {
  const test::ScratchDir dir;
  test::Process foreign({"iox-roudi", "-c", toml_.string(), "-m", "off"}, dir.path() / "log");
  ASSERT_TRUE(test::eventually([&] { return foreign.output().find("ready for clients") != std::string::npos; }));
  {
    RoudiLease lease(toml_);
    EXPECT_TRUE(lease.foreign());
    EXPECT_TRUE(lease.is_alive());
  }
  EXPECT_EQ(probe_roudi(100ms), RoudiState::reachable);
  foreign.signal(SIGTERM);
  EXPECT_TRUE(foreign.wait(5s));
}

TEST_F(Roudi, ClientsAreToldWhenThereIsNone) {
  try {
    require_roudi(0ms);
    FAIL();
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("tact run"), std::string::npos) << e.what();
  }
}

TEST_F(Roudi, AMissingProgramIsNamed) {
  const std::string path = ::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  try {
    RoudiLease lease(toml_);
    ADD_FAILURE();
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("apt install iceoryx"), std::string::npos) << e.what();
  }
  ::setenv("PATH", path.c_str(), 1);
}

TEST_F(Roudi, ABadConfigurationIsReportedWithItsOwnWords) {
  const test::ScratchDir dir;
  const auto file = dir.path() / "bad.toml";
  std::FILE* out = std::fopen(file.c_str(), "w");
  std::fputs("[general]\nversion = 99\n", out);
  std::fclose(out);
  EXPECT_THROW(RoudiLease{file}, SetupError);
  EXPECT_EQ(probe_roudi(100ms), RoudiState::absent);
}

}  // namespace
}  // namespace tact
