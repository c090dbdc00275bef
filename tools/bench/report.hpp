#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tact::bench {

/// Numbers as a person reads them: three significant digits, no exponent between 1e-4 and 1e6.
std::string number(double value);

/// What the benchmarks found: printed as it comes, kept for the JSON file.
class Report {
 public:
  using Row = std::vector<std::string>;

  void begin(const std::string& benchmark);
  /// A sentence under the heading: what was measured, how.
  void say(const std::string& sentence);
  void table(const Row& columns, const std::vector<Row>& rows);
  /// A measured number beside what it must reach. `at_least`: larger is better.
  void bar(const std::string& what, double measured, const std::string& unit, bool at_least, double required);
  /// Seconds spent since begin().
  void end();

  std::size_t missed() const { return missed_; }
  /// Throws SetupError when it cannot be written.
  void write_json(const std::filesystem::path& path) const;

 private:
  struct Table {
    Row columns;
    std::vector<Row> rows;
  };
  struct Bar {
    std::string what, unit;
    double measured, required;
    bool at_least, met;
  };
  struct Section {
    std::string name;
    std::vector<std::string> sentences;
    std::vector<Table> tables;
    std::vector<Bar> bars;
    double begun_s = 0, seconds = 0;
  };
  std::vector<Section> sections_;
  std::size_t missed_ = 0;
};

}  // namespace tact::bench
