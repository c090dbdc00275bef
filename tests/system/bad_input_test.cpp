// Whatever a user gets wrong ends in one clear sentence that names the file and the field, and in nothing else.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "support/tact_run.hpp"

namespace tact::test {
namespace {
namespace fs = std::filesystem;

class BadInput : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) {
    const fs::path path = scratch_.path() / name;
    std::ofstream(path) << text;
    return path;
  }

  fs::path good_mesh() {
    return write("good.obj", "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  }

  fs::path scene(const std::string& more) { return write("s.toml", "name = \"s\"\n" + more); }

  /// Runs, expects failure with exactly one line that holds every word, and nothing left behind.
  void expect_refused(std::vector<std::string> arguments, const std::vector<std::string>& words) {
    arguments.insert(arguments.end(), {"--view", "off", "--for", "2s"});
    TactRun run(arguments);
    const int code = run.wait(std::chrono::seconds{90});
    EXPECT_NE(code, 0) << run.output();
    EXPECT_LT(code, 128) << "died of a signal\n" << run.output();
    expect_one_error(run.output(), words);
    EXPECT_TRUE(pids_of("tact-contact").empty());
    EXPECT_TRUE(pids_of("tact-coupling").empty());
  }

  static void expect_one_error(const std::string& output, const std::vector<std::string>& words) {
    std::istringstream lines(output);
    std::string line;
    int errors = 0;
    while (std::getline(lines, line)) {
      if (line.rfind("tact: ", 0) != 0) continue;
      if (std::all_of(words.begin(), words.end(), [&](const auto& w) { return line.find(w) != std::string::npos; })) {
        ++errors;
      }
    }
    EXPECT_EQ(errors, 1) << "wanted one 'tact: ...' line with all of " << ::testing::PrintToString(words) << " in\n"
                         << output;
  }

  ScratchDir scratch_;
};

TEST_F(BadInput, AnUnknownSceneIsNamed) { expect_refused({"no-such-scene"}, {"no-such-scene"}); }

TEST_F(BadInput, AMalformedSceneNamesFileAndLine) { expect_refused({scene("[tool\n").string()}, {"s.toml", "line 2"}); }

TEST_F(BadInput, AnUnknownKeyIsNamed) {
  expect_refused({scene("[tool]\nshape = \"box\"\nponts = 10\n[obstacle]\nshape = \"box\"\n").string()},
                 {"s.toml", "ponts"});
}

TEST_F(BadInput, AnImpossibleValueIsNamed) {
  expect_refused({scene("[tool]\nshape = \"box\"\npoints = -3\n[obstacle]\nshape = \"box\"\n").string()},
                 {"s.toml", "points", "-3"});
}

TEST_F(BadInput, AMissingMeshIsNamed) {
  expect_refused({"--obstacle", (scratch_.path() / "none.stl").string(), "--tool", good_mesh(), "--unit", "mm"},
                 {"none.stl"});
}

TEST_F(BadInput, AnEmptyMeshIsNamed) {
  expect_refused({"--obstacle", write("empty.stl", ""), "--tool", good_mesh(), "--unit", "mm"}, {"empty.stl"});
}

TEST_F(BadInput, AHostileMeshKillsNobodyButTheBaker) {
  // An STL header that promises four thousand million triangles.
  std::string stl(80, ' ');
  stl += "\xff\xff\xff\xff";
  stl += std::string(50, '\x7f');
  expect_refused({"--obstacle", write("huge.stl", stl), "--tool", good_mesh(), "--unit", "mm"}, {"huge.stl"});
}

TEST_F(BadInput, VerticesThatAreNotNumbersAreNamed) {
  const auto mesh = write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n");
  expect_refused({"--obstacle", mesh, "--tool", good_mesh(), "--unit", "mm"}, {"nan.obj"});
}

TEST_F(BadInput, MeshesWithoutAUnitAreRefused) {
  expect_refused({"--obstacle", good_mesh(), "--tool", good_mesh()}, {"--unit"});
}

TEST_F(BadInput, AnUnknownLawIsNamedWithTheKnownOnes) {
  expect_refused({"peg", "--law", "magic"}, {"magic", "potential", "adaptive-6dof"});
}

TEST_F(BadInput, AnUnknownScriptIsNamedWithTheKnownOnes) {
  expect_refused({"alpha", "--script", "fly"}, {"fly", "solve", "cheat"});
}

TEST_F(BadInput, AHandFileWithABadRowNamesTheLine) {
  const auto hand = write("hand.csv", "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,nan,0,0,1,0,0,0\n");
  expect_refused({"peg", "--hand", hand}, {"hand.csv", "3"});
}

TEST_F(BadInput, ATakenPortIsNamed) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  socklen_t size = sizeof(address);
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  const std::string port = std::to_string(ntohs(address.sin_port));
  TactRun run({"peg", "--port", port, "--for", "3s"});
  EXPECT_NE(run.wait(std::chrono::seconds{90}), 0) << run.output();
  expect_one_error(run.output(), {port});
  close(listener);
}

TEST_F(BadInput, ATruncatedCacheIsRebuiltAndSaidSo) {
  const auto cache = scratch_.path() / "cache";
  const auto run_peg = [&] {
    Process run({TactRun::program(), "run", "peg", "--view", "off", "--for", "1s"}, scratch_.path() / "out.txt",
                {{"TACT_CACHE", cache.string()}});
    EXPECT_EQ(run.wait(std::chrono::seconds{120}).value_or(-1), 0) << run.output();
    return run.output();
  };
  run_peg();
  int truncated = 0;
  for (const auto& entry : fs::recursive_directory_iterator(cache)) {
    if (entry.is_regular_file() && entry.path().extension() == ".field") {
      fs::resize_file(entry.path(), entry.file_size() / 2);
      ++truncated;
    }
  }
  ASSERT_GT(truncated, 0);
  EXPECT_NE(run_peg().find("truncated"), std::string::npos);
}

TEST_F(BadInput, SharedMemoryThatIsTooSmallIsNamedWithWhatIsNeeded) {
  // A mount namespace of its own, with a /dev/shm as small as a container's.
  Process run({"unshare", "--mount", "sh", "-c",
               "mount -t tmpfs -o size=32m tmpfs /dev/shm && exec " + TactRun::program().string() +
                   " run peg --view off --for 1s"},
              scratch_.path() / "out.txt", TactRun::environment());
  EXPECT_EQ(run.wait(std::chrono::seconds{60}).value_or(-1), 2) << run.output();
  expect_one_error(run.output(), {"/dev/shm"});
}

TEST_F(BadInput, AMissingRouDiIsNamedWithItsPackage) {
  auto environment = TactRun::environment();
  environment["PATH"] = scratch_.path();
  Process run({TactRun::program(), "run", "peg", "--view", "off", "--for", "1s"}, scratch_.path() / "out.txt",
              environment);
  EXPECT_EQ(run.wait(std::chrono::seconds{60}).value_or(-1), 2) << run.output();
  expect_one_error(run.output(), {"iox-roudi", "iceoryx"});
}

TEST_F(BadInput, AReportThatMayNotBeWrittenIsRefusedBeforeAnythingStarts) {
  Process run({TactRun::program(), "run", "peg", "--view", "off", "--for", "1s", "--report", "/proc/report.json"},
              scratch_.path() / "out.txt", TactRun::environment());
  EXPECT_EQ(run.wait(std::chrono::seconds{60}).value_or(-1), 2) << run.output();
  expect_one_error(run.output(), {"/proc/report.json"});
}

TEST_F(BadInput, ACacheThatCannotBeWrittenIsNamed) {
  const auto cache = write("not-a-directory", "");
  Process run({TactRun::program(), "run", "peg", "--view", "off", "--for", "1s"}, scratch_.path() / "out.txt",
              {{"TACT_CACHE", cache.string()}});
  EXPECT_NE(run.wait(std::chrono::seconds{60}).value_or(0), 0);
  expect_one_error(run.output(), {"not-a-directory"});
}

}  // namespace
}  // namespace tact::test
