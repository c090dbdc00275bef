#include "file/record_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "fault/fault.hpp"

namespace tact {
namespace {

constexpr std::size_t kLargest = std::size_t{1} << 20, kBuffer = std::size_t{1} << 18;

struct Prelude {
  char magic[4];
  char tag[4];
  std::uint32_t schema, reserved;
};
struct Head {
  std::uint32_t size, checksum;
};

Prelude prelude_of(const SealedKind& kind) {
  Prelude p{{'T', 'A', 'C', 'T'}, {}, kind.schema, 0};
  std::copy(kind.tag.begin(), kind.tag.end(), p.tag);
  return p;
}

std::uint32_t checksum_of(std::span<const std::byte> record, std::uint64_t place) {
  return static_cast<std::uint32_t>(hash_bytes(record, place));
}

void put(std::vector<std::byte>& buffer, const void* from, std::size_t bytes) {
  const auto* begin = static_cast<const std::byte*>(from);
  buffer.insert(buffer.end(), begin, begin + bytes);
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw SetupError(path.string() + ": " + why);
}

}  // namespace

RecordWriter::RecordWriter(const std::filesystem::path& path, const SealedKind& kind, std::span<const std::byte> header)
    : path_(path) {
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file_ < 0) refuse(path, std::string("cannot create this ") + kind.name + ": " + std::strerror(errno));
  buffer_.reserve(kBuffer + kLargest);
  const Prelude prelude = prelude_of(kind);
  put(buffer_, &prelude, sizeof prelude);
  append(header);
  try {
    flush();
  } catch (...) {
    ::close(file_);
    throw;
  }
}

RecordWriter::~RecordWriter() {
  try {
    flush();
  } catch (const SetupError&) {  // what was flushed before is there
  }
  ::close(file_);
}

void RecordWriter::append(std::span<const std::byte> record) {
  TACT_CHECK(record.size() <= kLargest);
  const Head head{static_cast<std::uint32_t>(record.size()), checksum_of(record, count_++)};
  put(buffer_, &head, sizeof head);
  put(buffer_, record.data(), record.size());
  if (buffer_.size() >= kBuffer) flush();
}

void RecordWriter::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t n = ::write(file_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int error = errno;
      buffer_.clear();
      refuse(path_, std::string("cannot write: ") + std::strerror(error) + ": is the disk full?");
    }
    done += static_cast<std::size_t>(n);
  }
  buffer_.clear();
}

RecordReader::RecordReader(const std::filesystem::path& path, const SealedKind& kind) {
  const std::string what = std::string("a ") + kind.name + " of tact";
  file_ = std::fopen(path.c_str(), "rbe");
  if (file_ == nullptr)
    refuse(path, std::string("found no such file (") + std::strerror(errno) + "), expected " + what);
  const auto give_up = [&](const std::string& why) {
    std::fclose(file_);
    refuse(path, why);
  };
  Prelude prelude{};
  const Prelude wanted = prelude_of(kind);
  if (std::fread(&prelude, sizeof prelude, 1, file_) != 1 ||
      std::memcmp(prelude.magic, wanted.magic, sizeof wanted.magic) != 0 ||
      std::memcmp(prelude.tag, wanted.tag, sizeof wanted.tag) != 0) {
    give_up("found another kind of file, expected " + what);
  }
  if (prelude.schema != wanted.schema) {
    give_up("found schema " + std::to_string(prelude.schema) + ", expected " + std::to_string(wanted.schema) +
            ": it was written by another version of tact; read it with that one");
  }
  if (!read(header_)) give_up(std::string("the ") + kind.name + "'s header is not whole: it holds nothing to read");
}

RecordReader::~RecordReader() { std::fclose(file_); }

bool RecordReader::next(std::vector<std::byte>& record) { return !ended_early_ && read(record); }

bool RecordReader::read(std::vector<std::byte>& record) {
  Head head{};
  const std::size_t n = std::fread(&head, 1, sizeof head, file_);
  if (n == 0) return false;
  ended_early_ = true;
  if (n != sizeof head || head.size > kLargest) return false;
  record.resize(head.size);
  if (std::fread(record.data(), 1, record.size(), file_) != record.size()) return false;
  if (head.checksum != checksum_of(record, count_++)) return false;
  ended_early_ = false;
  return true;
}

}  // namespace tact
