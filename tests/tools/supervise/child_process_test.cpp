#include "supervise/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "fault/fault.hpp"

namespace tact::supervise {
namespace {
using namespace std::chrono_literals;

class ChildProcessTest : public ::testing::Test {
 protected:
  ChildProcessTest() { std::filesystem::remove(log_); }
  ~ChildProcessTest() override { std::filesystem::remove(log_); }

  Ending ending_of(ChildProcess& child) {
    while (!child.poll()) std::this_thread::sleep_for(1ms);
    return *child.poll();
  }
  std::filesystem::path log_ =
      std::filesystem::path(testing::TempDir()) / ("tact_child_" + std::to_string(::getpid()) + ".log");
};

TEST_F(ChildProcessTest, TheLastErrorOfItsLogIsTheReason) {
  ChildProcess child("/bin/sh",
                     {"-c",
                      "echo '2026-01-01 00:00:00.000 tact-contact error a.toml: first'; "
                      "echo '2026-01-01 00:00:00.100 tact-contact error peg.toml: tool.mesh: no file' >&2; "
                      "echo iceoryx says goodbye; exit 2"},
                     log_);
  const Ending ending = ending_of(child);
  EXPECT_EQ(ending.code, 2);
  EXPECT_EQ(reason_of(ending, log_), "peg.toml: tool.mesh: no file");
}

TEST_F(ChildProcessTest, ASignalIsNamedWithTheLastWords) {
  ChildProcess child("/bin/sh", {"-c", "echo I am working; kill -SEGV $$"}, log_);
  const Ending ending = ending_of(child);
  EXPECT_EQ(ending.signal, SIGSEGV);
  const std::string reason = reason_of(ending, log_);
  EXPECT_NE(reason.find("signal 11"), std::string::npos) << reason;
  EXPECT_NE(reason.find("I am working"), std::string::npos) << reason;
}

TEST_F(ChildProcessTest, WhatIgnoresSigtermIsKilledWithItsGroup) {
  ChildProcess child("/bin/sh", {"-c", "trap '' TERM; sleep 600 & echo $!; wait; sleep 600"}, log_);
  std::string grandchild;
  while (grandchild.empty()) {
    std::ifstream in(log_);
    in >> grandchild;
  }
  child.signal(SIGTERM);
  EXPECT_EQ(child.finish(50ms).signal, SIGKILL);
  std::ifstream state("/proc/" + grandchild + "/stat");
  std::string pid, name, letter;
  for (int i = 0; i < 2000 && state && letter != "Z"; ++i) {
    std::this_thread::sleep_for(1ms);
    state = std::ifstream("/proc/" + grandchild + "/stat");
    state >> pid >> name >> letter;
  }
  EXPECT_TRUE(!state || letter == "Z");
}

TEST_F(ChildProcessTest, AStoppedProcessCanBeEndedToo) {
  ChildProcess child("/bin/sleep", {"600"}, log_);
  child.signal(SIGSTOP);
  child.signal(SIGTERM);
  EXPECT_NE(child.finish(50ms).signal, 0);
}

TEST_F(ChildProcessTest, AMissingProgramIsNamed) {
  try {
    ChildProcess child("/nonexistent/tact-contact", {}, log_);
    FAIL();
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("/nonexistent/tact-contact"), std::string::npos);
  }
}

TEST(ProcessUse, OfThisProcessIsPlausible) {
  volatile double sink = 0;
  while (use_of(::getpid()).cpu_s <= 0) {
    for (int i = 0; i < 1'000'000; ++i) sink = sink + 1.0;
  }
  const ProcessUse use = use_of(::getpid());
  EXPECT_GT(use.resident_mb, 0.5);
  EXPECT_LT(use.resident_mb, 10'000);
  EXPECT_EQ(use_of(-1).resident_mb, 0);
}

}  // namespace
}  // namespace tact::supervise
