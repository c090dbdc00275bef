#include "file/sealed_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <vector>

#include "fault/fault.hpp"
#include "file/whole_file.hpp"

namespace tact {
namespace {

struct Header {
  char magic[8];
  std::uint32_t schema;
  std::uint32_t header_bytes;
  std::uint64_t payload_bytes;
  std::uint64_t content_hash;
  std::uint64_t checksum;  ///< xxh3 of this header with checksum = 0, then of the payload
  char reserved[24];
};
static_assert(sizeof(Header) == 64);

std::string reason(int error) { return std::error_code(error, std::generic_category()).message(); }

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& text) {
  throw SetupError(path.string() + ": " + text);
}

/// A descriptor that closes itself.
struct Descriptor {
  int fd = -1;
  explicit Descriptor(int descriptor) : fd(descriptor) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

Header make_header(const SealedKind& kind) {
  Header header{};
  std::memcpy(header.magic, "TACT", 4);
  std::memcpy(header.magic + 4, kind.tag.data(), 4);
  header.schema = kind.schema;
  header.header_bytes = sizeof(Header);
  return header;
}

struct Checksum {
  XXH3_state_t* state = XXH3_createState();
  Checksum() { XXH3_64bits_reset(state); }
  Checksum(const Checksum&) = delete;
  Checksum& operator=(const Checksum&) = delete;
  ~Checksum() { XXH3_freeState(state); }
  void add(const void* data, std::size_t bytes) { XXH3_64bits_update(state, data, bytes); }
  std::uint64_t digest() const { return XXH3_64bits_digest(state); }
};

}  // namespace

SealedFile SealedFile::open(const std::filesystem::path& path, const SealedKind& kind, std::uint64_t expected_hash,
                            bool lock) {
  const std::string what = kind.name;
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd < 0) refuse(path, "cannot open the " + what + ": " + reason(errno));
  struct stat status {};
  if (::fstat(file.fd, &status) != 0 || !S_ISREG(status.st_mode)) refuse(path, "not a regular file");
  const auto bytes = static_cast<std::size_t>(status.st_size);
  if (bytes == 0) refuse(path, "the " + what + " is empty: delete it and bake again");
  if (bytes < sizeof(Header)) refuse(path, "the " + what + " is truncated: delete it and bake again");

  void* address = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED | MAP_POPULATE, file.fd, 0);
  if (address == MAP_FAILED) refuse(path, "cannot map the " + what + ": " + reason(errno));
  SealedFile sealed;
  sealed.mapping_ =
      std::shared_ptr<const void>(address, [bytes](const void* p) { ::munmap(const_cast<void*>(p), bytes); });

  Header header;
  std::memcpy(&header, address, sizeof(header));
  const Header wanted = make_header(kind);
  if (std::memcmp(header.magic, wanted.magic, sizeof(header.magic)) != 0) refuse(path, "foreign: not a Tact " + what);
  if (header.schema != wanted.schema || header.header_bytes != wanted.header_bytes) {
    refuse(path, "the " + what + " has schema " + std::to_string(header.schema) + ", expected " +
                     std::to_string(wanted.schema) + ": delete it and bake again");
  }
  if (header.payload_bytes != bytes - sizeof(Header)) {
    refuse(path, "the " + what + " is truncated: found " + std::to_string(bytes - sizeof(Header)) +
                     " bytes, expected " + std::to_string(header.payload_bytes) + ": delete it and bake again");
  }
  const std::uint64_t stored = header.checksum;
  header.checksum = 0;
  const auto* payload = static_cast<const std::byte*>(address) + sizeof(Header);
  Checksum checksum;
  checksum.add(&header, sizeof(header));
  checksum.add(payload, header.payload_bytes);
  if (checksum.digest() != stored) refuse(path, "the " + what + " is damaged (checksum): delete it and bake again");
  if (expected_hash != 0 && header.content_hash != expected_hash) {
    refuse(path, "the " + what + " was baked from something else: content " + hex(header.content_hash) + ", expected " +
                     hex(expected_hash));
  }
#ifndef TACT_SANITIZED
  if (lock && ::mlock(address, bytes) != 0) {
    refuse(path, "cannot lock " + std::to_string(bytes >> 20) + " MB in memory: " + reason(errno) +
                     ": raise the memlock limit (ulimit -l)");
  }
#else
  static_cast<void>(lock);
#endif
  sealed.payload_ = {payload, header.payload_bytes};
  sealed.content_hash_ = header.content_hash;
  return sealed;
}

void write_sealed(const std::filesystem::path& path, const SealedKind& kind, std::uint64_t content_hash,
                  std::span<const std::span<const std::byte>> parts) {
  Header header = make_header(kind);
  header.content_hash = content_hash;
  for (const auto& part : parts) header.payload_bytes += part.size();
  Checksum checksum;
  checksum.add(&header, sizeof(header));
  for (const auto& part : parts) checksum.add(part.data(), part.size());
  header.checksum = checksum.digest();

  std::vector<std::span<const std::byte>> all{std::as_bytes(std::span(&header, 1))};
  all.insert(all.end(), parts.begin(), parts.end());
  write_whole(path, all, {.synced = true});
}

std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed) noexcept {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::uint64_t hash_text(const std::string& text, std::uint64_t seed) noexcept {
  return XXH3_64bits_withSeed(text.data(), text.size(), seed);
}

std::string hex(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace tact
