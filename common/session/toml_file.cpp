#include "session/toml_file.hpp"

#include <sys/stat.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <unordered_map>

#include "fault/fault.hpp"
#include "fault/text.hpp"
#include "file/whole_file.hpp"

namespace tact::session {
namespace {

constexpr int kDeepest = 16;          // twice what our keys need
constexpr std::ptrdiff_t kDots = 64;  // in a line

/// toml++ frees tables within each other by recursion, and a dotted key is two bytes a table: what would run out of
/// stack is not given to it.
void check_dots(const std::string& text, const std::filesystem::path& path) {
  unsigned number = 1;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1, ++number) {
    end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == line.npos || line[first] == '#') continue;
    if (std::count(line.begin(), line.end(), '.') > kDots) {
      throw SetupError(path.string() + ": line " + std::to_string(number) + ": found more than " +
                       std::to_string(kDots) + " dots, expected shorter keys or text");
    }
  }
}

Value value_of(const toml::node& node) {
  if (const auto* v = node.as_boolean()) return v->get();
  if (const auto* v = node.as_integer()) return v->get();
  if (const auto* v = node.as_floating_point()) return v->get();
  if (const auto* v = node.as_string()) return v->get();
  if (const auto* array = node.as_array()) {
    std::vector<double> list;
    for (const auto& element : *array) {
      if (element.is_number()) list.push_back(*element.value<double>());
    }
    if (list.size() == array->size()) return list;
    return Other{"a list that is not of numbers"};
  }
  if (node.is_table()) return Other{"a table"};
  return Other{"a date or time"};
}

void flatten(const toml::table& table, const std::string& prefix, int depth, std::vector<Entry>& out) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string{key.str()};
    const auto* child = node.as_table();
    if (child && !child->empty()) {
      if (depth == kDeepest) {
        throw SetupError(one_line(name) + ": found more than " + std::to_string(kDeepest) +
                         " tables within each other at line " + std::to_string(node.source().begin.line) +
                         ", expected a known key");
      }
      flatten(*child, name + ".", depth + 1, out);
    } else {
      out.push_back({name, value_of(node), static_cast<unsigned>(node.source().begin.line)});
    }
  }
}

bool is_table_of(const std::string& name, const Keys& keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const Key& k) { return k.name.rfind(name + ".", 0) == 0; });
}

std::string quoted(const std::string& text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += "\\u00";
      out += {kHex[(c >> 4) & 15], kHex[c & 15]};
    } else {
      out += c;
    }
  }
  return out + "\"";
}

}  // namespace

std::vector<Entry> read_toml(const std::filesystem::path& path, std::uintmax_t largest_kib) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw SetupError(path.string() + ": found no such file, expected a readable TOML file");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw SetupError(path.string() + ": found something that is not a file, expected a readable TOML file");
  }
  if (::access(path.c_str(), R_OK) != 0) {
    throw SetupError(path.string() + ": found " + std::strerror(errno) + ", expected a readable TOML file");
  }
  if (std::filesystem::file_size(path, error) > largest_kib << 10) {
    throw SetupError(path.string() + ": found more than " + std::to_string(largest_kib) +
                     " KiB, expected a configuration, not data");
  }
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  check_dots(text, path);
  std::vector<Entry> entries;
  try {
    flatten(toml::parse(text), "", 1, entries);
  } catch (const SetupError& e) {
    throw SetupError(path.string() + ": " + e.what());
  } catch (const toml::parse_error& e) {
    throw SetupError(path.string() + ": line " + std::to_string(e.source().begin.line) + ": found " +
                     one_line(e.description(), 300) + ", expected valid TOML");
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.line < b.line; });
  return entries;
}

void apply(const std::vector<Entry>& entries, const Keys& keys, const std::filesystem::path& file) {
  std::unordered_map<std::string_view, const Key*> by_name;
  for (const Key& key : keys) by_name.emplace(key.name, &key);
  for (const auto& entry : entries) {
    const auto it = by_name.find(entry.name);
    const Key* key = it == by_name.end() ? nullptr : it->second;
    const auto* other = std::get_if<Other>(&entry.value);
    if (!key && other && other->description == "a table" && is_table_of(entry.name, keys)) continue;  // empty table
    const auto refuse = [&](const std::string& found, const std::string& expected) {
      throw SetupError(file.string() + ": " + one_line(entry.name) + ": found " + found + " at line " +
                       std::to_string(entry.line) + ", expected " + expected);
    };
    if (!key) refuse("this unknown key", expected_for_unknown(entry.name, keys));
    if (!key->set(entry.value)) refuse(one_line(describe(entry.value)), key->expected);
  }
}

void apply_text(const std::string& name, const std::string& text, const Keys& keys) {
  const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == name; });
  if (key == keys.end())
    throw SetupError(one_line(name) + ": found this unknown key, expected " + expected_for_unknown(name, keys));
  // The services read it from a TOML file, which holds nothing else.
  if (!is_utf8(text))
    throw SetupError(name + ": found text that is not UTF-8, expected " + key->expected + " in UTF-8");
  if (!key->set(parse(key->kind, text))) {
    throw SetupError(name + ": found " + quoted_line(text) + ", expected " + key->expected);
  }
}

void write_toml(const Keys& keys, const std::filesystem::path& path) {
  std::string out;
  for (const auto& key : keys) {
    if (const auto value = key.get()) {
      const auto* s = std::get_if<std::string>(&*value);
      out += key.name + " = " + (s ? quoted(*s) : describe(*value)) + "\n";
    }
  }
  write_whole(path, out, {.mode = S_IRUSR | S_IWUSR});  // it holds the token
}

}  // namespace tact::session
