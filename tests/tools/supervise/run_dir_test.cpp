#include "supervise/run_dir.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "fault/fault.hpp"

namespace tact::supervise {
namespace {
namespace fs = std::filesystem;

class RunDirTest : public ::testing::Test {
 protected:
  RunDirTest() {
    fs::create_directories(base_);
    ::setenv("XDG_RUNTIME_DIR", base_.c_str(), 1);
  }
  ~RunDirTest() override {
    ::unsetenv("XDG_RUNTIME_DIR");
    fs::remove_all(base_);
  }
  fs::path base_ = fs::path(testing::TempDir()) / ("tact_run_dir_" + std::to_string(::getpid()));
};

TEST_F(RunDirTest, IsPrivateListedWhileItLivesAndGoneAfterwards) {
  fs::path path;
  {
    const RunDir dir("peg-1");
    path = dir.path();
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    ASSERT_EQ(running_sessions().size(), 1u);
    EXPECT_EQ(running_sessions()[0], path);
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(running_sessions().empty());
}

TEST_F(RunDirTest, TwoSessionsOfOneNameAreRefused) {
  const RunDir first("peg-1");
  try {
    const RunDir second("peg-1");
    FAIL();
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("\"peg-1\" is already running"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(fs::exists(first.path()));
}

TEST_F(RunDirTest, WhatAKilledSupervisorLeftIsTakenOver) {
  fs::create_directories(run_root() / "peg-1");
  std::ofstream(run_root() / "peg-1" / "session.toml") << "old";
  std::ofstream(run_root() / "peg-1" / "lock");
  EXPECT_TRUE(running_sessions().empty());
  const RunDir dir("peg-1");
  EXPECT_FALSE(fs::exists(dir.path() / "session.toml"));
}

}  // namespace
}  // namespace tact::supervise
