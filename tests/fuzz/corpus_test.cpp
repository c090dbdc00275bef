// The corpus of a fuzz target as an ordinary test: every file goes the way the fuzzer sends it, and ends as its name
// says. So targets build, seeds are real ones, and what was found stays mended.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "fuzz/fuzz_target.hpp"

namespace tact::fuzz {
namespace {

TEST(Corpus, EveryFileIsAcceptedOrRefusedAsItsNameSays) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(TACT_CORPUS)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  int accepted = 0, refused = 0;
  for (const auto& path : files) {
    SCOPED_TRACE(path);
    std::cerr << path.filename().string() << '\n';  // the last one said ended the process
    const std::string bytes = read_file(path), name = path.filename();
    const bool sound = name.rfind("sound-", 0) == 0;
    ASSERT_TRUE(sound || name.rfind("refused-", 0) == 0);
    EXPECT_EQ(try_input({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}), sound);
    (sound ? accepted : refused)++;
  }
  EXPECT_GT(accepted, 0);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace tact::fuzz
