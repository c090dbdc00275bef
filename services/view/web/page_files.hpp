#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace tact::view {

/// The files of the page, read once: a request can name only what is in here, so no path can lead out of the folder.
class PageFiles {
 public:
  struct File {
    std::string content, type;
  };

  /// Throws SetupError when the folder or its index.html cannot be read.
  explicit PageFiles(const std::filesystem::path& folder);

  /// "/" is index.html. Null: no such file.
  const File* find(std::string_view path) const;

 private:
  std::map<std::string, File, std::less<>> files_;
};

}  // namespace tact::view
