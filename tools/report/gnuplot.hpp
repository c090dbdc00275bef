#pragma once
#include <filesystem>
#include <string>

namespace tact::report {

/// Words of a user (titles, file names) as gnuplot reads them: inside single quotes, where only ' is special.
std::string quoted(const std::string& words);

/// Runs gnuplot on `commands`, its output a picture of that many pixels. Throws SetupError when gnuplot is missing or
/// fails, or the file cannot be written.
void draw(const std::string& commands, const std::filesystem::path& png, int width, int height);

}  // namespace tact::report
