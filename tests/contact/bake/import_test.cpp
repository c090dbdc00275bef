// Scene graphs: where the nodes of a file put their parts.
#include "contact/bake/worker/import.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "contact/bake/worker/field_bake.hpp"
#include "fault/fault.hpp"
#include "support/process.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

const Vec3 kLow(1, 2, 3), kHigh(2, 4, 6);  // no plane or axis of symmetry through the origin

class Import : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path() / name, std::ios::binary) << text;
    return scratch_.path() / name;
  }

  /// A glTF of the box kLow..kHigh, mesh 0, in a file beside it.
  std::filesystem::path gltf(const std::string& nodes, const std::string& roots = "0") const {
    const Mesh box = test::box_mesh(kLow, kHigh);
    std::string bin(reinterpret_cast<const char*>(box.vertices.data()), 12 * box.vertices.size());
    bin.append(reinterpret_cast<const char*>(box.triangles.data()), 12 * box.triangles.size());
    write("box.bin", bin);
    return write("box.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + roots + R"(]}],
      "nodes":[)" + nodes + R"(],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "buffers":[{"uri":"box.bin","byteLength":240}],
      "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":144}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[1,2,3],"max":[2,4,6]},
                   {"bufferView":1,"componentType":5125,"count":36,"type":"SCALAR"}]})");
  }

  /// A COLLADA file of the same box, in centimetres and with z up, as it says.
  std::filesystem::path dae(const std::string& nodes) const {
    const Mesh box = test::box_mesh(kLow, kHigh);
    std::string positions, indices;
    for (const auto& v : box.vertices) {
      for (const float x : v) positions += std::to_string(x) + ' ';
    }
    for (const auto& t : box.triangles) {
      for (const auto i : t) indices += std::to_string(i) + ' ';
    }
    return write("box.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="box"><mesh>
<source id="p"><float_array id="pa" count="24">)" +
                                positions + R"(</float_array><technique_common>
<accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
                                indices + R"(</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
                                nodes + R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  }

  test::ScratchDir scratch_;
};

struct Box {
  Vec3 low = Vec3::Constant(1e9), high = -low;
};

/// Of the triangles from..from+11: one box of ours.
Box box_of(const Mesh& mesh, std::size_t from) {
  Box box;
  for (std::size_t t = from; t < from + 12; ++t) {
    for (const auto v : mesh.triangles[t]) {
      box.low = box.low.cwiseMin(mesh.vertices[v].cast<double>());
      box.high = box.high.cwiseMax(mesh.vertices[v].cast<double>());
    }
  }
  return box;
}

void expect_box(const Box& box, const Vec3& low, const Vec3& high) {
  EXPECT_NEAR((box.low - low).norm(), 0, 1e-6) << box.low.transpose();
  EXPECT_NEAR((box.high - high).norm(), 0, 1e-6) << box.high.transpose();
}

/// Sum of the signed volumes over the origin: negative when the triangles face inward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
               c = mesh.vertices[t[2]].cast<double>();
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

const char* const kQuarterTurn = R"("rotation":[0,0,0.7071067811865476,0.7071067811865476])";  // about z

TEST_F(Import, AMeshNamedByManyNodesIsThereAsOften) {
  const Mesh mesh = import_mesh(gltf(std::string(R"({"mesh":0},{"mesh":0,"translation":[10,0,0],)") + kQuarterTurn +
                                         R"(},{"children":[3],"scale":[2,2,2]},{"mesh":0,"translation":[0,0,10]})",
                                     "0,1,2"),
                                "m");
  ASSERT_EQ(mesh.triangles.size(), 36u);
  expect_box(box_of(mesh, 0), kLow, kHigh);
  expect_box(box_of(mesh, 12), Vec3(10 - 4, 1, 3), Vec3(10 - 2, 2, 6));  // (x, y) becomes (-y, x)
  expect_box(box_of(mesh, 24), 2 * (kLow + Vec3(0, 0, 10)), 2 * (kHigh + Vec3(0, 0, 10)));
  EXPECT_NEAR(volume(mesh), 6 + 6 + 8 * 6, 1e-4);
}

TEST_F(Import, PartsAreChosenByNodeOrMeshWithAllBelow) {
  const auto file = gltf(R"({"name":"shelf","children":[1,2]},{"name":"left","mesh":0},
    {"name":"right","mesh":0,"translation":[10,0,0],"children":[3]},{"name":"lid","mesh":0,"translation":[10,0,0]})");
  const auto part = [&](const char* names) { return import_mesh(file.string() + names, "m"); };
  EXPECT_EQ(part("").triangles.size(), 36u);
  EXPECT_EQ(part("#shelf").triangles.size(), 36u);
  ASSERT_EQ(part("#lid").triangles.size(), 12u);
  expect_box(box_of(part("#lid"), 0), kLow + Vec3(20, 0, 0), kHigh + Vec3(20, 0, 0));  // where its nodes put it
  EXPECT_EQ(part("#right").triangles.size(), 24u);
  EXPECT_EQ(part("#left#lid").triangles.size(), 24u);
  EXPECT_EQ(part("#!right").triangles.size(), 12u);
  EXPECT_EQ(part("#right#!lid").triangles.size(), 12u);
  EXPECT_THROW(part("#lid#!right"), SetupError);  // nothing is left
}

