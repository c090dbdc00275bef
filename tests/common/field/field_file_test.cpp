#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <limits>

#include "fault/fault.hpp"
#include "field/distance_field.hpp"
#include "field/field_builder.hpp"
#include "field/field_file.hpp"

namespace tact {
namespace {

class FieldFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("tact-field-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    path_ = folder_ / "ball.field";
    parts_ = sample_distance(make_grid(Vec3::Constant(-0.05), Vec3::Constant(0.05), 0.002),
                             [](const Vec3& p) { return p.norm() - 0.05; });
    save_field(parts_, path_, 42);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void poke(std::streamoff at, char value) const {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(at);
    file.put(value);
  }
  std::string refusal(std::uint64_t hash = 0) const {
    try {
      DistanceField::open(path_, hash);
    } catch (const SetupError& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string()), std::string::npos) << "names the file";
      return error.what();
    }
    return "accepted";
  }

  std::filesystem::path folder_, path_;
  FieldParts parts_;
};

TEST_F(FieldFile, ReadsBackWhatWasWritten) {
  const DistanceField field = DistanceField::open(path_, 42);
  const DistanceField memory = make_field(parts_, 42);
  EXPECT_EQ(field.content_hash(), 42u);
  EXPECT_EQ(field.voxel_m(), memory.voxel_m());
  EXPECT_GT(field.bytes(), 0u);
  for (double x = -0.07; x < 0.07; x += 0.0013) {
    const Vec3 p(x, 0.3 * x, 0.01);
    EXPECT_EQ(field.sample(p).value_m, memory.sample(p).value_m);
    EXPECT_EQ(field.sample(p).gradient, memory.sample(p).gradient);
    EXPECT_EQ(field.lower_bound(p), memory.lower_bound(p));
  }
}

TEST_F(FieldFile, IdenticalInputsMakeIdenticalFiles) {
  const auto again = folder_ / "again.field";
  save_field(parts_, again, 42);
  std::ifstream a(path_, std::ios::binary), b(again, std::ios::binary);
  const std::string x{std::istreambuf_iterator<char>(a), {}}, y{std::istreambuf_iterator<char>(b), {}};
  EXPECT_FALSE(x.empty());
  EXPECT_TRUE(x == y);
}

TEST_F(FieldFile, OutlivesItsDeletion) {
  const DistanceField field = DistanceField::open(path_);
  std::filesystem::remove(path_);
  EXPECT_NEAR(field.sample(Vec3(0.051, 0, 0)).value_m, 0.001, 1e-4);
}

TEST_F(FieldFile, MissingIsRefused) {
  std::filesystem::remove(path_);
  EXPECT_NE(refusal().find("No such file"), std::string::npos);
}

TEST_F(FieldFile, EmptyIsRefused) {
  std::filesystem::resize_file(path_, 0);
  EXPECT_NE(refusal().find("is empty"), std::string::npos);
}

TEST_F(FieldFile, TruncatedIsRefused) {
  for (const std::uintmax_t bytes : {std::filesystem::file_size(path_) - 1, std::uintmax_t{1000}, std::uintmax_t{10}}) {
    std::filesystem::resize_file(path_, bytes);
    EXPECT_NE(refusal().find("truncated"), std::string::npos);
  }
}

TEST_F(FieldFile, ForeignIsRefused) {
  poke(0, 'X');
  EXPECT_NE(refusal().find("foreign"), std::string::npos);
}

TEST_F(FieldFile, OldSchemaIsRefused) {
  poke(8, 99);
  EXPECT_NE(refusal().find("schema 99"), std::string::npos);
}

TEST_F(FieldFile, OneFlippedByteIsRefused) {
  const auto bytes = static_cast<std::streamoff>(std::filesystem::file_size(path_));
  for (const std::streamoff at : {std::streamoff{70}, bytes / 2, bytes - 1}) {
    save_field(parts_, path_, 42);
    char old = 0;
    {
      std::ifstream file(path_, std::ios::binary);
      file.seekg(at);
      file.get(old);
    }
    poke(at, static_cast<char>(old ^ 0x10));
    EXPECT_NE(refusal().find("damaged"), std::string::npos) << at;
  }
}

TEST_F(FieldFile, AnotherHashIsRefused) { EXPECT_NE(refusal(43).find("something else"), std::string::npos); }

TEST_F(FieldFile, AFolderIsRefused) {
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  EXPECT_NE(refusal().find("not a regular file"), std::string::npos);
}

/// A file with a good checksum can still lie about its blocks: a hostile cache must not make the server read astray.
TEST_F(FieldFile, BlocksThatAreNotThereAreRefused) {
  FieldParts lying = parts_;
  for (CoarseEntry& entry : lying.coarse) {
    if (entry.stored()) entry.slot_and_flags = static_cast<std::uint32_t>(lying.blocks.size());
  }
  save_field(lying, path_, 42);
  EXPECT_NE(refusal().find("not there"), std::string::npos);
}

TEST_F(FieldFile, PromisesOfDistanceThatAreNoneAreRefused) {
  const auto spoiled = [&](auto&& spoil) {
    FieldParts lying = parts_;
    spoil(lying.coarse[lying.coarse.size() / 2]);
    save_field(lying, path_, 42);
    return refusal().find("a promise of distance that is none: delete it and bake again") != std::string::npos;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(spoiled([](CoarseEntry& entry) { entry.level = kNan; }));
  EXPECT_TRUE(spoiled([](CoarseEntry& entry) { entry.tilt[1] = HalfFloat::toward_zero(kInf); }));
  EXPECT_TRUE(spoiled([](CoarseEntry& entry) { entry.tilt[2] = HalfFloat::toward_zero(kNan); }));
  EXPECT_TRUE(spoiled([](CoarseEntry& entry) { entry.inverse_slope = HalfFloat::toward_zero(2); }));
  EXPECT_TRUE(spoiled([](CoarseEntry& entry) { entry.inverse_slope = HalfFloat::toward_zero(-1); }));
  EXPECT_FALSE(spoiled([](CoarseEntry&) {}));
}

/// Found by tests/fuzz: so far from the origin a voxel is less than the rounding of a place, and the nearest place in
/// the grid was looked for without end.
TEST_F(FieldFile, AGridThatIsFarOffAnswersForEveryPlace) {
  for (const double off : {1e6, 1e20, -1e20, 1e300}) {
    FieldParts far = parts_;
    far.grid.min_O += Vec3::Constant(off);
    save_field(far, path_, 42);
    const DistanceField field = DistanceField::open(path_);
    for (const double at : {-1e300, -1e20, -1.0, 0.0, 1.0, 1e6, 1e20}) {
      for (const Vec3& p : {Vec3(at, 0, 0), Vec3(Vec3::Constant(at))}) {
        EXPECT_FALSE(std::isnan(field.lower_bound(p))) << off << " " << at;
        EXPECT_FALSE(std::isnan(field.probe(p).clearance_m)) << off << " " << at;
      }
    }
  }
}

TEST_F(FieldFile, UnwritableFolderIsOneClearError) {
  try {
    save_field(parts_, folder_ / "missing" / "x.field", 1);
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_NE(std::string(error.what()).find("cannot write: No such file"), std::string::npos);
  }
}

/// A limit on the file size fails a write half-way, as a full disk does.
TEST_F(FieldFile, AWriteThatFailsIsOneClearErrorAndLeavesNothing) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string message;
  try {
    save_field(parts_, folder_ / "big.field", 1);
  } catch (const SetupError& error) {
    message = error.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find("cannot write: File too large"), std::string::npos) << message;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);  // only the old file
}

}  // namespace
}  // namespace tact
