// One value of the field, against OpenVDB's box sampler on the same lattice.
#include <algorithm>
#include <cmath>

#include "bench/band_points.hpp"
#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/peers/openvdb_peer.hpp"
#include "bench/scene.hpp"
#include "contact/bake/worker/field_bake.hpp"

namespace tact::bench {
namespace {

struct Error {
  double largest = 0, rms = 0;
};

}  // namespace

void bench_sample(const Effort& effort, Report& report) {
  constexpr std::size_t kBatch = 4096;
  constexpr unsigned kSeed = 21;
  const int cells = effort.quick ? 256 : 512;
  const LoadedScene scene = load_scene_by_name("alpha", [&](SceneSpec& spec) { spec.field_resolution = cells; });
  const DistanceField& field = scene.field;
  const VdbField vdb(scene.obstacle_O, field.min_O(), field.voxel_m(), field.band_m() / field.voxel_m());
  report.say("Alpha, " + std::to_string(cells) + " cells, field of " +
             number(1e-6 * static_cast<double>(field.bytes())) + " MB (OpenVDB " + VdbField::version() + ": " +
             number(1e-6 * static_cast<double>(vdb.bytes())) +
             " MB): points in the band; Tact gives value and gradient, OpenVDB's BoxSampler with one accessor the "
             "value; same lattice. Blocks of " +
             std::to_string(kBatch) + " points, taking turns; ns a point, error in voxels against exact distances.");

  auto points = points_near(scene.obstacle_O, field.band_m(), effort.scaled(200) * kBatch, kSeed);
  std::erase_if(points, [&](const Vec3& p) { return !field.sample(p).in_band; });
  points.resize(points.size() / kBatch * kBatch);
  std::vector<float> theirs(points.size()), ours(points.size());

  // Errors.
  const auto soup = contact::split_soup(contact::clean_soup(scene.obstacle_O), 0);
  Error our_error, their_error;
  const std::size_t exact = effort.scaled(50000);
  vdb.sample(std::span(points).first(exact), std::span(theirs).first(exact));
  const double h = field.voxel_m();
  std::size_t in_band = 0;
  for (std::size_t i = 0; i < exact; ++i) {
    const double d = soup.signed_distance(points[i]);
    if (std::fabs(d) > field.band_m() - h) continue;
    const double a = (field.sample(points[i]).value_m - d) / h, b = (static_cast<double>(theirs[i]) - d) / h;
    our_error.largest = std::max(our_error.largest, std::fabs(a));
    their_error.largest = std::max(their_error.largest, std::fabs(b));
    our_error.rms += a * a;
    their_error.rms += b * b;
    ++in_band;
  }
  our_error.rms = std::sqrt(our_error.rms / static_cast<double>(in_band));
  their_error.rms = std::sqrt(their_error.rms / static_cast<double>(in_band));

  std::vector<Report::Row> rows;
  double random_ratio = 0;
  for (const bool coherent : {false, true}) {
    if (coherent) {  // neighbours in space follow one another, as points of a shell do
      std::sort(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
        const auto key = [&](const Vec3& p) {
          const Vec3 u = (p - field.min_O()) / (8 * h);
          return std::tuple(static_cast<int>(u.z()), static_cast<int>(u.y()), static_cast<int>(u.x()));
        };
        return key(a) < key(b);
      });
    }
    const auto batch = [&](auto& all, std::size_t i) { return std::span(all).subspan(i * kBatch, kBatch); };
    const auto peer = [&](std::size_t i) { vdb.sample(batch(points, i), batch(theirs, i)); };
    const auto one_by_one = [&](std::size_t i) {
      const auto in = batch(points, i);
      const auto out = batch(ours, i);
      for (std::size_t k = 0; k < kBatch; ++k) {
        const auto sample = field.sample(in[k]);
        keep(sample.gradient);
        out[k] = static_cast<float>(sample.value_m);
      }
    };
    std::vector<double> x(points.size()), y(points.size()), z(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) x[k] = points[k].x(), y[k] = points[k].y(), z[k] = points[k].z();
    std::vector<double> value(kBatch), gx(kBatch), gy(kBatch), gz(kBatch);
    std::vector<std::uint8_t> flags(kBatch);
    const auto many_at_once = [&](std::size_t i) {
      const std::size_t k = i * kBatch;
      field.sample({&x[k], &y[k], &z[k], kBatch}, {value.data(), gx.data(), gy.data(), gz.data(), flags.data()});
      keep(value.data());
    };
    const auto measure = [&](const char* how, auto&& call) {
      const Pair t = alternate(points.size() / kBatch, 5, call, peer);
      const auto ns = [&](double seconds) { return number(1e9 * seconds / kBatch); };
      rows.push_back({coherent ? "coherent" : "random", how, ns(t.ours.median()), ns(t.ours.percentile(0.99)),
                      ns(t.theirs.median()), ns(t.theirs.percentile(0.99)), number(t.ratio())});
      return t.ratio();
    };
    measure("one by one", one_by_one);
    const double ratio = measure("many at once", many_at_once);
    if (!coherent) random_ratio = ratio;
  }
  report.times({"points", "Tact asked", "Tact p50", "p99", "OpenVDB p50", "p99", "ratio"}, rows);
  report.times({"error, voxels", "largest", "rms"},
               {{"Tact", number(our_error.largest), number(our_error.rms)},
                {"OpenVDB", number(their_error.largest), number(their_error.rms)}});
  report.bar("field sample, random points in the band, many at once, OpenVDB / Tact", random_ratio, "x", true, 3);
  report.bar("rms error, Tact / OpenVDB", our_error.rms / their_error.rms, "", false, 1);
}

}  // namespace tact::bench
