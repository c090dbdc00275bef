#include <gtest/gtest.h>

#include "common/session/temp_folder.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

constexpr const char* kHeader = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n";

std::string error_of(const std::string& content) {
  TempFolder folder;
  const auto file = folder.write("h.csv", content);
  const std::string text = setup_error([&] { load_hand_motion(file); });
  EXPECT_EQ(text.rfind(file.string() + ": ", 0), 0u) << text;
  return text.substr(std::min(text.size(), file.string().size() + 2));
}

TEST(HandMotion, ReadsRowsAndNormalisesQuaternions) {
  TempFolder folder;
  const HandMotion m = load_hand_motion(
      folder.write("h.csv", std::string(kHeader) + "0,1,2,3,1,0,0,0\n0.5, -1e-3 ,0,0,0.70710,0.70710,0,0\r\n\n"));
  ASSERT_EQ(m.time_s.size(), 2u);
  EXPECT_EQ(m.time_s[1], 0.5);
  EXPECT_EQ(m.X_WM[0].p, Vec3(1, 2, 3));
  EXPECT_EQ(m.X_WM[1].p.x(), -1e-3);
  EXPECT_NEAR(m.X_WM[1].q.norm(), 1, 1e-15);
  EXPECT_NEAR(m.X_WM[1].q.x(), std::sqrt(0.5), 1e-12);
}

TEST(HandMotion, EveryMistakeNamesFileAndLine) {
  const std::string h = kHeader;
  EXPECT_EQ(error_of(""), "line 1: found an empty file, expected the header time_s,x_m,y_m,z_m,qw,qx,qy,qz");
  EXPECT_EQ(error_of("t,x\n0,0\n"), "line 1: found \"t,x\", expected the header time_s,x_m,y_m,z_m,qw,qx,qy,qz");
  EXPECT_EQ(error_of(h), "line 1: found no pose after the header, expected at least one row");
  EXPECT_EQ(error_of(h + "0,0,0,0,1,0,0\n"), "line 2: found 7 columns, expected 8 numbers");
  EXPECT_EQ(error_of(h + "0,0,0,0,1,0,0,0,0\n"), "line 2: found more than 8 columns, expected 8 numbers");
  EXPECT_EQ(error_of(h + "0,0,nan,0,1,0,0,0\n"), "line 2: found \"nan\" in column 3, expected a finite number");
  EXPECT_EQ(error_of(h + "0,inf,0,0,1,0,0,0\n"), "line 2: found \"inf\" in column 2, expected a finite number");
  EXPECT_EQ(error_of(h + "0,0,0,1e999,1,0,0,0\n"), "line 2: found \"1e999\" in column 4, expected a finite number");
  EXPECT_EQ(error_of(h + "0,0,\x1b\xff,0,1,0,0,0\n"),
            "line 2: found \"\\x1b\\xff\" in column 3, expected a finite number");
  EXPECT_EQ(error_of(std::string(100, 'x') + "\n"), "line 1: found \"" + std::string(80, 'x') +
                                                        "... (100 bytes)\", expected the header "
                                                        "time_s,x_m,y_m,z_m,qw,qx,qy,qz");
  EXPECT_EQ(error_of(h + "0,0,,0,1,0,0,0\n"), "line 2: found \"\" in column 3, expected a finite number");
  EXPECT_EQ(error_of(h + "0,0,1mm,0,1,0,0,0\n"), "line 2: found \"1mm\" in column 3, expected a finite number");
  EXPECT_EQ(error_of(h + "0,0,0,0,1,0,0,0\n1,0,0,0,1,1,0,0\n"),
            "line 3: found a quaternion of norm 1.414214, expected norm 1 within 0.001 (order w, x, y, z)");
  EXPECT_EQ(error_of(h + "0,0,0,0,0,0,0,0\n").find("line 2: found a quaternion of norm 0.0"), 0u);
  EXPECT_EQ(error_of(h + "1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"),
            "line 3: found time 1.000000 s after 1.000000 s, expected times that increase");
  EXPECT_EQ(error_of(h + "-1,0,0,0,1,0,0,0\n"), "line 2: found time -1.000000 s, expected a time of 0 s or later");
  EXPECT_EQ(error_of(h + "0,1e6,0,0,1,0,0,0\n"), "line 2: found 1000000.000000 m, expected a position within 10 km");
}

TEST(HandMotion, MissingFileIsNamed) {
  EXPECT_EQ(setup_error([] { load_hand_motion("/nowhere/h.csv"); }),
            "/nowhere/h.csv: found no such file, expected a CSV file of poses");
}

}  // namespace
}  // namespace tact
