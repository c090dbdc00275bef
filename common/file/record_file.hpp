#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "file/sealed_file.hpp"

namespace tact {

/// A file that grows record by record, and of which every whole record can be read whenever its writer stopped: 16
/// bytes (magic "TACT" + tag, schema), then records of any size up to 1 MiB, each after its size and a checksum over
/// its bytes and its place. The first record is the header: what the reader must know of the whole. Little endian.
class RecordWriter {
 public:
  /// Makes the file, over an old one. Throws SetupError when it cannot be made or written.
  RecordWriter(const std::filesystem::path& path, const SealedKind& kind, std::span<const std::byte> header);
  ~RecordWriter();
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;

  /// Held back until flush(), or until a quarter of a megabyte has gathered. Throws SetupError on a full disk.
  void append(std::span<const std::byte> record);
  /// To the kernel: what has been flushed survives this process. Throws as above.
  void flush();

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t count_ = 0;
  std::vector<std::byte> buffer_;
};

class RecordReader {
 public:
  /// Throws SetupError "<file>: <reason>: <what to do>" when it is missing, foreign, of another kind or schema, or its
  /// header is not whole.
  RecordReader(const std::filesystem::path& path, const SealedKind& kind);
  ~RecordReader();
  RecordReader(const RecordReader&) = delete;
  RecordReader& operator=(const RecordReader&) = delete;

  std::span<const std::byte> header() const noexcept { return header_; }

  /// The next record; false after the last whole one.
  bool next(std::vector<std::byte>& record);
  /// After next() was false: bytes follow that are no whole record. The writer was killed, or the file damaged.
  bool ended_early() const noexcept { return ended_early_; }

 private:
  bool read(std::vector<std::byte>& record);

  std::FILE* file_ = nullptr;
  std::uint64_t count_ = 0;
  bool ended_early_ = false;
  std::vector<std::byte> header_;
};

}  // namespace tact
