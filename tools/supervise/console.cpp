#include "supervise/console.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace tact::supervise {
namespace {

constexpr double kQuietSeconds = 5;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::size_t columns() {
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

}  // namespace

Console::Console() : terminal_(::isatty(STDOUT_FILENO) == 1) {}
Console::~Console() { clear_status(); }

void Console::line(const std::string& text) {
  clear_status();
  std::fputs((text + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void Console::status(const std::string& text) {
  if (terminal_) {
    status_ = text.substr(0, columns() - 1);
    std::fputs(("\r\033[K" + status_).c_str(), stdout);
  } else if (const double now = now_s(); now - last_status_s_ >= kQuietSeconds) {
    last_status_s_ = now;
    std::fputs((text + "\n").c_str(), stdout);
  }
  std::fflush(stdout);
}

void Console::clear_status() {
  if (!status_.empty()) std::fputs("\r\033[K", stdout);
  status_.clear();
  std::fflush(stdout);
}

}  // namespace tact::supervise
