#include "session/key.hpp"

#include <algorithm>
#include <charconv>
#include <climits>
#include <cmath>
#include <utility>

#include "fault/nearest.hpp"

namespace tact::session {
namespace {

std::string shortest(double x) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, x).ptr;
  return {buffer, end};
}

template <class Number>
bool whole(const std::string& text, Number& out) {
  const char* first = text.data();
  const char* last = first + text.size();
  while (first != last && *first == ' ') ++first;
  while (first != last && last[-1] == ' ') --last;
  if (first != last && *first == '+') ++first;
  const auto [end, error] = std::from_chars(first, last, out);
  return error == std::errc{} && end == last && first != last;
}

/// "20s", "1.5min", "20"; NaN when it is not a time.
double seconds_of(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const double factor = unit.empty() || unit == "s" ? 1
                        : unit == "ms"              ? 1e-3
                        : unit == "min"             ? 60
                        : unit == "h"               ? 3600
                                                    : std::nan("");
  return error == std::errc{} ? number * factor : std::nan("");
}

}  // namespace

Key flag(std::string name, bool& member) {
  return {std::move(name), Kind::flag, "true or false",
          [&member](const Value& v) {
            if (!std::holds_alternative<bool>(v)) return false;
            member = std::get<bool>(v);
            return true;
          },
          [&member] { return std::optional<Value>{member}; }};
}

Key integer(std::string name, int& member, int lowest, int highest) {
  return {std::move(name), Kind::integer,
          "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest),
          [&member, lowest, highest](const Value& v) {
            const auto* i = std::get_if<std::int64_t>(&v);
            if (!i || *i < lowest || *i > highest) return false;
            member = static_cast<int>(*i);
            return true;
          },
          [&member] { return std::optional<Value>{std::int64_t{member}}; }};
}

Key number(std::string name, double& member, double lowest, double highest, const std::string& unit) {
  return {std::move(name), Kind::number,
          "a number from " + shortest(lowest) + " to " + shortest(highest) + (unit.empty() ? "" : " (" + unit + ")"),
          [&member, lowest, highest](const Value& v) {
            double x = std::nan("");
            if (const auto* i = std::get_if<std::int64_t>(&v)) x = static_cast<double>(*i);
            if (const auto* d = std::get_if<double>(&v)) x = *d;
            if (!(x >= lowest && x <= highest)) return false;  // written so that NaN is refused
            member = x;
            return true;
          },
          [&member] { return std::optional<Value>{member}; }};
}

Key duration(std::string name, double& member_s, double highest_s, const std::string& note) {
  Key key = number(std::move(name), member_s, 0, highest_s, "");
  key.kind = Kind::text;
  key.expected = "a time from 0 to " + shortest(highest_s) + " s such as 500ms, 20s, 2min or 1h (" + note + ")";
  key.set = [set = std::move(key.set)](const Value& v) {
    const auto* s = std::get_if<std::string>(&v);
    return set(s ? Value{seconds_of(*s)} : v);
  };
  return key;
}

Key text(std::string name, std::string& member, const std::string& what,
         std::function<bool(const std::string&)> valid) {
  return {std::move(name), Kind::text, what,
          [&member, valid = std::move(valid)](const Value& v) {
            const auto* s = std::get_if<std::string>(&v);
            if (!s || !valid(*s)) return false;
            member = *s;
            return true;
          },
          [&member] { return member.empty() ? std::nullopt : std::optional<Value>{member}; }};
}

Key choice(std::string name, std::string& member, std::initializer_list<const char*> choices) {
  std::vector<std::string> list(choices.begin(), choices.end());
  std::string what = "one of";
  for (const auto& c : list) what += " " + c;
  return text(std::move(name), member, what,
              [list](const std::string& s) { return std::find(list.begin(), list.end(), s) != list.end(); });
}

Key path(std::string name, std::filesystem::path& member, const std::filesystem::path& base, const std::string& what) {
  return {std::move(name), Kind::text, what,
          [&member, base](const Value& v) {
            const auto* s = std::get_if<std::string>(&v);
            if (!s || s->empty() || s->find('\0') != std::string::npos) return false;
            std::filesystem::path whole = (base / *s).lexically_normal();
            if (whole.native().size() >= PATH_MAX) return false;  // no system call would take it
            member = std::move(whole);
            return true;
          },
          [&member] { return member.empty() ? std::nullopt : std::optional<Value>{member.string()}; }};
}

Keys prefixed(const std::string& prefix, Keys keys) {
  for (auto& key : keys) key.name.insert(0, prefix);
  return keys;
}

void append(Keys& keys, Keys more) {
  keys.insert(keys.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

Value parse(Kind kind, const std::string& text) {
  switch (kind) {
    case Kind::flag:
      if (text == "true" || text == "on" || text == "yes") return true;
      if (text == "false" || text == "off" || text == "no") return false;
      break;
    case Kind::integer: {
      std::int64_t i = 0;
      if (whole(text, i)) return i;
      break;
    }
    case Kind::number: {
      double d = 0;
      if (whole(text, d)) return d;
      break;
    }
    case Kind::numbers: {
      std::vector<double> list;
      std::size_t begin = 0;
      while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        double d = 0;
        if (!whole(text.substr(begin, end - begin), d)) return text;
        list.push_back(d);
        begin = end + 1;
      }
      return list;
    }
    case Kind::text:
      break;
  }
  return text;
}

std::string describe(const Value& value) {
  struct {
    std::string operator()(bool b) const { return b ? "true" : "false"; }
    std::string operator()(std::int64_t i) const { return std::to_string(i); }
    std::string operator()(double d) const {
      const std::string s = shortest(d);
      return s.find_first_of(".en") == s.npos ? s + ".0" : s;  // else it would read like a whole number
    }
    std::string operator()(const std::string& s) const { return "\"" + s + "\""; }
    std::string operator()(const std::vector<double>& list) const {
      std::string out = "[";
      for (const double d : list) out += (out.size() > 1 ? ", " : "") + shortest(d);
      return out + "]";
    }
    std::string operator()(const Other& other) const { return other.description; }
  } visitor;
  return std::visit(visitor, value);
}

std::string expected_for_unknown(const std::string& name, const Keys& known) {
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const auto& key : known) names.push_back(key.name);
  if (const auto near = nearest(name, names)) return "a known key; did you mean " + *near + "?";
  // A key that only lost or changed its table: "law" for "contact.law".
  const std::string last = name.substr(name.rfind('.') + 1);
  for (const auto& candidate : names) {
    if (candidate.substr(candidate.rfind('.') + 1) == last) return "a known key; did you mean " + candidate + "?";
  }
  return "a known key (they are listed in common/session/README.md)";
}

}  // namespace tact::session
