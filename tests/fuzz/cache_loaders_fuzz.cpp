// libFuzzer target for what the server maps. The first byte chooses the kind of file; the rest becomes its payload,
// properly sealed, so that the fuzzer need not guess checksums. Use: cmake --preset clang -DTACT_FUZZ=ON
// -DTACT_SANITIZE=address,undefined, build cache_loaders_fuzz, run it on a folder of seeds, e.g. payloads of baked
// files behind one byte.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "contact/model/pointshell.hpp"
#include "fault/fault.hpp"
#include "field/distance_field.hpp"
#include "field/field_file.hpp"
#include "mesh/mesh.hpp"

namespace {

void use(const tact::DistanceField& field) {
  const tact::Vec3 low = field.min_O(), size = field.max_O() - low;
  volatile double sink = 0;
  constexpr std::size_t kPoints = 64;
  double x[kPoints], y[kPoints], z[kPoints], out[6][kPoints];
  std::uint8_t flags[kPoints];
  for (int i = 0; i < static_cast<int>(kPoints); ++i) {
    const tact::Vec3 p = low + size.cwiseProduct(tact::Vec3(i % 4, i / 4 % 4, i / 16) / 3.0);
    sink = sink + field.sample(p).value_m + field.probe(p).clearance_m + field.lower_bound(p);
    x[i] = p.x();
    y[i] = p.y();
    z[i] = p.z();
  }
  const tact::DistanceField::Points points{x, y, z, kPoints};
  field.probe(points, out[0], out[1]);
  field.sample(points, {out[2], out[3], out[4], out[5], flags});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tact;
  if (size == 0) return 0;
  static const std::filesystem::path path =
      (std::filesystem::exists("/dev/shm") ? "/dev/shm/tact-fuzz-" : "/tmp/tact-fuzz-") + std::to_string(::getpid());
  const SealedKind kinds[] = {kFieldKind, {{'S', 'H', 'E', 'L'}, 1, "pointshell"}, {{'M', 'E', 'S', 'H'}, 1, "mesh"}};
  const int kind = data[0] % 3;
  const std::span<const std::byte> parts[] = {std::as_bytes(std::span(data + 1, size - 1))};
  write_sealed(path, kinds[kind], 1, parts);
  try {
    if (kind == 0) use(DistanceField::open(path));
    if (kind == 1) contact::load_pointshell(path);
    if (kind == 2) load_mesh(path);
  } catch (const SetupError&) {  // refused, as it should be
  }
  std::filesystem::remove(path);
  return 0;
}
