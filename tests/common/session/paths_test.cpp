#include <gtest/gtest.h>

#include <cstdlib>

#include "common/session/temp_folder.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

/// A variable of the environment, put back afterwards.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Variable() { old_ ? ::setenv(name_, old_->c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST(Paths, CacheFolderIsTheFirstOneStated) {
  Variable home("HOME", "/home/u"), xdg("XDG_CACHE_HOME", nullptr), own("TACT_CACHE", nullptr);
  MachineSpec machine;
  EXPECT_EQ(cache_dir(machine), "/home/u/.cache/tact");
  ::setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(cache_dir(machine), "/home/u/.cache/tact");
  ::setenv("XDG_CACHE_HOME", "/xdg", 1);
  EXPECT_EQ(cache_dir(machine), "/xdg/tact");
  ::setenv("TACT_CACHE", "/own", 1);
  EXPECT_EQ(cache_dir(machine), "/own");
  machine.cache_dir = "/stated";
  EXPECT_EQ(cache_dir(machine), "/stated");
}

TEST(Paths, ShareAndLibexecAreFoundAboveTheProgram) {
  const auto prefix = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
  EXPECT_EQ(share_dir(), prefix / "share" / "tact");
  EXPECT_EQ(libexec_dir(), prefix / "libexec" / "tact");
}

TEST(Paths, SceneIsFoundByNameOrTakenAsPath) {
  EXPECT_EQ(find_scene("/a/b.toml"), "/a/b.toml");
  EXPECT_EQ(find_scene("mine.toml"), "mine.toml");
  EXPECT_EQ(find_scene("peg"), share_dir() / "scenes" / "peg.toml");
  EXPECT_EQ(setup_error([] { find_scene("pegg"); }).rfind("scene: found \"pegg\", expected a scene file", 0), 0u);
  EXPECT_NE(setup_error([] { find_scene("pegg"); }).find("did you mean peg?"), std::string::npos);
}

}  // namespace
}  // namespace tact
