#pragma once
#include <string>
#include <string_view>

namespace tact::view {

/// 128 random bits from the kernel, in hexadecimal.
std::string make_token();

/// Compares in a time that depends on the lengths only, so that a token cannot be guessed letter by letter. An empty
/// `expected` fits nothing.
bool same_token(std::string_view given, std::string_view expected);

/// What a browser sent, as far as it decides who may do what. `target` is "/path?query".
struct Request {
  std::string_view target, host, origin, cookie;
};

/// Who may come in and what they may do. Watching needs the token unless the server is bound to loopback; changing
/// something always needs it. The token comes as "?token=..." or in the cookie that the page got when it was opened
/// with it.
struct Access {
  enum class Verdict { refused, watch, control };

  std::string token;
  std::string cookie_name;  ///< one for each port: cookies do not know ports
  bool loopback = true;

  /// Also refuses pages of other sites: an Origin other than the Host, and, without a token, a Host that is not a
  /// loopback name (a foreign name that was pointed at 127.0.0.1).
  Verdict judge(const Request& request) const;

  bool token_in_query(std::string_view target) const;
};

/// "/a/b?c" -> "/a/b".
std::string_view path_of(std::string_view target);

}  // namespace tact::view
