#include "bench/report.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "fault/fault.hpp"
#include "report/gnuplot.hpp"

namespace tact::bench {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

const char* name(Holds holds) {
  return holds == Holds::yes ? "holds" : holds == Holds::partly ? "holds in part" : "does not hold";
}

std::string number(double value) {
  char text[32];
  const double size = std::fabs(value);
  if (size >= 1e6 || (size < 1e-4 && size > 0)) {
    std::snprintf(text, sizeof text, "%.2e", value);
  } else {
    const int digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4;
    std::snprintf(text, sizeof text, "%.*f", size == 0 ? 0 : digits, value);
  }
  return text;
}

Report::Report(std::filesystem::path pictures) : folder_(std::move(pictures)) {
  if (!draws()) return;
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed) throw SetupError(folder_.string() + ": cannot make this folder for pictures: " + failed.message());
}

std::filesystem::path Report::next_picture(const std::string& extension) const {
  const Section& section = sections_.back();
  return folder_ / (section.name + "-" + std::to_string(section.all<Picture>().size() + 1) + extension);
}

void Report::begin(const std::string& benchmark) {
  Section section;
  section.name = benchmark;
  section.begun_s = now_s();
  sections_.push_back(section);
  std::printf("\n== %s\n", benchmark.c_str());
}

void Report::say(const std::string& sentence) {
  add(sentence);
  std::printf("%s\n", sentence.c_str());
}

void Report::print(const Table& table) {
  const auto& [columns, rows, times] = table;
  add(table);
  std::vector<std::size_t> width;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    width.push_back(columns[c].size());
    for (const Row& row : rows) width[c] = std::max(width[c], row.at(c).size());
  }
  const auto print = [&](const Row& row) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const int w = static_cast<int>(width[c]);
      std::printf(c == 0 ? "  %-*s" : "  %*s", w, row[c].c_str());
    }
    std::printf("\n");
  };
  print(columns);
  for (const Row& row : rows) print(row);
  std::fflush(stdout);
}

void Report::bar(const std::string& what, double measured, const std::string& unit, bool at_least, double required) {
  const bool met = at_least ? measured >= required : measured <= required;
  missed_ += met ? 0 : 1;
  add(Bar{what, unit, measured, required, at_least, met});
  std::printf("  %-6s %s: %s %s (bar: at %s %s)\n", met ? "met" : "MISSED", what.c_str(), number(measured).c_str(),
              unit.c_str(), at_least ? "least" : "most", number(required).c_str());
  std::fflush(stdout);
}

void Report::claim(const std::string& theirs, const std::string& ours, Holds holds, const std::string& sentence) {
  add(Claim{theirs, ours, holds, sentence});
  std::printf("  said: %s\n  here: %s\n  %s: %s\n", theirs.c_str(), ours.c_str(), name(holds), sentence.c_str());
  std::fflush(stdout);
}

void Report::chart(const Chart& chart) {
  if (!draws() || chart.lines.empty()) return;
  constexpr const char* kColors[] = {"#2060c0", "#c03020", "#208040", "#8040a0",
                                     "#c08000", "#606060", "#00a0a0", "#a04060"};
  using report::Gnuplot;
  std::string commands, plots;
  for (std::size_t k = 0; k < chart.lines.size(); ++k) {
    const Chart::Line& line = chart.lines[k];
    const std::string data = "$line" + std::to_string(k);
    commands += data + " << EOD\n";
    for (const auto& [x, y] : line.points) {
      char row[64];
      std::snprintf(row, sizeof row, "%.9g %.9g\n", x, y);
      // A logarithm has no place for it.
      commands += (chart.log_x && x <= 0) || (chart.log_y && y <= 0) ? std::string("\n") : std::string(row);
    }
    commands += "EOD\n";
    plots += (k == 0 ? "plot " : ", ") + data + " using 1:2 with " +
             (line.dots                 ? "points pt 7 ps 0.7"
              : line.points.size() > 60 ? "lines lw 1.5"
                                        : "linespoints pt 7 ps 0.5 lw 1.5") +
             " lc rgb '" + kColors[k % std::size(kColors)] + "' title " + Gnuplot::quoted(line.name);
  }
  commands += "set title " + Gnuplot::quoted(chart.title) + " noenhanced\nset xlabel " +
              Gnuplot::quoted(chart.x_label) + " noenhanced\nset ylabel " + Gnuplot::quoted(chart.y_label) +
              " noenhanced\nset key outside right top noenhanced\nset grid lc rgb '#dddddd'\n";
  if (!chart.x_names.empty()) {
    commands += "set xtics rotate by -30 noenhanced (";
    for (std::size_t i = 0; i < chart.x_names.size(); ++i) {
      commands += (i > 0 ? ", " : "") + Gnuplot::quoted(chart.x_names[i]) + " " + std::to_string(i);
    }
    commands += ")\n";
  }
  if (chart.log_x) commands += "set logscale x\n";
  if (chart.log_y) commands += "set logscale y\n";
  const auto file = next_picture(".svg");
  Gnuplot gnuplot(file, 760, 360);
  std::fputs((commands + plots + '\n').c_str(), gnuplot.in());
  gnuplot.finish();
  add(Picture{file, chart.title});
}

void Report::end() { sections_.back().seconds = now_s() - sections_.back().begun_s; }

void Report::write_json(const std::filesystem::path& path) const {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (const Section& section : sections_) {
    Json tables = Json::array(), bars = Json::array();
    for (const Table& t : section.all<Table>()) tables.push_back({{"columns", t.columns}, {"rows", t.rows}});
    for (const Bar& b : section.all<Bar>()) {
      bars.push_back({{"what", b.what},
                      {"measured", b.measured},
                      {"unit", b.unit},
                      {b.at_least ? "at_least" : "at_most", b.required},
                      {"met", b.met}});
    }
    Json claims = Json::array();
    for (const Claim& c : section.all<Claim>()) {
      claims.push_back({{"said", c.theirs}, {"here", c.ours}, {"holds", name(c.holds)}, {"sentence", c.sentence}});
    }
    list.push_back({{"benchmark", section.name},
                    {"seconds", section.seconds},
                    {"notes", section.all<std::string>()},
                    {"tables", tables},
                    {"bars", bars},
                    {"claims", claims}});
  }
  const Json report{
      {"schema", 1}, {"processor", processor()}, {"cores", std::thread::hardware_concurrency()}, {"benchmarks", list}};
  std::ofstream out(path);
  out << report.dump(2) << '\n';
  if (!out.flush()) throw SetupError(path.string() + ": cannot write the benchmark report here");
}

}  // namespace tact::bench
