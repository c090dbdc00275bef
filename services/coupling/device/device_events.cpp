#include "coupling/device/device_events.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "fault/fault.hpp"
#include "fault/text.hpp"

namespace tact::coupling {
namespace {

constexpr std::array<const char*, kDeviceEvents> kNames{"grip-soft", "grip-stiff", "grip-absent", "dead-man", "e-stop",
                                                        "power",     "indexing",   "alarm",       "overheat", "lost",
                                                        "nan",       "jump",       "quaternion"};
constexpr const char* kHeader = "time_s,event,duration_s";

bool parse(const std::string& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value) && value >= 0;
}

bool parse(const std::string& line, TimedEvent& event) {
  const auto first = line.find(','), last = line.rfind(',');
  if (first == std::string::npos || first == last) return false;
  const std::string what = line.substr(first + 1, last - first - 1);
  std::size_t i = 0;
  while (i < kNames.size() && what != kNames[i]) ++i;
  if (i == kNames.size()) return false;
  event.event = static_cast<DeviceEvent>(i);
  return parse(line.substr(0, first), event.time_s) && parse(line.substr(last + 1), event.duration_s);
}

}  // namespace

const char* name(DeviceEvent event) noexcept { return kNames[static_cast<std::size_t>(event)]; }

std::vector<TimedEvent> load_device_events(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  if (!in) throw SetupError(csv.string() + ": found no such file, expected a CSV file of device events");
  const auto refuse = [&csv](int number, const std::string& found, const std::string& expected) {
    throw SetupError(csv.string() + ": line " + std::to_string(number) + ": found " + quoted_line(found) +
                     ", expected " + expected);
  };
  std::vector<TimedEvent> events;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line != kHeader) refuse(number, line, kHeader);
      continue;
    }
    if (line.empty()) continue;
    TimedEvent event;
    if (!parse(line, event)) {
      std::string known;
      for (const char* one : kNames) known += std::string(" ") + one;
      refuse(number, line, "seconds, an event of" + known + ", and seconds");
    }
    events.push_back(event);
  }
  if (events.empty()) refuse(1, line, std::string(kHeader) + " and at least one event");
  return events;
}

std::uint32_t active_events(const std::vector<TimedEvent>& events, double time_s) noexcept {
  std::uint32_t bits = 0;
  for (const TimedEvent& e : events) {
    if (time_s >= e.time_s && time_s < e.time_s + e.duration_s) bits |= 1u << static_cast<unsigned>(e.event);
  }
  return bits;
}

}  // namespace tact::coupling
