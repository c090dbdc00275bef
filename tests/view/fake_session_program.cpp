// A moving scene to look at and to measure the view with, without the services: view_fake_session SESSION_FILE_LINK
#include <csignal>
#include <cstdio>
#include <string>

#include "fake_session.hpp"

int main(int argc, char** argv) {
  tact::view::testing::FakeSession session;
  if (argc > 1) session.session.machine.port = std::stoi(argv[1]);
  session.start();
  std::printf("%s\n", session.file().c_str());
  std::fflush(stdout);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  int signal = 0;
  sigwait(&set, &signal);
}
