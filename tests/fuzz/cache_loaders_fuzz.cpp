// libFuzzer target for what the server maps. The first byte chooses the kind of file; the rest becomes its payload,
// properly sealed, so that the fuzzer need not guess checksums. What a loader accepts is used as a server uses it.
// `cache_loaders_fuzz --seeds FOLDER` writes a few sound payloads to start from. See README.md.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string>

#include "contact/bake/test_meshes.hpp"
#include "contact/model/pointshell.hpp"
#include "contact/traversal/traversal.hpp"
#include "fault/fault.hpp"
#include "field/distance_field.hpp"
#include "field/field_builder.hpp"
#include "field/field_file.hpp"
#include "mesh/mesh.hpp"

namespace {

using namespace tact;

const SealedKind kKinds[] = {kFieldKind, {{'S', 'H', 'E', 'L'}, 1, "pointshell"}, {{'M', 'E', 'S', 'H'}, 1, "mesh"}};

const FieldParts& ball() {
  static const FieldParts parts = sample_distance(make_grid(Vec3::Constant(-0.01), Vec3::Constant(0.01), 0.002),
                                                  [](const Vec3& p) { return p.norm() - 0.01; });
  return parts;
}

/// Two points, and below them three.
contact::Pointshell two_levels() {
  contact::Pointshell shell;
  for (int i = 0; i < 5; ++i) {
    shell.position_T.push_back(0.002f * Eigen::Vector3f(static_cast<float>(i), 1, -1));
    shell.normal_T.push_back(Eigen::Vector3f::UnitZ());
    shell.radius_m.push_back(i < 2 ? 0.01f : 0);
    shell.area_m2.push_back(1e-6f);
  }
  shell.child_begin = {2, 4, 5, 5, 5};
  shell.child_end = {4, 5, 5, 5, 5};
  shell.level_begin = {0, 2, 5};
  return shell;
}

std::filesystem::path scratch() {
  static const std::string path =
      (std::filesystem::exists("/dev/shm") ? "/dev/shm/tact-fuzz-" : "/tmp/tact-fuzz-") + std::to_string(::getpid());
  return path;
}

void write_seeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto keep = [&](const char* name, char kind) {
    std::ifstream in(scratch(), std::ios::binary);
    const std::string file{std::istreambuf_iterator<char>(in), {}};
    std::ofstream(folder / name, std::ios::binary) << kind << file.substr(64);  // the header is sealed anew
  };
  save_field(ball(), scratch(), 1);
  keep("field", 0);
  contact::save_pointshell(two_levels(), scratch());
  keep("shell", 1);
  save_mesh(test::torus_mesh(0.04, 0.015, 5, 4), scratch());
  keep("mesh", 2);
  std::filesystem::remove(scratch());
}

void use(const DistanceField& field) {
  const Vec3 low = field.min_O(), size = field.max_O() - low;
  volatile double sink = 0;
  constexpr std::size_t kPoints = 67;  // no multiple of any SIMD width
  double x[kPoints], y[kPoints], z[kPoints], out[6][kPoints];
  std::uint8_t flags[kPoints];
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto k = static_cast<int>(i);
    Vec3 p = low + size.cwiseProduct(Vec3(k % 4, k / 4 % 4, k / 16) / 3.0);
    if (i == 64) p = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    if (i == 65) p = Vec3(1e300, -1e300, 0);
    sink = sink + field.sample(p).value_m + field.probe(p).clearance_m + field.lower_bound(p);
    x[i] = p.x();
    y[i] = p.y();
    z[i] = p.z();
  }
  const DistanceField::Points points{x, y, z, kPoints};
  field.probe(points, out[0], out[1]);
  field.sample(points, {out[2], out[3], out[4], out[5], flags});
}

void use(contact::Pointshell shell) {
  static const DistanceField field = make_field(ball());
  contact::Traversal traversal(field, std::make_shared<const contact::Pointshell>(std::move(shell)));
  contact::ContactBuffer contacts(8);
  for (const double x : {0.0, 0.01, 1e6}) {
    Pose pose;
    pose.p = Vec3(x, 0, 0);
    traversal.find(pose, contacts);
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 3 && std::strcmp((*argv)[1], "--seeds") == 0) {
    write_seeds((*argv)[2]);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const int kind = data[0] % 3;
  const std::span<const std::byte> parts[] = {std::as_bytes(std::span(data + 1, size - 1))};
  write_sealed(scratch(), kKinds[kind], 1, parts);
  try {
    if (kind == 0) use(DistanceField::open(scratch()));
    if (kind == 1) use(contact::load_pointshell(scratch()));
    if (kind == 2) load_mesh(scratch());
  } catch (const SetupError&) {  // refused, as it should be
  }
  std::filesystem::remove(scratch());
  return 0;
}
