#include "mesh/mesh.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "fault/fault.hpp"

namespace tact {
namespace {

class MeshFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::string refusal() const {
    try {
      load_mesh(path_);
    } catch (const SetupError& error) {
      return error.what();
    }
    return "accepted";
  }

  std::filesystem::path path_ = std::filesystem::temp_directory_path() / ("tact-mesh-" + std::to_string(::getpid()));
  Mesh mesh_{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}}};
};

TEST_F(MeshFile, ReadsBackWhatWasWritten) {
  save_mesh(mesh_, path_);
  const Mesh back = load_mesh(path_);
  EXPECT_EQ(back.vertices, mesh_.vertices);
  EXPECT_EQ(back.triangles, mesh_.triangles);
}

TEST_F(MeshFile, AnEmptyMeshReadsBackEmpty) {
  save_mesh(Mesh{}, path_);
  EXPECT_TRUE(load_mesh(path_).triangles.empty());
}

TEST_F(MeshFile, MissingTruncatedForeignAndDamagedAreRefused) {
  EXPECT_NE(refusal().find("No such file"), std::string::npos);
  save_mesh(mesh_, path_);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 4);
  EXPECT_NE(refusal().find("truncated"), std::string::npos);
  std::ofstream(path_) << std::string(100, 'x');
  EXPECT_NE(refusal().find("foreign"), std::string::npos);
  save_mesh(mesh_, path_);
  {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(100);
    file.put('x');
  }
  EXPECT_NE(refusal().find("damaged"), std::string::npos);
}

TEST_F(MeshFile, VerticesThatAreNowhereAreRefused) {
  for (const float nowhere : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Mesh bad = mesh_;
    bad.vertices[2].y() = nowhere;
    save_mesh(bad, path_);
    EXPECT_NE(refusal().find("inconsistent: a vertex is nowhere: delete it and bake again"), std::string::npos);
  }
}

TEST_F(MeshFile, TrianglesOfMissingVerticesAreRefused) {
  mesh_.triangles.push_back({0, 1, 4});
  save_mesh(mesh_, path_);
  EXPECT_NE(refusal().find("not there"), std::string::npos);
}

}  // namespace
}  // namespace tact
