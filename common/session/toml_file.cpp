#include "session/toml_file.hpp"

#include <sys/stat.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "fault/fault.hpp"
#include "file/whole_file.hpp"

namespace tact::session {
namespace {

constexpr std::uintmax_t kLargestFile = 4u << 20;  // a configuration, not data

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

void flatten(const toml::table& table, const std::string& prefix, std::vector<Entry>& out) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string{key.str()};
    const auto* child = node.as_table();
    if (child && !child->empty()) {
      flatten(*child, name + ".", out);
    } else {
      out.push_back({name, value_of(node), static_cast<unsigned>(node.source().begin.line)});
    }
  }
}

/// No byte out of place: neither stray, nor missing, nor a longer form than needed, nor a surrogate.
bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
    const unsigned first = byte(i);
    const std::size_t more = first < 0x80 ? 0 : first >> 5 == 6 ? 1 : first >> 4 == 14 ? 2 : first >> 3 == 30 ? 3 : 4;
    if (more == 4) return false;
    unsigned code = more == 0 ? first : first & (0x3fu >> more);
    for (std::size_t k = 1; k <= more; ++k) {
      if (byte(i + k) >> 6 != 2) return false;
      code = code << 6 | (byte(i + k) & 0x3f);
    }
    constexpr unsigned kLeast[] = {0, 0x80, 0x800, 0x10000};
    if (code < kLeast[more] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return false;
    i += more + 1;
  }
  return true;
}

bool is_table_of(const std::string& name, const Keys& keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const Key& k) { return k.name.rfind(name + ".", 0) == 0; });
}

const Key* find(const Keys& keys, const std::string& name) {
  const auto it = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == name; });
  return it == keys.end() ? nullptr : &*it;
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

std::vector<Entry> read_toml(const std::filesystem::path& path) {
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
  if (std::filesystem::file_size(path, error) > kLargestFile) {
    throw SetupError(path.string() + ": found more than 4 MiB, expected a TOML file written by a person");
  }
  std::vector<Entry> entries;
  try {
    flatten(toml::parse_file(path.string()), "", entries);
  } catch (const toml::parse_error& e) {
    throw SetupError(path.string() + ": line " + std::to_string(e.source().begin.line) + ": found " +
                     std::string{e.description()} + ", expected valid TOML");
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.line < b.line; });
  return entries;
}

void apply(const std::vector<Entry>& entries, const Keys& keys, const std::filesystem::path& file) {
  for (const auto& entry : entries) {
    const Key* key = find(keys, entry.name);
    const auto* other = std::get_if<Other>(&entry.value);
    if (!key && other && other->description == "a table" && is_table_of(entry.name, keys)) continue;  // empty table
    const std::string where = file.string() + ": " + entry.name + ": found ";
    const std::string at_line = " at line " + std::to_string(entry.line);
    if (!key) {
      throw SetupError(where + "this unknown key" + at_line + ", expected " + expected_for_unknown(entry.name, keys));
    }
    if (!key->set(entry.value)) {
      throw SetupError(where + describe(entry.value) + at_line + ", expected " + key->expected);
    }
  }
}

void apply_text(const std::string& name, const std::string& text, const Keys& keys) {
  const Key* key = find(keys, name);
  if (!key) throw SetupError(name + ": found this unknown key, expected " + expected_for_unknown(name, keys));
  // The services read it from a TOML file, which holds nothing else.
  if (!is_utf8(text))
    throw SetupError(name + ": found text that is not UTF-8, expected " + key->expected + " in UTF-8");
  if (!key->set(parse(key->kind, text))) {
    throw SetupError(name + ": found \"" + text + "\", expected " + key->expected);
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
