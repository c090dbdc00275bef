#include "coupling/link/first_scene.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "fault/fault.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

TEST(FirstScene, IsTheOneTheSessionBeganWithWhateverComesLater) {
  const test::ScratchDir dir;
  const SceneIdentity first{0x00000000deadbeef, std::numeric_limits<std::uint64_t>::max()};
  EXPECT_EQ(first_scene(dir.path(), first), first);
  EXPECT_EQ(first_scene(dir.path(), {1, 2}), first);
  EXPECT_EQ(first_scene(dir.path(), first), first);
}

TEST(FirstScene, OfADamagedFileOrAFolderThatIsGoneNothingIsTaken) {
  const test::ScratchDir dir;
  std::ofstream(dir.path() / "first_scene") << "0000000000000001";
  EXPECT_THROW(first_scene(dir.path(), {1, 2}), SetupError);
  EXPECT_THROW(first_scene(dir.path() / "gone", {1, 2}), SetupError);
}

}  // namespace
}  // namespace tact::coupling
