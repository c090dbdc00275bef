#include "fault/nearest.hpp"

#include <gtest/gtest.h>

namespace tact {
namespace {

TEST(Nearest, IsTheCandidateOfFewestSlipsIfFewEnough) {
  const std::vector<std::string> names{"contact.law", "contact.n0", "device.rate_hz"};
  EXPECT_EQ(nearest("contact.lav", names), "contact.law");
  EXPECT_EQ(nearest("contct.law", names), "contact.law");
  EXPECT_EQ(nearest("device.rate", names), "device.rate_hz");
  EXPECT_EQ(nearest("zzzzzz", names), std::nullopt);
  EXPECT_EQ(nearest("", names), std::nullopt);
}

/// 4 GB of work if all letters were compared; the limit of the test program's time would tell.
TEST(Nearest, OfAMegabyteIsNoneAtOnce) {
  const std::vector<std::string> names(100, std::string(40, 'a'));
  EXPECT_EQ(nearest(std::string(1 << 20, 'a'), names), std::nullopt);
}

}  // namespace
}  // namespace tact