TEST_F(Import, APartThatIsNotThereIsToldWithThoseThatAre) {
  const auto file = gltf(R"({"name":"piston","mesh":0},{"name":"ring","mesh":0})", "0,1");
  try {
    import_mesh(file.string() + "#pistn", "m");
    FAIL();
  } catch (const SetupError& e) {
    EXPECT_EQ(std::string(e.what()).find(file.string() + ": found no part \"pistn\" in it, expected one of "), 0u);
    EXPECT_NE(std::string(e.what()).find("\"piston\""), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("did you mean piston?"), std::string::npos) << e.what();
  }
}

/// A mirror image faces outward like its original: else a mirrored part inside another would be taken for a cavity.
TEST_F(Import, AMirroredPartFacesOutward) {
  const Mesh mirrored = import_mesh(gltf(R"({"mesh":0,"scale":[-1,1,1]})"), "mm");
  expect_box(box_of(mirrored, 0), 1e-3 * Vec3(-2, 2, 3), 1e-3 * Vec3(-1, 4, 6));
  EXPECT_NEAR(volume(mirrored), 6e-9, 1e-14);
  const Mesh twice = import_mesh(gltf(R"({"children":[1],"scale":[-1,1,1]},{"mesh":0,"scale":[1,-1,1]})"), "m");
  EXPECT_NEAR(volume(twice), 6, 1e-5);

  // An assembly: the box, and a mirrored one wholly inside it.
  const Mesh nested =
      import_mesh(gltf(R"({"mesh":0},{"mesh":0,"scale":[-0.5,0.5,0.5],"translation":[2.25,1.5,2.25]})", "0,1"), "m");
  FieldReport report;
  const DistanceField field = make_field(bake_field(clean_soup(nested), {24, 4, 0}, {}, report));
  EXPECT_EQ(report.solids.solids, 2u);
  EXPECT_EQ(report.solids.cavities, 0u);
  EXPECT_EQ(report.solids.inverted_parts, 0u);
  EXPECT_LT(field.sample(Vec3(1.5, 3, 4.5)).value_m, 0);
}

/// COLLADA: the unit is the caller's, the axes are the file's own, and nodes turn, move and share.
TEST_F(Import, ColladaNodesAreWhereTheySay) {
  const Mesh mesh = import_mesh(dae(R"(
    <node id="a"><instance_geometry url="#box"/></node>
    <node id="b"><translate>10 0 0</translate><rotate>0 0 1 90</rotate>
      <node id="c"><matrix>-1 0 0 0  0 1 0 0  0 0 1 5  0 0 0 1</matrix><instance_geometry url="#box"/></node></node>)"),
                                "mm");
  ASSERT_EQ(mesh.triangles.size(), 24u);
  expect_box(box_of(mesh, 0), 1e-3 * kLow, 1e-3 * kHigh);
  // Mirrored to x in -2..-1, raised by 5, turned: (x, y) becomes (-y, x), moved by 10.
  expect_box(box_of(mesh, 12), 1e-3 * Vec3(10 - 4, -2, 8), 1e-3 * Vec3(10 - 2, -1, 11));
  EXPECT_NEAR(volume(mesh), 12e-9, 1e-14);
}

TEST_F(Import, NodesThatLeadNowhereAreRefused) {
  const auto refusal = [&](const std::filesystem::path& file) -> std::string {
    try {
      import_mesh(file, "m");
    } catch (const SetupError& error) {
      EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refusal(gltf(R"({"name":"far","mesh":0,"scale":[1e30,1,1],"translation":[1e38,0,0],"children":[]},
                            {"children":[0],"scale":[1e30,1e30,1e30]})",
                         "1"))
                .find("of node \"far\" is not finite"),
            std::string::npos);
  EXPECT_NE(refusal(dae(R"(<node id="n"><matrix>nan 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1</matrix>
                           <instance_geometry url="#box"/></node>)")),
            "accepted");
  EXPECT_NE(refusal(gltf(R"({"mesh":7})")), "accepted");
  EXPECT_NE(refusal(gltf(R"({"name":"no part"})")), "accepted");
  EXPECT_NE(refusal(gltf(R"({"children":[0],"mesh":0})")), "accepted");  // its own child
}

}  // namespace
}  // namespace tact::contact
