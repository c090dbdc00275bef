// What the server finds in its cache. The first byte is the kind of file; the rest becomes its contents. Of binary
// files it is the payload, sealed properly, so that the fuzzer need not guess checksums (the header itself:
// tests/contact/bake/damaged_files_test.cpp). What a loader accepts is used as a server uses it. See README.md.
#include <algorithm>
#include <iterator>

#include "contact/bake/bake_report.hpp"
#include "contact/use_loaded.hpp"
#include "fault/fault.hpp"
#include "field/field_file.hpp"
#include "file/sealed_file.hpp"
#include "file/whole_file.hpp"
#include "fuzz/fuzz_target.hpp"

namespace tact::fuzz {
namespace {

void seal(const std::filesystem::path& file, const SealedKind& kind, std::span<const std::byte> payload) {
  write_sealed(file, kind, 1, {&payload, 1});
}

void load(char kind, const std::filesystem::path& file, std::span<const std::byte> contents) {
  switch (kind) {
    case 'f': {
      seal(file, kFieldKind, contents);
      const DistanceField field = DistanceField::open(file);
      if (test::use(field) > 0) broken("asked one by one and many at once, the field differs");
      if (!test::use(field, test::sound_shell())) broken("a contact of no point");
      break;
    }
    case 's': {
      seal(file, {{'S', 'H', 'E', 'L'}, 1, "pointshell"}, contents);
      const auto shell = std::make_shared<const contact::Pointshell>(contact::load_pointshell(file));
      if (!test::use(test::sound_field(), shell)) broken("a contact of no point");
      break;
    }
    case 'm': {
      seal(file, {{'M', 'E', 'S', 'H'}, 1, "mesh"}, contents);
      const Mesh mesh = load_mesh(file);
      volatile float sink = 0;
      for (const auto& t : mesh.triangles) {
        for (const std::uint32_t v : t) sink = sink + mesh.vertices.at(v).x();
      }
      break;
    }
    default: {
      write_whole(file, {reinterpret_cast<const char*>(contents.data()), contents.size()});
      const auto report =
          contact::read_bake_report(file, kind == 'o' ? contact::BakedPart::obstacle : contact::BakedPart::tool);
      if (kind == 'o' && !(report.voxel_m > 0)) broken("no voxel");
    }
  }
}

}  // namespace

bool try_input(std::span<const std::uint8_t> input) {
  static constexpr char kKinds[] = {'f', 's', 'm', 'o', 't'};  // field, shell, mesh; reports of obstacle and tool
  if (input.empty()) return false;
  const char* known = std::find(std::begin(kKinds), std::end(kKinds), static_cast<char>(input[0]));
  const char kind = known != std::end(kKinds) ? *known : kKinds[input[0] % std::size(kKinds)];
  const auto file = scratch() / "input";
  try {
    load(kind, file, std::as_bytes(input.subspan(1)));
    return true;
  } catch (const SetupError& refused) {
    expect_clear(refused.what(), file.string() + ": ");
    return false;
  }
}

}  // namespace tact::fuzz
