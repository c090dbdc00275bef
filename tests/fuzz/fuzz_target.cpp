#include "fuzz/fuzz_target.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace tact::fuzz {

void broken(const std::string& what) {
  std::fprintf(stderr, "broken: %s\n", what.c_str());
  std::abort();
}

void expect_clear(const std::string& message, const std::string& what) {
  const auto has = [&](const std::string& text) { return message.find(text) != std::string::npos; };
  if (std::any_of(message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
    broken("more than one line, or unprintable: " + message);
  }
  if (message.size() > 10000) broken("endless: " + message);
  if (message.rfind(what, 0) != 0) broken("does not begin with " + what + ": " + message);
  if (!has("expected ") && !has("delete it and bake again")) broken("does not say what to do: " + message);
}

const std::filesystem::path& scratch() {
  struct Folder {
    // Not in /dev/shm: what a killed fuzzer leaves there, the system tests take for a session's.
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
  };
  static const Folder folder;
  return folder.path;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace tact::fuzz
