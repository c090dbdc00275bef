#include "contact/bake/worker/soup.hpp"

#include <gtest/gtest.h>

#include "test_meshes.hpp"

namespace tact::contact {
namespace {

const Vec3 kLow(0, 0, 0), kHigh(0.03, 0.02, 0.01);

TEST(CleanSoup, ASoundBodyStaysAsItIs) {
  const Soup soup = clean_soup(test::box_mesh(kLow, kHigh));
  EXPECT_EQ(soup.report.triangles_kept, 12u);
  EXPECT_EQ(soup.mesh.vertices.size(), 8u);
  EXPECT_EQ(soup.report.boundary_edges + soup.report.non_manifold_edges + soup.report.flipped_edges, 0u);
  EXPECT_EQ(soup.report.components, 1u);
  EXPECT_EQ(soup.report.open_components, 0u);
}

TEST(CleanSoup, UnweldedCornersAreWelded) {
  const Soup soup = clean_soup(test::unwelded(test::torus_mesh(0.04, 0.015, 30, 20)));
  EXPECT_EQ(soup.mesh.vertices.size(), 600u);
  EXPECT_EQ(soup.report.boundary_edges, 0u);
  EXPECT_EQ(soup.report.components, 1u);
}

TEST(CleanSoup, DoublyFacedBodiesKeepOneOfEachPair) {
  const Soup soup = clean_soup(test::unwelded(test::doubly_faced(test::torus_mesh(0.04, 0.015, 30, 20))));
  EXPECT_EQ(soup.report.triangles_read, 2400u);
  EXPECT_EQ(soup.report.triangles_kept, 1200u);
  EXPECT_EQ(soup.report.duplicates_opposite, 1200u);
  EXPECT_EQ(soup.report.inner_walls, 0u);
  EXPECT_EQ(soup.report.boundary_edges, 0u);
}

TEST(CleanSoup, CopiesOfTheSameOrientationAreDropped) {
  Mesh mesh = test::box_mesh(kLow, kHigh);
  test::append(mesh, Mesh(mesh));
  const Soup soup = clean_soup(mesh);
  EXPECT_EQ(soup.report.duplicates_same, 12u);
  EXPECT_EQ(soup.report.triangles_kept, 12u);
}

TEST(CleanSoup, TheWallBetweenTouchingSolidsGoesAwayWhole) {
  Mesh mesh = test::box_mesh(Vec3(0, 0, 0), Vec3(1, 1, 1));
  test::append(mesh, test::box_mesh(Vec3(1, 0, 0), Vec3(2, 1, 1)));
  // The quads' diagonals must agree for the faces to coincide: mirror the second box's wall.
  const Soup soup = clean_soup(mesh);
  EXPECT_EQ(soup.report.duplicates_opposite, 2u);
  EXPECT_EQ(soup.report.inner_walls, 2u);
  EXPECT_EQ(soup.report.triangles_kept, 20u);
  EXPECT_EQ(soup.report.boundary_edges, 0u);
  EXPECT_EQ(soup.report.non_manifold_edges, 0u);
}

TEST(CleanSoup, TrianglesWithoutAreaAreDropped) {
  Mesh mesh = test::box_mesh(kLow, kHigh);
  mesh.triangles.push_back({0, 0, 1});
  const std::uint32_t half = test::add(mesh, 0.5 * (kLow + Vec3(0.03, 0, 0)));
  mesh.triangles.push_back({0, half, 1});
  const Soup soup = clean_soup(mesh);
  EXPECT_EQ(soup.report.degenerate, 2u);
  EXPECT_EQ(soup.report.triangles_kept, 12u);
}

TEST(CleanSoup, HolesFlipsAndPartsAreCounted) {
  Mesh mesh = test::box_mesh(kLow, kHigh);
  mesh.triangles.pop_back();
  mesh.triangles.pop_back();  // a side is missing
  test::append(mesh, test::flipped(test::sphere_mesh(Vec3(1, 0, 0), 0.02, 8), 1000));
  const Soup soup = clean_soup(mesh);
  EXPECT_EQ(soup.report.boundary_edges, 4u);
  EXPECT_EQ(soup.report.flipped_edges, 3u);
  EXPECT_EQ(soup.report.components, 2u);
  EXPECT_EQ(soup.report.open_components, 1u);
  EXPECT_EQ(soup.report.sheet_triangles, 10u);
}

/// A square plate of n by n cells, 1 thick, its upper face without the cells that `gone` names.
template <class Gone>
Mesh plate_with_holes(int n, Gone&& gone) {
  Mesh mesh;
  for (int z = 0; z <= 1; ++z) {
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) test::add(mesh, Vec3(x, y, z));
    }
  }
  const auto at = [&](int x, int y, int z) { return static_cast<std::uint32_t>((z * (n + 1) + y) * (n + 1) + x); };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int k = 0; k < n; ++k) {
    for (int x = 0; x < n; ++x) {
      if (!gone(x, k)) quad(at(x, k, 1), at(x + 1, k, 1), at(x + 1, k + 1, 1), at(x, k + 1, 1));
      quad(at(x, k, 0), at(x, k + 1, 0), at(x + 1, k + 1, 0), at(x + 1, k, 0));
    }
    quad(at(k, 0, 0), at(k + 1, 0, 0), at(k + 1, 0, 1), at(k, 0, 1));
    quad(at(k + 1, n, 0), at(k, n, 0), at(k, n, 1), at(k + 1, n, 1));
    quad(at(0, k + 1, 0), at(0, k, 0), at(0, k, 1), at(0, k + 1, 1));
    quad(at(n, k, 0), at(n, k + 1, 0), at(n, k + 1, 1), at(n, k, 1));
  }
  return mesh;
}

