#pragma once
#include <unistd.h>

#include <fstream>
#include <memory>

#include "link/endpoint.hpp"
#include "link/roudi.hpp"
#include "session/session.hpp"
#include "support/process.hpp"

namespace tact::test {

/// tact-coupling as a process, against a contact server in closed form in another (half_space_server): a foot pressed
/// on z = 0 by a scripted hand. Change `session`, save(), start.
class ProgramSession {
 public:
  ProgramSession() {
    session.name = std::to_string(::getpid()) + "-program";
    session.id = 7;
    session.run_dir = dir_.path();
    session.scene.name = session.scene.title = "half-space";
    session.scene.obstacle.shape = session.scene.tool.shape = "box";
    session.scene.start_X_WM.p = {0, 0, 0.02};
    session.run.hand_csv = dir_.path() / "press.csv";
    std::ofstream(session.run.hand_csv)
        << "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.02,1,0,0,0\n0.5,0,0,-0.05,1,0,0,0\n";
  }

  Session session;
  const std::filesystem::path& dir() const { return dir_.path(); }
  const std::filesystem::path& file() const { return file_; }
  void save() const { save_session(session, file_); }
  Process start(const char* program, const std::string& log) const {
    return {{program, "--session", file_}, dir_.path() / log};
  }
  Process start_server(const char* program, const std::string& log) const {
    return {{program, file_}, dir_.path() / log};
  }

 private:
  const ScratchDir dir_;
  const std::filesystem::path file_ = dir_.path() / "session.toml";
};

}  // namespace tact::test
