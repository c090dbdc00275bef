#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "fault/fault.hpp"
#include "fault/text.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

constexpr std::string_view kHeader = "time_s,x_m,y_m,z_m,qw,qx,qy,qz";
constexpr std::size_t kColumns = 8;
constexpr double kUnitTolerance = 1e-3;  // four decimals in a file are enough
constexpr double kFar_m = 1e4;

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == s.npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

HandMotion load_hand_motion(const std::filesystem::path& csv) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(csv, ignored)) {
    throw SetupError(csv.string() + ": found no such file, expected a CSV file of poses");
  }
  std::ifstream in(csv);
  if (!in) throw SetupError(csv.string() + ": found an unreadable file, expected a CSV file of poses");

  HandMotion motion;
  std::size_t number = 0;
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw SetupError(csv.string() + ": line " + std::to_string(number) + ": found " + found + ", expected " + expected);
  };
  std::string raw;
  while (std::getline(in, raw)) {
    ++number;
    const std::string_view line = trimmed(raw);
    if (number == 1) {
      if (line != kHeader) refuse(quoted_line(line, 80), "the header " + std::string{kHeader});
      continue;
    }
    if (line.empty()) continue;
    double row[kColumns];
    std::size_t column = 0, begin = 0;
    while (begin <= line.size()) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      const std::string_view cell = trimmed(line.substr(begin, end - begin));
      if (column == kColumns) refuse("more than 8 columns", "8 numbers");
      double x = 0;
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
      if (error != std::errc{} || stop != cell.data() + cell.size() || !std::isfinite(x)) {
        refuse(quoted_line(cell, 40) + " in column " + std::to_string(column + 1), "a finite number");
      }
      row[column++] = x;
      begin = end + 1;
    }
    if (column != kColumns) refuse(std::to_string(column) + " columns", "8 numbers");
    if (row[0] < 0) refuse("time " + std::to_string(row[0]) + " s", "a time of 0 s or later");
    if (!motion.time_s.empty() && row[0] <= motion.time_s.back()) {
      refuse("time " + std::to_string(row[0]) + " s after " + std::to_string(motion.time_s.back()) + " s",
             "times that increase");
    }
    for (int i = 1; i <= 3; ++i) {
      if (std::abs(row[i]) > kFar_m) refuse(std::to_string(row[i]) + " m", "a position within 10 km");
    }
    const Quat q(row[4], row[5], row[6], row[7]);
    if (!(std::abs(q.norm() - 1) <= kUnitTolerance)) {
      refuse("a quaternion of norm " + std::to_string(q.norm()), "norm 1 within 0.001 (order w, x, y, z)");
    }
    motion.time_s.push_back(row[0]);
    motion.X_WM.push_back({{row[1], row[2], row[3]}, q.normalized()});
  }
  if (number == 0) {
    number = 1;
    refuse("an empty file", "the header " + std::string{kHeader});
  }
  if (motion.time_s.empty()) refuse("no pose after the header", "at least one row");
  return motion;
}

}  // namespace tact
