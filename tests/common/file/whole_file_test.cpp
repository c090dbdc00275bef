#include "file/whole_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include "common/session/temp_folder.hpp"

namespace tact {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::ptrdiff_t files_in(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), {});
}

mode_t mode_of(const std::filesystem::path& path) {
  struct stat info {};
  EXPECT_EQ(::stat(path.c_str(), &info), 0);
  return info.st_mode & 0777;
}

TEST(WholeFile, PartsFollowOneAnotherAndReplaceWhatWasThere) {
  const TempFolder folder;
  const auto path = folder.write("a", "something longer than what follows");
  const std::string first = "one\0two", second(100'000, 'x');
  const std::span<const std::byte> parts[] = {std::as_bytes(std::span(first)), {}, std::as_bytes(std::span(second))};
  write_whole(path, parts, {.synced = true});
  EXPECT_EQ(read(path), first + second);
  write_whole(path, "");
  EXPECT_EQ(read(path), "");
  EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(WholeFile, ASecretIsForItsOwnerAndTheRestObeysTheUmask) {
  const TempFolder folder;
  const mode_t before = ::umask(027);
  write_whole(folder.path() / "open", "x");
  write_whole(folder.path() / "secret", "x", {.mode = 0600});
  ::umask(before);
  EXPECT_EQ(mode_of(folder.path() / "open"), 0640u);
  EXPECT_EQ(mode_of(folder.path() / "secret"), 0600u);
}

/// Two writers and a reader at once: every look is one whole text.
TEST(WholeFile, WhoeverLooksSeesAWholeFile) {
  const TempFolder folder;
  const auto path = folder.path() / "a";
  write_whole(path, std::string(1000, 'a'));
  std::atomic<int> writing = 2;
  const auto write = [&](char letter) {
    for (int i = 1; i <= 300; ++i) write_whole(path, std::string(static_cast<std::size_t>(1000 * i), letter));
    --writing;
  };
  std::thread a(write, 'a'), b(write, 'b');
  while (writing > 0) {
    const std::string seen = read(path);
    ASSERT_GE(seen.size(), 1000u);
    ASSERT_EQ(seen.size() % 1000, 0u);
    ASSERT_EQ(seen.find_first_not_of(seen.front()), seen.npos);
  }
  a.join();
  b.join();
  EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(WholeFile, NoSuchFolderIsOneClearError) {
  const TempFolder folder;
  const std::string path = (folder.path() / "none" / "a").string();
  EXPECT_EQ(setup_error([&] { write_whole(path, "x"); }),
            path +
                ": cannot write: No such file or directory: free some space, fix the folder's permissions or choose "
                "another place");
}

/// A limit on the file size fails a write half-way, as a full disk does.
TEST(WholeFile, AFullDiskLeavesTheOldFileAndNothingElse) {
  const TempFolder folder;
  const auto path = folder.write("a", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string error = setup_error([&] { write_whole(path, std::string(10'000, 'x')); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(error.find("cannot write: File too large"), std::string::npos) << error;
  EXPECT_EQ(read(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1);
}

}  // namespace
}  // namespace tact
