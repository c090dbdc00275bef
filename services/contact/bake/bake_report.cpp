#include "contact/bake/bake_report.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "fault/fault.hpp"
#include "fault/text.hpp"

namespace tact::contact {
namespace {

using Json = nlohmann::json;
constexpr std::uintmax_t kLargestFile = 4u << 20;

/// Values by their place ("/field/voxel_m"), checked.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) refuse("", "no readable file", "the report of a bake");
    if (bytes > kLargestFile) refuse("", "more than 4 MiB", "the report of a bake");
    json_ = Json::parse(std::ifstream(path, std::ios::binary), nullptr, false);
    if (json_.is_discarded()) refuse("", "no JSON", "the report of a bake");
  }

  /// Not negative, or null where that is allowed.
  std::optional<double> measured(const char* place, bool may_be_null = true) const {
    const Json& value = at(place);
    if (may_be_null && value.is_null()) return std::nullopt;
    const double x = value.is_number() ? value.get<double>() : -1;
    if (!(x >= 0 && std::isfinite(x)))
      refuse_value(place, value, may_be_null ? "a length or null" : "a number from 0 on");
    return x;
  }
  double number(const char* place) const { return *measured(place, false); }
  std::uint64_t count(const char* place) const {
    const Json& value = at(place);
    if (!value.is_number_unsigned()) refuse_value(place, value, "a count");
    return value.get<std::uint64_t>();
  }
  std::vector<std::string> texts(const char* place) const {
    const Json& list = at(place);
    if (!list.is_array()) refuse_value(place, list, "a list of texts");
    std::vector<std::string> texts;
    for (const Json& value : list) {
      if (!value.is_string()) refuse_value(place, value, "texts");
      texts.push_back(one_line(value.get_ref<const std::string&>(), 4096));
    }
    return texts;
  }
  [[noreturn]] void refuse(const char* place, const std::string& found, const char* expected) const {
    throw SetupError(path_.string() + ": " + (*place == '/' ? place + std::string(": ") : "") + "found " + found +
                     ", expected " + expected + ": delete it and bake again");
  }

 private:
  const Json& at(const char* place) const {
    const Json::json_pointer pointer(place);
    if (!json_.contains(pointer)) refuse(place, "nothing", "what every bake says");
    return json_[pointer];
  }
  [[noreturn]] void refuse_value(const char* place, const Json& found, const char* expected) const {
    refuse(place, found.is_structured() ? found.type_name() : one_line(found.dump()), expected);
  }

  const std::filesystem::path& path_;
  Json json_;
};

std::optional<double> metres(std::optional<double> mm) { return mm ? std::optional(1e-3 * *mm) : std::nullopt; }

}  // namespace

BakeReport read_bake_report(const std::filesystem::path& path, BakedPart part) {
  const Reader read(path);
  BakeReport report;
  report.seconds = read.number("/seconds");
  report.peak_memory_bytes = read.count("/peak_memory_bytes");
  report.warnings = read.texts("/warnings");
  if (part == BakedPart::obstacle) {
    report.voxel_m = read.number("/field/voxel_m");
    if (report.voxel_m == 0) read.refuse("/field/voxel_m", "0", "a length");
    report.error_max_m = read.measured("/field/error_largest_m");
    report.error_rms_m = read.measured("/field/error_rms_m");
    report.thinnest_wall_m = metres(read.measured("/field/thinnest_wall_mm"));
    report.narrowest_gap_m = metres(read.measured("/field/narrowest_gap_mm"));
  } else {
    report.points = read.count("/shell/points");
    report.largest_gap_m = read.number("/shell/largest_gap_m");
  }
  return report;
}

}  // namespace tact::contact
