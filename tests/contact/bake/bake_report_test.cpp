#include "contact/bake/bake_report.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "fault/fault.hpp"
#include "support/process.hpp"

namespace tact::contact {
namespace {

constexpr const char* kObstacle =
    R"({"seconds": 1.5, "peak_memory_bytes": 1024, "warnings": ["a", "b\n"], "field": {"voxel_m": 0.002,
        "error_largest_m": 0.001, "error_rms_m": 1e-4, "thinnest_wall_mm": 3, "narrowest_gap_mm": null}})";
constexpr const char* kTool = R"({"seconds": 0, "peak_memory_bytes": 0, "warnings": [],
                                  "shell": {"points": 100, "largest_gap_m": 0.01}})";

class BakeReportFile : public testing::Test {
 protected:
  BakeReport read(const std::string& text, BakedPart part) const {
    std::ofstream(file_) << text;
    return read_bake_report(file_, part);
  }
  /// Without the file's name, which it begins with.
  std::string refusal(const std::string& text, BakedPart part = BakedPart::obstacle) const {
    try {
      read(text, part);
    } catch (const SetupError& error) {
      const std::string what = error.what(), file = file_.string() + ": ";
      EXPECT_EQ(what.rfind(file, 0), 0u) << what;
      return what.substr(file.size());
    }
    return "accepted";
  }
  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }

  const test::ScratchDir scratch_;
  const std::filesystem::path file_ = scratch_.path() / "report.json";
};

TEST_F(BakeReportFile, IsReadInMetresAndWithoutWhatWasNotMeasured) {
  const BakeReport obstacle = read(kObstacle, BakedPart::obstacle), tool = read(kTool, BakedPart::tool);
  EXPECT_EQ(obstacle.seconds, 1.5);
  EXPECT_EQ(obstacle.peak_memory_bytes, 1024u);
  EXPECT_EQ(obstacle.warnings, (std::vector<std::string>{"a", "b\\x0a"}));
  EXPECT_EQ(obstacle.voxel_m, 0.002);
  EXPECT_EQ(obstacle.error_max_m, 0.001);
  EXPECT_EQ(obstacle.error_rms_m, 1e-4);
  EXPECT_DOUBLE_EQ(obstacle.thinnest_wall_m.value(), 0.003);
  EXPECT_FALSE(obstacle.narrowest_gap_m.has_value());
  EXPECT_EQ(tool.points, 100u);
  EXPECT_EQ(tool.largest_gap_m, 0.01);
}

TEST_F(BakeReportFile, EveryMistakeIsOneErrorNamingFileKeyFoundAndWhatToDo) {
  const std::string end = ": delete it and bake again";
  EXPECT_EQ(refusal("{"), "found no JSON, expected the report of a bake" + end);
  EXPECT_EQ(refusal("[]"), "/seconds: found nothing, expected what every bake says" + end);
  EXPECT_EQ(refusal(kTool), "/field/voxel_m: found nothing, expected what every bake says" + end);
  EXPECT_EQ(refusal(kObstacle, BakedPart::tool), "/shell/points: found nothing, expected what every bake says" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "0.002", "0")), "/field/voxel_m: found 0, expected a length" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "0.002", "-1")), "/field/voxel_m: found -1, expected a number from 0 on" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "0.002", "null")),
            "/field/voxel_m: found null, expected a number from 0 on" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "1e-4", "\"x\"")),
            "/field/error_rms_m: found \"x\", expected a length or null" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "1024", "-1")), "/peak_memory_bytes: found -1, expected a count" + end);
  EXPECT_EQ(refusal(replaced(kTool, "100", "1e300"), BakedPart::tool),
            "/shell/points: found 1e+300, expected a count" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "[\"a\", \"b\\n\"]", "7")),
            "/warnings: found 7, expected a list of texts" + end);
  EXPECT_EQ(refusal(replaced(kObstacle, "\"a\"", "{}")), "/warnings: found object, expected texts" + end);
  std::filesystem::remove(file_);
  EXPECT_THROW(read_bake_report(file_, BakedPart::tool), SetupError);
}

/// Writing such a value out again takes one call a bracket.
TEST_F(BakeReportFile, AMillionBracketsAreOneShortError) {
  const std::string nested = std::string(1000000, '[') + std::string(1000000, ']');
  EXPECT_EQ(refusal(replaced(kObstacle, "0.002", nested)),
            "/field/voxel_m: found array, expected a number from 0 on: delete it and bake again");
  EXPECT_EQ(refusal(std::string(5000000, ' ')),
            "found more than 4 MiB, expected the report of a bake: delete it and bake again");
}

}  // namespace
}  // namespace tact::contact
