#include "session/mesh_parts.hpp"

namespace tact {

MeshParts mesh_parts(const std::filesystem::path& mesh) {
  const std::string text = mesh.string();
  const auto is_file = [](const std::string& path) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
  };
  if (is_file(text)) return {mesh, {}, {}};
  // Folders and parts may have a '#' or a '/' in their names too: the mark is the first one that ends a file's name.
  std::size_t mark = text.find('#');
  while (mark != std::string::npos && !is_file(text.substr(0, mark))) mark = text.find('#', mark + 1);
  if (mark == std::string::npos) mark = text.find('#', text.find_last_of('/') + 1);  // no such file: to be told so
  MeshParts parts{text.substr(0, mark), {}, {}};
  while (mark != std::string::npos) {
    const std::size_t next = text.find('#', mark + 1);
    const std::string part = text.substr(mark + 1, next == std::string::npos ? next : next - mark - 1);
    if (part.starts_with('!')) {
      parts.without.push_back(part.substr(1));
    } else {
      parts.only.push_back(part);
    }
    mark = next;
  }
  return parts;
}

}  // namespace tact
