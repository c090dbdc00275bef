#include "fault/text.hpp"

#include <gtest/gtest.h>

namespace tact {
namespace {

TEST(Utf8, IsToldFromWhatIsNot) {
  for (const char* good : {"", "abc\n", "K\xc3\xbcrbis", "\xe2\x82\xac", "\xf0\x9f\x8e\x83", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_TRUE(is_utf8(good)) << good;
  }
  for (const char* bad : {"\xff", "a\x80", "\xc3(", "\xe2\x82", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_FALSE(is_utf8(bad)) << bad;
  }
}

TEST(OneLine, LeavesWhatIsPrintableAndEscapesTheRest) {
  EXPECT_EQ(one_line(""), "");
  EXPECT_EQ(one_line("K\xc3\xbcrbis \"x\" \\"), "K\xc3\xbcrbis \"x\" \\");
  EXPECT_EQ(one_line("a\nb\r\x1b[31m\x7f"), "a\\x0ab\\x0d\\x1b[31m\\x7f");
  EXPECT_EQ(one_line(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(one_line("\xc3\xbc\xff\xc3"), "\xc3\xbc\\xff\\xc3");
  EXPECT_EQ(quoted_line("a\tb"), "\"a\\x09b\"");
}

TEST(OneLine, IsCutBetweenCharactersAndSaysOfWhat) {
  EXPECT_EQ(one_line("abcdef", 6), "abcdef");
  EXPECT_EQ(one_line("abcdefg", 6), "abcdef... (7 bytes)");
  EXPECT_EQ(one_line("abcde\xc3\xbc", 6), "abcde... (7 bytes)");
  EXPECT_EQ(one_line("abcd\n", 6), "abcd... (5 bytes)");
  const std::string cut = one_line(std::string(1 << 20, 'a'));
  EXPECT_EQ(cut.size(), 120 + std::string("... (1048576 bytes)").size());
}

}  // namespace
}  // namespace tact
