// What memory and arithmetic of this machine allow, and how near a sample and a tick come.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <set>
#include <span>

#include "bench/band_points.hpp"
#include "bench/benchmarks.hpp"
#include "bench/counter.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"
#include "field/field_batch.hpp"

namespace tact::bench {
namespace {

constexpr std::size_t kLine = 64;

struct alignas(kLine) Line {
  std::uint64_t value[kLine / 8] = {};
};

/// What the machine can do: other work on it only makes it slower.
double fastest(const Timings& t) { return t.percentile(0.05); }
constexpr int kRounds = 21;

/// Lines of memory, read in random order.
struct Memory {
  std::span<const Line> line;
  std::vector<std::uint32_t> order;

  explicit Memory(std::span<const Line> lines) : line(lines), order(lines.size()) {
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(22));
  }
  /// Seconds a line, each address known only when the line before has come.
  double one_after_the_other() const {
    std::uint64_t nothing = 0, last = 0;
    asm volatile("" : "+r"(nothing));  // the compiler does not know that it is 0
    return rounds([&](std::uint32_t k) { last = line[k + (last & nothing)].value[0]; }, &last);
  }
  /// Seconds a line, as many under way together as the processor can.
  double together() const {
    std::uint64_t sum = 0;
    return rounds([&](std::uint32_t k) { sum += line[k].value[0]; }, &sum);
  }
  /// Seconds to read everything in order.
  double in_order() const {
    Timings t;
    for (int round = 0; round < kRounds; ++round) {
      t.add(seconds_of([&] {
        std::uint64_t sum = 0;
        for (const Line& l : line) sum += l.value[0];
        keep(sum);
      }));
    }
    return fastest(t);
  }

