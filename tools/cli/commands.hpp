#pragma once
#include <string>
#include <vector>

#include "cli/run_options.hpp"

namespace tact::cli {

/// The subcommands of `tact`. Each returns the exit code; each throws SetupError for what a user can mend.
int run(const RunOptions& options);
int bake(const RunOptions& options, bool json);
int scenes(bool json);
int status(bool json);
int doctor(bool json);
/// Becomes the program tact-bench; returns never.
int bench(const std::vector<std::string>& arguments);

}  // namespace tact::cli
