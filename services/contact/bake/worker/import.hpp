#pragma once
#include <filesystem>
#include <string>

#include "mesh/mesh.hpp"

namespace tact::contact {

/// Reads OBJ, STL, PLY, OFF, glTF/GLB or DAE, all its parts with their node transforms or those that `file` names
/// (session/mesh_parts.hpp), scaled from `unit` ("m", "mm", "cm", "inch") to metres, in the file's own axes. Parsers of
/// other people's formats crash on hostile files: call this only in the bake's child process. Throws SetupError
/// "<file>: <what was found>: <what to do>" when the file is missing, empty, of an unknown extension, unreadable, holds
/// no such part, no triangle, or vertices that are not finite or unusably far away.
Mesh import_mesh(const std::filesystem::path& file, const std::string& unit);

}  // namespace tact::contact
