#include "shapes/shapes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/session/temp_folder.hpp"
#include "common/shapes/closed_surface.hpp"

namespace tact {
namespace {

double polygon_area_across_flats(int n, double width) { return n * width * width / 4 * std::tan(std::numbers::pi / n); }

TEST(Shape, EveryShapeIsClosedOutwardAndWithoutDegenerateTriangles) {
  for (const auto& info : all_shapes()) {
    const Mesh mesh = make_shape(info.name, {});
    expect_closed(mesh, info.name);
    EXPECT_GT(volume(mesh), 0) << info.name;
    Eigen::AlignedBox3f box;
    for (const auto& v : mesh.vertices) box.extend(v);
    const double size = static_cast<double>(box.sizes().maxCoeff());
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
                 c = mesh.vertices[t[2]].cast<double>();
      const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
      ASSERT_GT((b - a).cross(c - a).norm() / longest, 1e-7 * size) << info.name;  // else the bake drops it
    }
  }
}

TEST(Shape, VolumesAreTheClosedForms) {
  EXPECT_NEAR(volume(make_shape("box", {{"size_x_m", 0.1}, {"size_y_m", 0.2}, {"size_z_m", 0.3}})), 0.006, 1e-9);
  const double base = 64 * 0.5 * 0.03 * 0.03 * std::sin(2 * std::numbers::pi / 64);
  EXPECT_NEAR(volume(make_shape("cone", {})), base * 0.04 / 3, 1e-10);
  EXPECT_NEAR(volume(make_shape("peg", {})), 0.02 * 0.02 * 0.05, 1e-10);
  EXPECT_NEAR(volume(make_shape("peg", {{"sides_count", 64}})), polygon_area_across_flats(64, 0.02) * 0.05, 1e-10);
  EXPECT_NEAR(volume(make_shape("socket", {})), 0.05 * 0.05 * 0.04 - 0.021 * 0.021 * 0.03, 1e-10);
  EXPECT_NEAR(volume(make_shape("socket", {{"sides_count", 64}})),
              polygon_area_across_flats(64, 0.05) * 0.04 - polygon_area_across_flats(64, 0.021) * 0.03, 1e-10);
  EXPECT_NEAR(volume(make_shape("gap", {})), 0.1 * 0.01 * (0.16 + 0.08), 1e-10);
  const double slope = std::tan(15 * std::numbers::pi / 180);
  EXPECT_NEAR(volume(make_shape("groove", {})), 0.04 * ((0.04 * slope + 0.02) * 2 * 0.06 - 0.04 * 0.04 * slope), 1e-10);
  EXPECT_NEAR(volume(make_shape("wedge", {})), 0.03 * (slope * (0.03 * 0.03 - 0.006 * 0.006) + 2 * 0.03 * slope * 0.03),
              1e-10);
  EXPECT_NEAR(volume(make_shape("two-walls", {})), 0.03 * (0.1 * 0.01 + 0.007 * 0.002), 1e-10);
}

TEST(Shape, SquarePegAndSocketAreAlignedWithTheAxes) {
  for (const auto& v : make_shape("peg", {}).vertices) {
    if (v.x() != 0 || v.y() != 0) {  // but for the middles of the ends
      EXPECT_NEAR(std::abs(v.x()), 0.01, 1e-8);
      EXPECT_NEAR(std::abs(v.y()), 0.01, 1e-8);
    }
  }
}

TEST(Shape, WrongNamesAndValuesAreOneErrorEach) {
  EXPECT_EQ(setup_error([] { make_shape("boxx", {}); }).find("shape: found \"boxx\", expected one of "), 0u);
  EXPECT_NE(setup_error([] { make_shape("boxx", {}); }).find("did you mean box?"), std::string::npos);
  EXPECT_EQ(setup_error([] {
              make_shape("box", {{"size_w_m", 1}});
            }),
            "shape box: size_w_m: found this unknown parameter, expected one of size_x_m size_y_m size_z_m; "
            "did you mean size_x_m?");
  EXPECT_EQ(setup_error([] {
              make_shape("box", {{"size_x_m", -1}});
            }),
            "shape box: size_x_m: found -1, expected a number from 1e-06 to 1000 (length along x)");
  EXPECT_EQ(setup_error([] {
              check_shape("box", {{"size_x_m", std::nan("")}});
            }),
            "shape box: size_x_m: found nan, expected a number from 1e-06 to 1000 (length along x)");
  EXPECT_EQ(setup_error([] {
              make_shape("cone", {{"sides_count", 7.5}});
            }),
            "shape cone: sides_count: found 7.5, expected a whole number from 3 to 4096 (sides of the base polygon)");
  EXPECT_EQ(setup_error([] {
              make_shape("socket", {{"hole_width_m", 0.05}});
            }),
            "shape socket: block_width_m: found 0.05, expected more than hole_width_m");
  EXPECT_EQ(setup_error([] {
              make_shape("two-walls", {{"span_m", 0.001}});
            }),
            "shape two-walls: span_m: found 0.001, expected walls that do not touch");
  // Three lines of a scene file that ask for 10^10 turns.
  EXPECT_EQ(setup_error([] {
              make_shape("bolt", {{"length_m", 1000}, {"pitch_m", 1e-7}});
            }),
            "shape bolt: length_m: found 1000, expected less: at most 500000 turns times sides_count");
  EXPECT_EQ(setup_error([] {
              make_shape("nut", {{"height_m", 6}, {"sides_count", 192}});
            }),
            "shape nut: height_m: found 6, expected less: at most 500000 turns times sides_count");
  EXPECT_EQ(setup_error([] { make_shape("nut", {{"height_m", 0.52}, {"sides_count", 1920}}); }), "no error");
}

}  // namespace
}  // namespace tact
