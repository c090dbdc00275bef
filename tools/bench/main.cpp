// tact-bench: what `tact bench` starts. A program of its own, so that only it needs the libraries it compares with.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "bench/bake.hpp"
#include "bench/benchmarks.hpp"
#include "fault/fault.hpp"

namespace {

struct Benchmark {
  const char *name, *what;
  void (*run)(const tact::bench::Effort&, tact::bench::Report&);
};
constexpr Benchmark kBenchmarks[] = {
    {"contact", "A contact tick, pose to wrench, against FCL", tact::bench::bench_contact},
    {"sample", "One value of the distance field, against OpenVDB's box sampler", tact::bench::bench_sample},
    {"bake", "Mesh to field, against OpenVDB's meshToVolume: time, memory, error, sign", tact::bench::bench_bake},
    {"laws", "Cost of each law by contacts", tact::bench::bench_laws},
    {"stability", "Largest stable stiffness by law, coupling, mode, rate and delay, in lockstep",
     tact::bench::bench_stability},
    {"judgement", "Laws at equal stability margin: depth, force steps, net stiffness", tact::bench::bench_judgement},
    {"work", "Work of the contact wrench round closed paths, by law", tact::bench::bench_work},
    {"growth", "Tick time by points, voxels and contacts", tact::bench::bench_growth},
    {"limit", "What memory and clock allow a sample and a tick, and how near they are", tact::bench::bench_limit},
    {"start", "Files in the cache to first wrench", tact::bench::bench_start},
    {"accuracy", "Time and error by resolution, points and law", tact::bench::bench_accuracy},
    {"cluster", "Contacts that law cluster leaves, by distance", tact::bench::bench_cluster},
    {"gradient", "What G foretells of the next wrench, and what weights do, by law", tact::bench::bench_gradient},
    {"walls", "What thin parts bear, and closed paths through them, by direction of force", tact::bench::bench_walls},
    {"assemblies", "Pegs, a screw, an engine's part, scans: play, pitch, depth against what is exact",
     tact::bench::bench_assemblies},
    {"wedge", "Stiffness felt of a wedge against its angle, by law and eigen-filtered", tact::bench::bench_wedge},
};

int run_bench(int argc, char** argv) {
  CLI::App app{"Measures Tact, beside FCL and OpenVDB where they do the same, in the same run", "tact bench"};
  app.get_formatter()->column_width(28);
  std::vector<std::string> names;
  tact::bench::Effort effort;
  std::string json, plots;
  std::string known = "Benchmarks (default: all):\n";
  for (const Benchmark& b : kBenchmarks) {
    known += "  " + std::string(b.name) + std::string(11 - std::string(b.name).size(), ' ') + b.what + "\n";
  }
  app.add_option("NAME", names, "Benchmarks to run, see below");
  app.add_flag("--quick", effort.quick, "Smaller cases, fewer repetitions");
  app.add_option("--json", json, "Write all tables and bars to this file too");
  app.add_option("--plot", plots, "Draw the charts of what was found in this folder; stability.csv has every search")
      ->type_name("DIR");
  app.footer(
      known +
      "Times are medians and 99th percentiles of calls that take turns with the peer's. Exit status 0, or 3 when\n"
      "a bar is missed (it is a measurement: other work on the machine makes it worse).\n"
      "Examples:\n  tact bench\n  tact bench contact sample --json bench.json\n  tact bench growth stability --plot "
      ".\n  tact "
      "bench --quick");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    throw tact::SetupError(std::string(e.what()) + " (tact bench --help)");
  }
  for (const auto& name : names) {
    if (std::none_of(std::begin(kBenchmarks), std::end(kBenchmarks), [&](auto& b) { return name == b.name; })) {
      throw tact::SetupError("no benchmark '" + name + "' (tact bench --help lists them)");
    }
  }
  tact::bench::Report report(plots);
  for (const Benchmark& b : kBenchmarks) {
    if (!names.empty() && std::find(names.begin(), names.end(), b.name) == names.end()) continue;
    report.begin(b.name);
    b.run(effort, report);
    report.end();
  }
  if (!json.empty()) report.write_json(json);
  return report.missed() == 0 ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 5 && std::string(argv[1]) == "--bake-child") {
      return tact::bench::bake_child(argv[2], argv[3], std::atoi(argv[4]));
    }
    return run_bench(argc, argv);
  } catch (const tact::SetupError& e) {
    std::fprintf(stderr, "tact bench: %s\n", e.what());
    return 2;
  }
}
