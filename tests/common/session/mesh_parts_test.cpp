#include "session/mesh_parts.hpp"

#include <gtest/gtest.h>

#include "common/session/temp_folder.hpp"

namespace tact {
namespace {

using Names = std::vector<std::string>;

TEST(MeshParts, AreNamedAfterTheFile) {
  const TempFolder folder;
  const std::string file = folder.write("engine.glb", "x").string();
  EXPECT_EQ(mesh_parts(file).file, file);
  EXPECT_TRUE(mesh_parts(file).only.empty());
  const MeshParts parts = mesh_parts(file + "#piston#group/ring#!pin#nodes[7]");
  EXPECT_EQ(parts.file, file);
  EXPECT_EQ(parts.only, (Names{"piston", "group/ring", "nodes[7]"}));
  EXPECT_EQ(parts.without, Names{"pin"});
}

TEST(MeshParts, AFileOrFolderMayHaveTheMarkInItsName) {
  const TempFolder folder;
  const std::string file = folder.write("part#1.stl", "x").string();
  EXPECT_EQ(mesh_parts(file).file, file);
  EXPECT_TRUE(mesh_parts(file).only.empty());
  EXPECT_EQ(mesh_parts(file + "#lid").file, file);
  EXPECT_EQ(mesh_parts(file + "#lid").only, Names{"lid"});
  std::filesystem::create_directory(folder.path() / "job#2");
  const std::string inner = folder.write("job#2/a.glb", "x").string();
  EXPECT_EQ(mesh_parts(inner + "#lid").file, inner);
}

TEST(MeshParts, AMissingFileIsNamedWithoutThem) {
  EXPECT_EQ(mesh_parts("/no#where/a.glb#lid").file, "/no#where/a.glb");
  EXPECT_EQ(mesh_parts("a.glb#lid").only, Names{"lid"});
}

}  // namespace
}  // namespace tact