 private:
  template <class Read>
  double rounds(Read read, const std::uint64_t* result) const {
    Timings t;
    const std::size_t count = std::min<std::size_t>(order.size(), 100000);
    for (int round = 0; round < kRounds; ++round) {
      t.add(seconds_of([&] {
        for (std::size_t k = 0; k < count; ++k) read(order[k]);
        keep(*result);
      }));
    }
    return fastest(t) / static_cast<double>(count);
  }
};

/// The blocks of a field as lines.
std::span<const Line> blocks_of(const DistanceField& field) {
  const BatchView view = BatchAccess::view(field);
  const auto entries = static_cast<std::size_t>(view.slice) * static_cast<std::size_t>(view.cells[2] / kBlockCells);
  std::size_t stored = 0;
  for (const CoarseEntry& entry : std::span(view.coarse, entries)) stored += entry.stored() ? 1 : 0;
  return {reinterpret_cast<const Line*>(view.blocks), stored * sizeof(FieldBlock) / kLine};
}

/// Seconds of a clock cycle: a third of a multiplication that waits for the one before (on every x86-64 of these
/// years).
double cycle_s() {
  constexpr int kCount = 30000;
  Timings t;
  for (int round = 0; round < kRounds; ++round) {
    std::uint64_t x = 3;
    t.add(seconds_of([&] {
      for (int k = 0; k < kCount; ++k)
        asm volatile("imul %0, %0\n\timul %0, %0\n\timul %0, %0\n\timul %0, %0" : "+r"(x));
    }));
  }
  return fastest(t) / (4 * 3 * kCount);
}

/// Cache lines that answer a sample at p: of its coarse entry and of its eight corners.
std::size_t lines_of(const BatchView& field, const Vec3& p) {
  int cell[3];
  for (int a = 0; a < 3; ++a) cell[a] = static_cast<int>((p[a] - field.min_O[a]) * field.inverse_voxel);
  const CoarseEntry& entry =
      field.coarse[(cell[2] / kBlockCells) * field.slice + (cell[1] / kBlockCells) * field.row + cell[0] / kBlockCells];
  std::set<std::uintptr_t> lines{reinterpret_cast<std::uintptr_t>(&entry) / kLine};
  if (entry.stored()) {
    const std::int16_t* q = field.blocks[entry.slot()].q.data();
    for (int k = 0; k < 8; ++k) {
      const int i = FieldBlock::index(cell[0] % kBlockCells + (k & 1), cell[1] % kBlockCells + ((k >> 1) & 1),
                                      cell[2] % kBlockCells + (k >> 2));
      lines.insert(reinterpret_cast<std::uintptr_t>(q + i) / kLine);
    }
  }
  return lines.size();
}

std::string ns(double seconds) { return number(1e9 * seconds); }
std::string us(double seconds) { return number(1e6 * seconds); }
std::string each(const std::optional<double>& instructions, double count) {
  return instructions ? number(*instructions / count) : "not counted here";
}

void samples(const LoadedScene& scene, const Effort& effort, const Memory& blocks, Report& report) {
  constexpr std::size_t kBatch = 4096;
  const DistanceField& field = scene.field;
  auto points = points_near(scene.obstacle_O, field.band_m(), effort.scaled(100) * kBatch, 23);
  std::erase_if(points, [&](const Vec3& p) { return !field.sample(p).in_band; });
  points.resize(points.size() / kBatch * kBatch);
  std::vector<double> x, y, z;
  for (const Vec3& p : points) x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
  std::vector<double> value(kBatch), gx(kBatch), gy(kBatch), gz(kBatch);
  std::vector<std::uint8_t> flags(kBatch);
  const auto sample = [&](std::size_t begin, std::size_t count) {
    field.sample({&x[begin], &y[begin], &z[begin], count},
                 {value.data(), gx.data(), gy.data(), gz.data(), flags.data()});
    keep(value.data());
  };

  double lines = 0;
  const BatchView view = BatchAccess::view(field);
  for (const Vec3& p : points) lines += static_cast<double>(lines_of(view, p)) / static_cast<double>(points.size());
  Timings random, cached;
  for (std::size_t begin = 0; begin < points.size(); begin += kBatch) {
    random.add(seconds_of([&] { sample(begin, kBatch); }) / kBatch);
  }
  sample(0, kBatchChunk);
  for (std::size_t k = 0; k < effort.scaled(20000); ++k) {
    cached.add(seconds_of([&] {
                 for (int again = 0; again < 16; ++again) sample(0, kBatchChunk);
               }) /
               (16 * kBatchChunk));
  }
  InstructionCounter counter;
  const auto instructions = counter.count([&] {
    for (int again = 0; again < 100; ++again) sample(0, kBatchChunk);
  });

  const double limit = lines * blocks.together();
  report.times({"a sample, many at once", "ns", "limit", "times", "instructions"},
               {{"random points of the band", ns(random.median()), ns(limit), number(random.median() / limit), ""},
                {"the same 64 points again", ns(cached.median()), "", "", each(instructions, 100 * kBatchChunk)}});
  report.say("A random point needs " + number(lines) + " cache lines.");
}

void ticks(const LoadedScene& scene, const Effort& effort, const Memory& large, double cycle, Report& report) {
  const auto near = poses_along(scene, "cheat", 20000, 0.003, 0.03, 20);
  const auto poses = with_contacts(scene, near, 75, 130, effort.scaled(100));
  const auto pipeline = scene.pipeline();
  Timings warm, cold;
  for (const Pose& X_WM : poses) {
    const auto query = scene.query(X_WM);
    const auto tick = [&] { keep(pipeline->step(query).contact_count); };
    keep(large.in_order());
    cold.add(seconds_of(tick));
    for (int again = 0; again < 10; ++again) warm.add(seconds_of(tick));
  }
  InstructionCounter counter;
  const auto instructions = counter.count([&] {
    for (const Pose& X_WM : poses) keep(pipeline->step(scene.query(X_WM)).contact_count);
  });
  report.times({"tick, 75 to 130 contacts", "us", "cycles", "instructions"},
               {{"same pose again", us(warm.median()), number(warm.median() / cycle),
                 each(instructions, static_cast<double>(poses.size()))},
                {"after 64 MB of other reads", us(cold.median()), number(cold.median() / cycle), ""}});
}

}  // namespace

void bench_limit(const Effort& effort, Report& report) {
  const LoadedScene scene = load_scene_by_name("alpha");
  const std::vector<Line> megabyte(std::size_t{1} << 14), much(std::size_t{1} << 20);
  const Memory small(megabyte), blocks(blocks_of(scene.field)), large(much);
  const double cycle = cycle_s();
  report.say(
      "Alpha, field of " + number(1e-6 * static_cast<double>(scene.field.bytes())) +
      " MB. The limit of a sample is the cache lines it needs, at what lines of the field's blocks take when all "
      "are under way together, measured here (fastest of some rounds).");
  std::vector<Report::Row> rows;
  for (const auto& [what, memory] : {std::pair{"1 MB", &small}, {"the field's blocks", &blocks}, {"64 MB", &large}}) {
    rows.push_back({what, ns(memory->one_after_the_other()), ns(memory->together()),
                    number(1e-9 * static_cast<double>(memory->line.size() * kLine) / memory->in_order())});
  }
  report.times({"memory of", "ns a line, each after the other", "together", "in order, GB/s"}, rows);
  report.say("A clock cycle: " + number(1e9 * cycle) + " ns.");
  samples(scene, effort, blocks, report);
  ticks(scene, effort, large, cycle, report);
}

}  // namespace tact::bench
