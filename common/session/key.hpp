#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tact::session {

/// What a key can hold. `Other` is anything TOML has and we do not (dates, tables, arrays of text), described in words.
struct Other {
  std::string description;
};
using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, Other>;

enum class Kind { flag, integer, number, text, numbers };

/// One key bound to the object that holds it: the only place where name, type, range and member meet. Files, command
/// line, Parameter messages and saved sessions all go through it.
struct Key {
  std::string name;  ///< dotted: "contact.law"
  Kind kind;
  std::string expected;                       ///< completes "expected ...": "a number from 0 to 1 (m)"
  std::function<bool(const Value&)> set;      ///< false, and nothing changed, when the value is not as expected
  std::function<std::optional<Value>()> get;  ///< nothing: the key is at rest and is not written
};
using Keys = std::vector<Key>;

// Builders. The object outlives the key.
Key flag(std::string name, bool& member);
Key integer(std::string name, int& member, int lowest, int highest);
Key number(std::string name, double& member, double lowest, double highest, const std::string& unit);
/// Seconds, as a number or as text with ms, s, min or h: 20, "20s", "1.5min".
Key duration(std::string name, double& member_s, double highest_s, const std::string& note);
Key text(std::string name, std::string& member, const std::string& what, std::function<bool(const std::string&)> valid);
Key choice(std::string name, std::string& member, std::initializer_list<const char*> choices);
Key path(std::string name, std::filesystem::path& member, const std::filesystem::path& base, const std::string& what);

/// The same keys under a longer name.
Keys prefixed(const std::string& prefix, Keys keys);
void append(Keys& keys, Keys more);

/// "on" becomes true, "0.1, 0.2, 0.3" three numbers: a command line's text as a value of that kind. Text that does not
/// fit stays text, for the key to refuse.
Value parse(Kind kind, const std::string& text);

/// As a person would write it: "global" in quotes, numbers shortest, arrays in brackets.
std::string describe(const Value& value);

/// "expected a known key; did you mean contact.law?" or where to find all of them.
std::string expected_for_unknown(const std::string& name, const Keys& known);

}  // namespace tact::session
