#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "bench/report.hpp"
#include "evidence/experiments.hpp"

namespace tact::evidence {

/// What the page says of how it was made.
struct Making {
  std::string version, command;
  bool quick = false;
};

/// Writes <dir>/index.html, which needs no other file, and <dir>/data/<experiment>-<n>.csv, a file a table. Sections of
/// `report` are the experiments that ran, by name. Throws SetupError when it cannot write.
void write_page(const bench::Report& report, const Making& making, const std::filesystem::path& dir);

/// As it stands in HTML: <, >, &, quotes.
std::string escaped(const std::string& words);
std::string base64(const std::string& bytes);
/// A field of RFC 4180.
std::string csv_field(const std::string& words);

}  // namespace tact::evidence
