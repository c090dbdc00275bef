// libFuzzer target for what people write: scene, machine and session files, hand motions, and single keys as on the
// command line. The first byte chooses. Nothing but a SetupError may come out, and a scene that is accepted is saved
// and read back as the same session. `session_fuzz --seeds FOLDER` writes files to start from. See README.md.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fault/fault.hpp"
#include "session/session.hpp"

namespace {

using namespace tact;

const std::filesystem::path& folder() {
  static const std::filesystem::path path = [] {
    const std::filesystem::path p =
        (std::filesystem::exists("/dev/shm") ? "/dev/shm/tact-session-fuzz-" : "/tmp/tact-session-fuzz-") +
        std::to_string(::getpid());
    std::filesystem::create_directories(p);
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all(folder(), ignored);
    });
    return p;
  }();
  return path;
}

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expect_same_back(const Session& session) {
  const auto first = folder() / "first.toml", second = folder() / "second.toml";
  save_session(session, first);
  save_session(load_session(first), second);  // a SetupError here is a bug: it ends the fuzzer
  if (read(first) != read(second)) {
    std::fprintf(stderr, "saved:\n%s\nread back and saved:\n%s\n", read(first).c_str(), read(second).c_str());
    std::abort();
  }
}

void write_seeds(const std::filesystem::path& seeds) {
  std::filesystem::create_directories(seeds);
  const auto seed = [&](const char* name, char kind, const std::string& text) {
    std::ofstream(seeds / name, std::ios::binary) << kind << text;
  };
  Session full;
  full.name = "full";
  full.id = ~0ull;
  full.run_dir = "/tmp";
  full.scene.name = "full";
  full.scene.title = "all \"keys\"";
  full.scene.obstacle.shape = "box";
  full.scene.obstacle.shape_params["size_x_m"] = 0.5;
  full.scene.tool.shape = "cone";
  full.scene.goal_X_WM = Pose{Vec3(0.1, 0, -2), Quat(0, 1, 0, 0)};
  full.machine.token = "secret-secret";
  full.run.for_s = 20;
  save_session(full, folder() / "seed.toml");
  const std::string session = read(folder() / "seed.toml");
  std::string scene, machine;  // the same keys without their prefixes
  for (std::size_t at = 0, end = 0; at < session.size(); at = end + 1) {
    end = std::min(session.find('\n', at), session.size());
    const std::string line = session.substr(at, end - at);
    if (line.rfind("scene.", 0) == 0 && line.find("stiffness_n_per_m = 0") == line.npos &&
        line.find("tool.points") == line.npos) {
      scene += line.substr(6) + '\n';
    }
    if (line.rfind("machine.", 0) == 0) machine += line.substr(8) + '\n';
  }
  seed("scene", 0, scene);
  seed("tables", 0,
       "[obstacle]\nshape = \"box\"\nparams = { size_x_m = 1e-2 }\n[tool]\nshape = \"cone\"\npoints = 500\n[start]\n"
       "position_m = [0, 1, 2.5]\n[contact]\nlaw = \"none\"\n[run]\nfor_s = \"2min\"\n");
  seed("machine", 1, machine);
  seed("session", 2, session);
  seed("hand", 3, "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0.5, 1e-3,-2,+3.5e1,0,-1,0,0\r\n");
  seed("keys", 4,
       "contact.law=global\ntool.points=500\nstart.position_m=1,2,3\nrun.for_s=20s\ncoupling.saturation=off\n");
}

void load(int kind, const std::filesystem::path& file, const std::string& text) {
  Session session;
  if (kind == 0) {
    load_scene(file, session);
    session.name = "fuzz";
    session.run_dir = folder();
    check_session(session);
    expect_same_back(session);
  } else if (kind == 1) {
    load_machine(file, session);
  } else if (kind == 2) {
    expect_same_back(load_session(file));
  } else if (kind == 3) {
    load_hand_motion(file);
  } else {  // lines of key=value
    session.name = "fuzz";
    session.run_dir = folder();
    session.scene.name = "fuzz";
    session.scene.obstacle.shape = session.scene.tool.shape = "box";
    for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
      end = std::min(text.find('\n', at), text.size());
      const std::string line = text.substr(at, end - at);
      const std::size_t equals = std::min(line.find('='), line.size());
      try {
        set_key(session, line.substr(0, equals), equals < line.size() ? line.substr(equals + 1) : "");
      } catch (const SetupError&) {
      }
    }
    check_session(session);
    expect_same_back(session);
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 3 && std::strcmp((*argv)[1], "--seeds") == 0) {
    write_seeds((*argv)[2]);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto file = folder() / "input";
  std::ofstream(file, std::ios::binary) << text;
  try {
    load(data[0] % 5, file, text);
  } catch (const SetupError& refused) {
    // Refused, as it should be; but what we saved ourselves must read back.
    if (std::string(refused.what()).find("first.toml") != std::string::npos) {
      std::fprintf(stderr, "%s\n%s\n", refused.what(), read(folder() / "first.toml").c_str());
      std::abort();
    }
  }
  return 0;
}
