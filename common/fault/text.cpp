#include "fault/text.hpp"

namespace tact {
namespace {

/// Bytes of the character that begins `text`; 0 when there is none.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(0);
  const std::size_t more = first < 0x80 ? 0 : first >> 5 == 6 ? 1 : first >> 4 == 14 ? 2 : first >> 3 == 30 ? 3 : 4;
  if (text.empty() || more == 4) return 0;
  unsigned code = more == 0 ? first : first & (0x3fu >> more);
  for (std::size_t k = 1; k <= more; ++k) {
    if (byte(k) >> 6 != 2) return 0;
    code = code << 6 | (byte(k) & 0x3f);
  }
  constexpr unsigned kLeast[] = {0, 0x80, 0x800, 0x10000};
  if (code < kLeast[more] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return 0;
  return more + 1;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = character(text);
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string one_line(std::string_view text, std::size_t most) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<unsigned char>(text[at]);
    const std::size_t bytes = first < 0x20 || first == 0x7f ? 0 : character(text.substr(at));
    const std::string next =
        bytes > 0 ? std::string(text.substr(at, bytes)) : std::string{'\\', 'x', kHex[first >> 4], kHex[first & 15]};
    if (out.size() + next.size() > most) return out + "... (" + std::to_string(text.size()) + " bytes)";
    out += next;
    at += bytes > 0 ? bytes : 1;
  }
  return out;
}

std::string quoted_line(std::string_view text, std::size_t most) {
  std::string out = one_line(text, most);
  out.insert(0, 1, '"');
  return out += '"';
}

}  // namespace tact
