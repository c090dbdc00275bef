// Random damage, with fixed seeds, to every kind of file that the server maps: refused with a reason, never a crash.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <random>

#include "contact/bake/worker/shell_bake.hpp"
#include "contact/use_loaded.hpp"
#include "fault/fault.hpp"
#include "field/distance_field.hpp"
#include "field/field_builder.hpp"
#include "field/field_file.hpp"
#include "mesh/mesh.hpp"
#include "support/process.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

struct Kind {
  const char* name;
  std::function<void(const std::filesystem::path&)> save, load;
};

std::vector<Kind> kinds() {
  return {{"field",
           [](const auto& path) {
             save_field(sample_distance(make_grid(Vec3::Constant(-0.02), Vec3::Constant(0.02), 0.002),
                                        [](const Vec3& p) { return p.norm() - 0.02; }),
                        path, 42);
           },
           [](const auto& path) {
             const DistanceField field = DistanceField::open(path);
             EXPECT_EQ(test::use(field), 0u);
             EXPECT_TRUE(test::use(field, test::sound_shell()));
           }},
          {"shell",
           [](const auto& path) {
             ShellReport report;
             save_pointshell(
                 bake_shell(clean_soup(test::box_mesh(Vec3::Zero(), Vec3(0.02, 0.01, 0.01))), {200, 4, 0}, {}, report),
                 path);
           },
           [](const auto& path) {
             EXPECT_TRUE(test::use(test::sound_field(), std::make_shared<const Pointshell>(load_pointshell(path))));
           }},
          {"mesh", [](const auto& path) { save_mesh(test::torus_mesh(0.04, 0.015, 20, 10), path); },
           [](const auto& path) { load_mesh(path); }}};
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What the loader says: "" when it accepts.
std::string answer(const Kind& kind, const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    kind.load(path);
  } catch (const SetupError& error) {
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST(DamagedFiles, TruncatedAnywhereOrWithBitsFlippedTheyAreRefused) {
  const test::ScratchDir scratch;
  for (const Kind& kind : kinds()) {
    const auto path = scratch.path() / kind.name;
    kind.save(path);
    const std::string sound = read(path);
    EXPECT_EQ(answer(kind, path, sound), "");
    std::mt19937 random(1);
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    for (int i = 0; i < 150; ++i) {
      const std::size_t cut = i < 70 ? static_cast<std::size_t>(i) : below(sound.size());
      EXPECT_NE(answer(kind, path, sound.substr(0, cut)), "") << kind.name << " cut to " << cut;
      EXPECT_NE(answer(kind, path, sound + sound.substr(0, cut + 1)), "") << kind.name << " longer by " << cut + 1;
      std::string bytes = sound;
      for (std::size_t k = 0; k <= below(4); ++k) {
        const std::size_t at = i % 2 == 0 ? below(200) : below(bytes.size());
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
      }
      if (bytes != sound) {
        EXPECT_NE(answer(kind, path, bytes), "") << kind.name;
      }
    }
  }
}

/// A checksum is no proof of good will: payloads that lie about themselves, sealed properly.
TEST(DamagedFiles, LiesWithAGoodChecksumAreRefusedOrHarmless) {
  const test::ScratchDir scratch;
  const std::pair<SealedKind, Kind> sealed[] = {{kFieldKind, kinds()[0]},
                                                {{{'S', 'H', 'E', 'L'}, 1, "pointshell"}, kinds()[1]},
                                                {{{'M', 'E', 'S', 'H'}, 1, "mesh"}, kinds()[2]}};
  for (const auto& [seal, kind] : sealed) {
    const auto path = scratch.path() / kind.name;
    kind.save(path);
    const std::string payload = read(path).substr(64);
    std::mt19937 random(7);
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    int refused = 0;
    for (int i = 0; i < 200; ++i) {
      std::string bytes = payload;
      for (std::size_t k = 0; k <= below(3); ++k) {
        bytes[below(i % 2 == 0 ? 64 : std::min<std::size_t>(2000, bytes.size()))] = static_cast<char>(below(256));
      }
      if (i % 5 == 0) bytes.resize(below(bytes.size()));
      const std::span<const std::byte> parts[] = {std::as_bytes(std::span(bytes))};
      write_sealed(path, seal, 1, parts);
      refused += answer(kind, path, read(path)).empty() ? 0 : 1;
    }
    EXPECT_GT(refused, 50) << kind.name;
  }
}

}  // namespace
}  // namespace tact::contact
