#include "evidence/page.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "fault/fault.hpp"

namespace tact::evidence {
namespace {

std::string slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class PageTest : public ::testing::Test {
 protected:
  ~PageTest() override { std::filesystem::remove_all(dir_); }
  const std::filesystem::path dir_ =  // tests run side by side
      std::filesystem::path(::testing::TempDir()) / ("tact-page-test-" + std::to_string(getpid()));
};

TEST(Base64, IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(CsvField, QuotesWhatWouldBreakARow) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a, \"b\""), "\"a, \"\"b\"\"\"");
}

TEST_F(PageTest, NeedsNoOtherFileAndShowsAllThatWasSaid) {
  bench::Report report(dir_ / "plots");
  report.begin("fig-2");
  report.claim("eight <times>", "seven & a half", bench::Holds::partly, "nearly");
  report.table({"law", "k"}, {{"none", "1,5"}});
  report.say("between");
  report.times({"law", "us"}, {{"none", "3"}});
  report.chart({"Ripple", "k", "N", true, true, {{"none", {{1, 2}, {10, 3}}}}});
  report.bar("speed", 3, "us", false, 2);
  report.end();
  write_page(report, {"1.2", "tact report fig-2", true}, dir_);
  const std::string page = slurp(dir_ / "index.html");
  for (const char* part :
       {"Fig. 2", "eight &lt;times&gt;", "seven &amp; a half", "holds in part", "nearly", "between",
        "tact report fig-2 --quick", "times: another machine", "<b>missed</b> speed", "data:image/svg+xml;base64,"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_LT(page.find("between"), page.find("times: another machine")) << "in the order in which it was said";
  EXPECT_EQ(slurp(dir_ / "data" / "fig-2-1.csv"), "law,k\r\nnone,\"1,5\"\r\n");
  EXPECT_EQ(slurp(dir_ / "data" / "fig-2-2.csv"), "law,us\r\nnone,3\r\n");
  for (const std::string attribute : {"src=\"", "href=\""}) {
    for (std::size_t at = page.find(attribute); at != std::string::npos; at = page.find(attribute, at + 1)) {
      const std::string target = page.substr(at + attribute.size(), 80);
      EXPECT_TRUE(target.starts_with("data:") || target.starts_with("#")) << target;
    }
  }
}

TEST_F(PageTest, AFolderThatCannotBeMadeIsNamed) {
  std::filesystem::create_directories(dir_);
  std::ofstream(dir_ / "file") << "in the way";
  try {
    write_page(bench::Report(), {}, dir_ / "file");
    FAIL() << "expected a SetupError";
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find((dir_ / "file").string()), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace tact::evidence
