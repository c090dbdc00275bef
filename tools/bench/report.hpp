#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace tact::bench {

/// Numbers as a person reads them: three significant digits, no exponent between 1e-4 and 1e6.
std::string number(double value);

/// Lines or dots over one axis.
struct Chart {
  struct Line {
    std::string name;
    std::vector<std::array<double, 2>> points;  ///< x, y
    bool dots = false;
  };
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Line> lines = {};
  std::vector<std::string> x_names = {};  ///< of x = 0, 1, ...; none: numbers
};

/// Does what somebody says hold here?
enum class Holds { yes, partly, no };

/// What the benchmarks found: printed as it comes, kept for files.
class Report {
 public:
  using Row = std::vector<std::string>;
  struct Table {
    Row columns;
    std::vector<Row> rows;
    bool times;  ///< holds times: another machine gives other numbers
  };
  struct Bar {
    std::string what, unit;
    double measured, required;
    bool at_least, met;
  };
  struct Picture {
    std::filesystem::path file;
    std::string caption;
  };
  struct Claim {
    std::string theirs, ours;
    Holds holds;
    std::string sentence;
  };
  using Item = std::variant<std::string, Table, Bar, Picture, Claim>;  ///< a string is a sentence
  struct Section {
    std::string name;
    std::vector<Item> items;  ///< as they were said
    double begun_s = 0, seconds = 0;

    template <class T>
    std::vector<T> all() const {
      std::vector<T> some;
      for (const Item& item : items) {
        if (const T* one = std::get_if<T>(&item)) some.push_back(*one);
      }
      return some;
    }
  };

  /// `pictures`: folder to draw in, made here; empty: nothing is drawn.
  explicit Report(std::filesystem::path pictures = {});

  void begin(const std::string& benchmark);
  /// A sentence under the heading: what was measured, how.
  void say(const std::string& sentence);
  void table(const Row& columns, const std::vector<Row>& rows) { print({columns, rows, false}); }
  /// The same, of times.
  void times(const Row& columns, const std::vector<Row>& rows) { print({columns, rows, true}); }
  void chart(const Chart& chart);
  /// For a picture made by `draw`, which is called with the file to write. Not called when nothing is drawn.
  template <class Draw>
  void picture(const std::string& caption, const Draw& draw) {
    if (!draws()) return;
    const auto file = next_picture(".jpg");
    draw(file);
    add(Picture{file, caption});
  }
  /// A measured number beside what it must reach. `at_least`: larger is better.
  void bar(const std::string& what, double measured, const std::string& unit, bool at_least, double required);
  /// What [P] says, what we found, and a sentence on whether it holds.
  void claim(const std::string& theirs, const std::string& ours, Holds holds, const std::string& sentence);
  /// Seconds spent since begin().
  void end();

  std::size_t missed() const { return missed_; }
  bool draws() const { return !folder_.empty(); }
  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<Section>& sections() const { return sections_; }
  /// Throws SetupError when it cannot be written.
  void write_json(const std::filesystem::path& path) const;

 private:
  void add(const Item& item) { sections_.back().items.push_back(item); }
  void print(const Table& table);
  std::filesystem::path next_picture(const std::string& extension) const;

  std::filesystem::path folder_;
  std::vector<Section> sections_;
  std::size_t missed_ = 0;
};

const char* name(Holds holds);
/// Model name of the processor.
std::string processor();

}  // namespace tact::bench
