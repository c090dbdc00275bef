// tact-report: what `tact report` starts.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "evidence/page.hpp"
#include "fault/fault.hpp"

namespace {

using tact::evidence::Experiment;
using tact::evidence::experiments;

std::string list_of_experiments() {
  std::string list = "Experiments (default: all):\n";
  for (const Experiment& e : experiments()) {
    const std::string name = e.name;
    list += "  " + name + std::string(14 - std::min<std::size_t>(13, name.size()), ' ') + e.title + "\n";
  }
  return list;
}

int run_report(int argc, char** argv) {
  CLI::App app{"Repeats the figures of the paper, measures speed against error, and writes it all as one page",
               "tact report"};
  app.get_formatter()->column_width(28);
  std::vector<std::string> names;
  tact::bench::Effort effort;
  std::string out;
  app.add_option("NAME", names, "Experiments to run, see below");
  app.add_option("-o,--out", out, "Folder for index.html, data/*.csv and plots/*; made when missing")
      ->required()
      ->type_name("DIR");
  app.add_flag("--quick", effort.quick, "Coarser scenes and fewer cases: a minute or two for all");
  app.footer(list_of_experiments() +
             "Tables are the same on every machine, except those of times. A full run takes half an hour or so\n"
             "and bakes what is not yet in the cache.\n"
             "Examples:\n  tact report --quick --out evidence\n  tact report fig-2 fig-7 --out evidence");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    throw tact::SetupError(std::string(e.what()) + " (tact report --help)");
  }
  const auto all = experiments();
  for (const auto& name : names) {
    if (std::none_of(all.begin(), all.end(), [&](const Experiment& e) { return name == e.name; })) {
      throw tact::SetupError("no experiment '" + name + "' (tact report --help lists them)");
    }
  }
  std::vector<const Experiment*> chosen;
  for (const Experiment& e : all) {
    if (names.empty() || std::find(names.begin(), names.end(), e.name) != names.end()) chosen.push_back(&e);
  }
  tact::bench::Report report(std::filesystem::path(out) / "plots");
  tact::evidence::Making making{TACT_VERSION, "tact report", effort.quick};
  for (int i = 1; i < argc; ++i) making.command += std::string(" ") + argv[i];
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    std::fprintf(stderr, "[%zu/%zu] %s\n", i + 1, chosen.size(), chosen[i]->title);
    report.begin(chosen[i]->name);
    chosen[i]->run(effort, report);
    report.end();
    // After each: a run that is stopped has shown what it had.
    tact::evidence::write_page(report, making, out);
  }
  std::printf("\n%s\n", (std::filesystem::path(out) / "index.html").c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_report(argc, argv);
  } catch (const tact::SetupError& e) {
    std::fprintf(stderr, "tact report: %s\n", e.what());
    return 2;
  }
}
