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

}  // namespace
}  // namespace tact::contact
