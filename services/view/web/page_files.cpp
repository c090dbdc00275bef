#include "view/web/page_files.hpp"

#include <fstream>
#include <iterator>

#include "fault/fault.hpp"

namespace tact::view {
namespace {

std::string type_of(const std::filesystem::path& file) {
  const std::string extension = file.extension();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".js") return "text/javascript; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  return "application/octet-stream";
}

}  // namespace

PageFiles::PageFiles(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(in), {}};
    files_[(std::filesystem::path("/") / entry.path().filename()).string()] = {std::move(content),
                                                                               type_of(entry.path())};
  }
  const auto index = files_.find("/index.html");
  if (error || index == files_.end())
    throw SetupError(folder.string() + ": no index.html here; the installation is not complete");
  files_["/"] = index->second;
}

const PageFiles::File* PageFiles::find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace tact::view
