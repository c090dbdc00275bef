#pragma once
#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace tact {

struct WholeFileOptions {
  mode_t mode = 0666;   ///< less the process's umask, as for any new file; 0600 keeps a secret
  bool synced = false;  ///< on the disk before it gets its name: survives a power cut
};

/// Writes the parts, one after the other, to a new file beside `path` and renames it: whoever looks sees the old file,
/// the new one or none, also when two write at once. Throws SetupError "<path>: cannot write: <reason>: ..." (full
/// disk, no such folder, no permission), leaving nothing behind. A killed writer leaves `<path>.XXXXXX`.
void write_whole(const std::filesystem::path& path, std::span<const std::span<const std::byte>> parts,
                 const WholeFileOptions& options = {});
void write_whole(const std::filesystem::path& path, std::string_view text, const WholeFileOptions& options = {});

}  // namespace tact
