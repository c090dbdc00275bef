#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace tact {

/// No byte out of place: neither stray, nor missing, nor a longer form than needed, nor a surrogate.
bool is_utf8(std::string_view text);

/// What came from outside, for a message: control characters and bytes that are not UTF-8 escaped ("\\x0a"), cut after
/// `most` bytes, then "... (N bytes)". Whoever reads the message sees one line, whatever a hostile file holds.
std::string one_line(std::string_view text, std::size_t most = 120);
std::string quoted_line(std::string_view text, std::size_t most = 120);  ///< the same in quotes

}  // namespace tact
