// From the files in the cache to the first wrench, as the contact server does it.
#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"
#include "contact/bake/baked_scene.hpp"

namespace tact::bench {

void bench_start(const Effort& effort, Report& report) {
  report.say(
      "Alpha, warm page cache: find and check the baked files, map the field, read the pointshell, make the pipeline, "
      "one tick in contact. Milliseconds.");
  const LoadedScene scene = load_scene_by_name("alpha");
  const auto pose = with_contacts(scene, poses_along(scene, "cheat", 20000, 0.003, 0.03, 22), 75, 130, 1).front();
  Timings look_up, field, shell, pipeline, all;
  for (std::size_t k = 0; k < effort.scaled(50); ++k) {
    all.add(seconds_of([&] {
      contact::BakedScene baked;
      LoadedScene fresh;
      fresh.spec = scene.spec;
      look_up.add(seconds_of([&] { baked = contact::ensure_baked(scene.spec, cache_dir(MachineSpec{})); }));
      field.add(seconds_of([&] { fresh.field = DistanceField::open(baked.obstacle.data, baked.obstacle.hash, true); }));
      shell.add(seconds_of([&] {
        fresh.shell =
            std::make_shared<const contact::Pointshell>(contact::load_pointshell(baked.tool.data, baked.tool.hash));
      }));
      pipeline.add(seconds_of([&] { keep(fresh.pipeline()->step(fresh.query(pose)).contact_count); }));
    }));
  }
  std::vector<Report::Row> rows;
  const auto row = [&](const char* what, const Timings& t) {
    rows.push_back({what, number(1e3 * t.median()), number(1e3 * t.percentile(0.99))});
  };
  row("look up and check", look_up);
  row("map the field", field);
  row("read the pointshell", shell);
  row("pipeline and first wrench", pipeline);
  row("all", all);
  report.times({"", "p50", "p99"}, rows);
  report.bar("cache to first wrench, median", 1e3 * all.median(), "ms", false, 100);
}

}  // namespace tact::bench
