#pragma once
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "fault/fault.hpp"

namespace tact {

/// A folder of its own, gone with the test.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tact-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// The text of the SetupError that `action` throws; "no error" if it does not.
template <class Action>
std::string setup_error(Action&& action) {
  try {
    action();
  } catch (const SetupError& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace tact
