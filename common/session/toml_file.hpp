#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "session/key.hpp"

namespace tact::session {

/// One assignment of a TOML file, its tables flattened to a dotted name, with the line it came from.
struct Entry {
  std::string name;
  Value value;
  unsigned line = 0;
};

/// All assignments in file order. Throws SetupError when the file cannot be read, is larger or is not TOML.
std::vector<Entry> read_toml(const std::filesystem::path& path, std::uintmax_t largest_kib = 128);

/// Gives every entry to its key. Throws SetupError "<file>: <key>: found ..., expected ..." at the first that is
/// unknown or refused.
void apply(const std::vector<Entry>& entries, const Keys& keys, const std::filesystem::path& file);

/// Gives one text to its key, as from a command line. Throws SetupError "<key>: found ..., expected ...".
void apply_text(const std::string& name, const std::string& text, const Keys& keys);

/// Writes all keys that are not at rest, one a line, atomically, readable by the owner only (a session holds a token).
void write_toml(const Keys& keys, const std::filesystem::path& path);

}  // namespace tact::session
