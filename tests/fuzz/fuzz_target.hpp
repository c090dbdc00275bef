#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace tact::fuzz {

/// What a target does with one input: true when the product accepts it and can use it, false when it refuses it with
/// one clear error. Anything else ends the process: broken(), a signal, a sanitizer.
bool try_input(std::span<const std::uint8_t> input);

/// Says what does not hold, and aborts.
[[noreturn]] void broken(const std::string& what);

/// Of a refusal: one line, not endless, that names `what` (a file, or nothing) and says what to do. Else broken().
void expect_clear(const std::string& message, const std::string& what);

/// A folder of this process below $TMPDIR; gone when it ends.
const std::filesystem::path& scratch();

std::string read_file(const std::filesystem::path& path);

}  // namespace tact::fuzz
