#pragma once
#include <filesystem>

namespace tact::record {

/// Draws a recording: forces, torque, tool and handle, depth and contacts, tick time and age of the wrench. Of a long
/// one every n-th tick, with its largest force and depth in between: 4000 points. Throws SetupError.
void plot(const std::filesystem::path& recording, const std::filesystem::path& png);

/// Every tick as a row of numbers, units in the column names, for other programs. Throws SetupError.
void write_csv(const std::filesystem::path& recording, const std::filesystem::path& csv);

}  // namespace tact::record
