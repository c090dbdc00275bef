#include "support/flight_file.hpp"

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace tact::test {
namespace {

class Row {
 public:
  Row(const std::map<std::string, std::size_t>& columns, const std::string& line) : columns_(columns) {
    std::istringstream in(line);
    std::string cell;
    while (std::getline(in, cell, ',')) cells_.push_back(cell);
  }
  std::uint64_t count(const std::string& name) const { return std::stoull(cells_.at(columns_.at(name))); }
  double number(const std::string& name) const { return std::stod(cells_.at(columns_.at(name))); }
  Vec3 vector(const std::string& name, const std::string& unit) const {
    return {number(name + "x_" + unit), number(name + "y_" + unit), number(name + "z_" + unit)};
  }
  Wrench wrench(const std::string& name) const { return {vector(name + "_f", "n"), vector(name + "_t", "nm")}; }
  Pose pose(const std::string& name) const {
    return {vector(name + "_", "m"),
            Quat(number(name + "_qw"), number(name + "_qx"), number(name + "_qy"), number(name + "_qz"))};
  }

 private:
  const std::map<std::string, std::size_t>& columns_;
  std::vector<std::string> cells_;
};

}  // namespace

std::vector<FlightTick> read_flight(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || line.rfind("# tact flight record, schema 1", 0) != 0) {
    throw std::runtime_error(file.string() + ": not a flight record");
  }
  std::getline(in, line);
  std::map<std::string, std::size_t> columns;
  std::istringstream names(line);
  for (std::string name; std::getline(names, name, ',');) columns.emplace(name, columns.size());
  std::vector<FlightTick> ticks;
  while (std::getline(in, line)) {
    const Row row(columns, line);
    FlightTick t;
    t.tick = row.count("tick");
    t.pose_seq = row.count("pose_seq");
    t.reply_seq = row.count("reply_seq");
    t.wrench_age_ticks = static_cast<std::uint32_t>(row.count("wrench_age_ticks"));
    t.faults = static_cast<std::uint32_t>(row.count("faults"));
    t.contact_count = static_cast<std::uint32_t>(row.count("contact_count"));
    t.F_contact_W = row.wrench("F_contact_W");
    t.F_sent_W = row.wrench("F_sent_W");
    t.X_WH = row.pose("X_WH");
    t.X_sent = row.pose("X_sent");
    ticks.push_back(t);
  }
  return ticks;
}

}  // namespace tact::test
