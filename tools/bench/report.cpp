#include "bench/report.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "fault/fault.hpp"

namespace tact::bench {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

}  // namespace

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

void Report::begin(const std::string& benchmark) {
  Section section;
  section.name = benchmark;
  section.begun_s = now_s();
  sections_.push_back(section);
  std::printf("\n== %s\n", benchmark.c_str());
}

void Report::say(const std::string& sentence) {
  sections_.back().sentences.push_back(sentence);
  std::printf("%s\n", sentence.c_str());
}

void Report::table(const Row& columns, const std::vector<Row>& rows) {
  sections_.back().tables.push_back({columns, rows});
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
  sections_.back().bars.push_back({what, unit, measured, required, at_least, met});
  std::printf("  %-6s %s: %s %s (bar: at %s %s)\n", met ? "met" : "MISSED", what.c_str(), number(measured).c_str(),
              unit.c_str(), at_least ? "least" : "most", number(required).c_str());
  std::fflush(stdout);
}

void Report::end() { sections_.back().seconds = now_s() - sections_.back().begun_s; }

void Report::write_json(const std::filesystem::path& path) const {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (const Section& section : sections_) {
    Json tables = Json::array(), bars = Json::array();
    for (const Table& t : section.tables) tables.push_back({{"columns", t.columns}, {"rows", t.rows}});
    for (const Bar& b : section.bars) {
      bars.push_back({{"what", b.what},
                      {"measured", b.measured},
                      {"unit", b.unit},
                      {b.at_least ? "at_least" : "at_most", b.required},
                      {"met", b.met}});
    }
    list.push_back({{"benchmark", section.name},
                    {"seconds", section.seconds},
                    {"notes", section.sentences},
                    {"tables", tables},
                    {"bars", bars}});
  }
  const Json report{
      {"schema", 1}, {"processor", processor()}, {"cores", std::thread::hardware_concurrency()}, {"benchmarks", list}};
  std::ofstream out(path);
  out << report.dump(2) << '\n';
  if (!out.flush()) throw SetupError(path.string() + ": cannot write the benchmark report here");
}

}  // namespace tact::bench
