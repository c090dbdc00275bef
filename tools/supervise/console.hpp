#pragma once
#include <string>

namespace tact::supervise {

/// The terminal of a session: lines that stay, and one status line that is rewritten in place. Where output is not a
/// terminal the status becomes an ordinary line every few seconds.
class Console {
 public:
  Console();
  ~Console();
  void line(const std::string& text);
  void status(const std::string& text);
  /// Ends the status line for good output to follow.
  void clear_status();

 private:
  bool terminal_;
  std::string status_;
  double last_status_s_ = -1e9;
};

}  // namespace tact::supervise
