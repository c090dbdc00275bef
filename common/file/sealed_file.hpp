#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace tact {

/// One kind of our own binary cache files. A file is a 64-byte header (magic "TACT" + tag, schema, sizes, content hash,
/// xxh3 checksum over header and payload) followed by the payload. Little endian, x86-64 only.
struct SealedKind {
  std::array<char, 4> tag;
  std::uint32_t schema;
  const char* name;  ///< for messages: "distance field"
};

/// Bytes of a mapped sealed file, read only, 64-byte aligned; unmapped with the last copy.
class SealedFile {
 public:
  /// Maps, populates and checks the file; `lock` also pins it in memory. Throws SetupError "<file>: <reason>: <what to
  /// do>" when it is missing, empty, truncated, foreign, of another schema or kind, damaged, or has another content
  /// hash than `expected_hash` (0: any), or cannot be locked. Cost: reads every byte once.
  static SealedFile open(const std::filesystem::path& path, const SealedKind& kind, std::uint64_t expected_hash = 0,
                         bool lock = false);

  std::span<const std::byte> payload() const noexcept { return payload_; }
  std::uint64_t content_hash() const noexcept { return content_hash_; }

 private:
  std::shared_ptr<const void> mapping_;
  std::span<const std::byte> payload_;
  std::uint64_t content_hash_ = 0;
};

/// Writes the parts, one after the other, as the payload of a sealed file, whole and synced (write_whole).
void write_sealed(const std::filesystem::path& path, const SealedKind& kind, std::uint64_t content_hash,
                  std::span<const std::span<const std::byte>> parts);

/// xxh3 of bytes, to chain: pass the previous result as the seed.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed = 0) noexcept;
std::uint64_t hash_text(const std::string& text, std::uint64_t seed = 0) noexcept;

/// 16 lower-case hex digits.
std::string hex(std::uint64_t hash);

}  // namespace tact