double area_of(const Soup& soup, const Hole& hole) {
  double area = 0;
  for (std::uint32_t k = hole.first; k < hole.first + hole.count; ++k) {
    const auto& t = soup.closed.caps[k];
    const Eigen::Vector3f a = soup.mesh.vertices[t[0]];
    area += 0.5 * static_cast<double>((soup.mesh.vertices[t[1]] - a).cross(soup.mesh.vertices[t[2]] - a).norm());
  }
  return area;
}

TEST(CleanSoup, HolesInAFaceAreClosedExactlyWhateverTheirShape) {
  // An L, two squares that touch in a corner, and one by itself.
  const auto gone = [](int x, int y) {
    return (x == 3 && y >= 3 && y <= 6) || (y == 3 && x >= 3 && x <= 6) || (x == 10 && y == 10) ||
           (x == 11 && y == 11) || (x == 15 && y == 4);
  };
  const Soup soup = clean_soup(plate_with_holes(20, gone));
  std::vector<double> areas;
  for (const Hole& hole : soup.closed.holes) areas.push_back(area_of(soup, hole));
  std::sort(areas.begin(), areas.end());
  ASSERT_EQ(areas.size(), 4u);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(areas[static_cast<std::size_t>(i)], 1, 1e-5);
  EXPECT_NEAR(areas[3], 7, 1e-5);  // no cap reaches over the corner
  for (const Hole& hole : soup.closed.holes) EXPECT_LT(hole.error_m, 1e-5);
  EXPECT_EQ(soup.report.open_components, 0u);
}

/// At the foot of a wall nobody knows whether the face or the wall went on.
TEST(CleanSoup, AHoleBesideAnEdgeMayBeWrongByItsWidth) {
  const auto error_m = [](auto&& gone) {
    const Soup soup = clean_soup(plate_with_holes(20, gone));
    EXPECT_EQ(soup.closed.holes.size(), 1u);
    return soup.closed.holes.at(0).error_m;
  };
  EXPECT_NEAR(error_m([](int x, int y) { return x == 0 && y == 9; }), 0.5, 1e-6);          // of a unit square
  EXPECT_NEAR(error_m([](int x, int y) { return x < 3 && y > 8 && y < 12; }), 1.5, 1e-6);  // of 3 by 3
  EXPECT_NEAR(error_m([](int x, int y) { return x == 9 && y > 4 && y < 12; }), 0, 1e-6);   // in the face
}

TEST(CleanSoup, LargeHolesAndTooManySmallOnesStayOpen) {
  const auto open = [](auto&& gone) { return clean_soup(plate_with_holes(20, gone)).report.open_components; };
  EXPECT_EQ(open([](int x, int y) { return x > 5 && x < 9 && y > 5 && y < 10; }), 0u);             // 12 of 880
  EXPECT_EQ(open([](int x, int y) { return x > 5 && x < 11 && y > 5 && y < 10; }), 1u);            // 20 of 868
  EXPECT_EQ(open([](int x, int y) { return x % 2 == 1 && y % 2 == 1 && x < 19 && y < 19; }), 0u);  // 81 of 799
  EXPECT_EQ(open([](int x, int y) { return x % 5 > 0 && y % 2 == 1; }), 1u);                       // 160 of 720, each 4
}

}  // namespace
}  // namespace tact::contact
