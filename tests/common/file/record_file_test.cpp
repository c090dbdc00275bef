#include "file/record_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "fault/fault.hpp"
#include "support/process.hpp"

namespace tact {
namespace {

constexpr SealedKind kKind{{'T', 'E', 'S', 'T'}, 3, "test file"};
using Bytes = std::vector<std::byte>;

Bytes some(std::size_t n, int seed) {
  Bytes bytes(n);
  for (std::size_t i = 0; i < n; ++i) bytes[i] = static_cast<std::byte>((static_cast<int>(i) * 7 + seed) & 255);
  return bytes;
}

class RecordFile : public ::testing::Test {
 protected:
  const test::ScratchDir dir_;
  const std::filesystem::path path_ = dir_.path() / "file";
  const std::vector<Bytes> records_{some(0, 1), some(1, 2), some(700, 3), some(64, 4)};

  void write() const {
    RecordWriter out(path_, kKind, some(33, 9));
    for (const Bytes& r : records_) out.append(r);
  }
  std::string content() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void replace(const std::string& content) const { std::ofstream(path_, std::ios::binary) << content; }
  /// How many records are read; each must be the one written. Negative: refused.
  int readable(bool& ended_early) const {
    try {
      RecordReader in(path_, kKind);
      EXPECT_EQ(Bytes(in.header().begin(), in.header().end()), some(33, 9));
      Bytes record;
      int n = 0;
      for (; in.next(record); ++n) EXPECT_EQ(record, records_.at(static_cast<std::size_t>(n)));
      ended_early = in.ended_early();
      return n;
    } catch (const SetupError&) {
      return -1;
    }
  }
};

TEST_F(RecordFile, GivesBackWhatWasWritten) {
  write();
  bool ended_early = true;
  EXPECT_EQ(readable(ended_early), 4);
  EXPECT_FALSE(ended_early);
}

TEST_F(RecordFile, CutAnywhereItIsReadableUpToTheLastWholeRecord) {
  write();
  const std::string whole = content();
  std::vector<std::size_t> ends{16 + 8 + 33};  // prelude, header record
  for (const Bytes& r : records_) ends.push_back(ends.back() + 8 + r.size());
  ASSERT_EQ(ends.back(), whole.size());
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    replace(whole.substr(0, length));
    const auto complete = std::count_if(ends.begin(), ends.end(), [&](std::size_t end) { return end <= length; });
    bool ended_early = false;
    EXPECT_EQ(readable(ended_early), static_cast<int>(complete) - 1) << length;
    if (complete > 0) {
      EXPECT_EQ(ended_early, std::find(ends.begin(), ends.end(), length) == ends.end()) << length;
    }
  }
}

TEST_F(RecordFile, NoDamagedRecordIsGiven) {
  write();
  const std::string whole = content();
  for (std::size_t at = 16; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    replace(damaged);
    bool ended_early = false;
    const int n = readable(ended_early);  // each one it gives was compared there
    EXPECT_LT(n, 4) << at;
    EXPECT_TRUE(n < 0 || ended_early) << at;
  }
}

TEST_F(RecordFile, RecordsThatChangedPlacesAreNotGiven) {
  write();
  std::string whole = content();
  const std::size_t first = 16 + 8 + 33, second = first + 8, third = second + 9;
  replace(whole.substr(0, first) + whole.substr(second, third - second) + whole.substr(first, 8) + whole.substr(third));
  bool ended_early = false;
  EXPECT_EQ(readable(ended_early), 0);
  EXPECT_TRUE(ended_early);
}

TEST_F(RecordFile, WhatWasFlushedIsThereWhileTheWriterLives) {
  RecordWriter out(path_, kKind, some(33, 9));
  out.append(records_[0]);
  out.append(records_[1]);
  out.flush();
  out.append(records_[2]);
  bool ended_early = true;
  EXPECT_EQ(readable(ended_early), 2);
  EXPECT_FALSE(ended_early);
}

TEST_F(RecordFile, ForeignFilesAreRefusedWithTheReason) {
  const auto reason = [this](const SealedKind& kind) -> std::string {
    try {
      RecordReader in(path_, kind);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_NE(reason(kKind).find("no such file"), std::string::npos) << reason(kKind);
  replace("time_s,x_m\n0,1\n and more of this and that\n");
  EXPECT_NE(reason(kKind).find("another kind of file"), std::string::npos) << reason(kKind);
  write();
  EXPECT_NE(reason({{'E', 'L', 'S', 'E'}, 3, "x"}).find("another kind"), std::string::npos);
  EXPECT_NE(reason({{'T', 'E', 'S', 'T'}, 4, "x"}).find("found schema 3, expected 4"), std::string::npos);
}

TEST_F(RecordFile, AFullDiskIsAnErrorThatNamesTheFile) {
  try {
    RecordWriter full("/dev/full", kKind, some(33, 9));
    FAIL() << "a header was written to /dev/full";
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("/dev/full"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace tact
