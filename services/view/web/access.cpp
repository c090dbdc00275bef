#include "view/web/access.hpp"

#include <sys/random.h>

#include <array>
#include <cstdio>

#include "fault/fault.hpp"

namespace tact::view {
namespace {

// Value of `name` in "a=1<separator>name=value"; empty: absent. Tokens are hexadecimal or typed by the user: no
// decoding.
std::string_view field(std::string_view list, std::string_view name, char separator) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(separator), list.size());
    std::string_view item = list.substr(0, end);
    list.remove_prefix(std::min(end + 1, list.size()));
    while (!item.empty() && item.front() == ' ') item.remove_prefix(1);
    if (item.size() > name.size() && item.substr(0, name.size()) == name && item[name.size()] == '=')
      return item.substr(name.size() + 1);
  }
  return {};
}

std::string_view without_port(std::string_view host) {
  const std::size_t bracket = host.rfind(']');
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || (bracket != std::string_view::npos && colon < bracket)) return host;
  return host.substr(0, colon);
}

bool is_loopback_name(std::string_view host) {
  const std::string_view name = without_port(host);
  return name == "localhost" || name == "[::1]" || name.substr(0, 4) == "127.";
}

std::string_view query_token(std::string_view target) {
  const std::size_t question = target.find('?');
  return question == std::string_view::npos ? std::string_view{} : field(target.substr(question + 1), "token", '&');
}

}  // namespace

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw SetupError("view: the kernel gave no random bytes for the access token");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    token += digits;
  }
  return token;
}

bool same_token(std::string_view given, std::string_view expected) {
  if (expected.empty() || given.size() != expected.size()) return false;
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (given[i] ^ expected[i]));
  }
  return difference == 0;
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

bool Access::token_in_query(std::string_view target) const { return same_token(query_token(target), token); }

Access::Verdict Access::judge(const Request& request) const {
  if (!request.origin.empty()) {
    const std::size_t scheme = request.origin.find("://");
    if (scheme == std::string_view::npos || request.origin.substr(scheme + 3) != request.host) return Verdict::refused;
  }
  if (token_in_query(request.target) || same_token(field(request.cookie, cookie_name, ';'), token))
    return Verdict::control;
  return loopback && is_loopback_name(request.host) ? Verdict::watch : Verdict::refused;
}

}  // namespace tact::view
