#pragma once
#include <filesystem>
#include <sstream>
#include <string>

namespace tact {

enum class LogLevel { debug, info, warn, error };

/// One logger a process: "<time> <name> <level> <text>" to stderr and, when `file` is not empty, also to that file
/// (truncated; flushed at each warning and every second). Before this call lines go to stderr under the name "tact".
/// Throws SetupError when the file cannot be written.
void open_log(const std::string& name, LogLevel least = LogLevel::info, const std::filesystem::path& file = {});

/// Writes one line. From any thread that is not real-time: allocates and locks.
void write_log(LogLevel level, const std::string& text);

/// Pending lines to their files; before leaving a process without running destructors.
void flush_log();

namespace detail {
template <class... Parts>
std::string joined(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}
}  // namespace detail

template <class... Parts>
void log_debug(const Parts&... parts) {
  write_log(LogLevel::debug, detail::joined(parts...));
}
template <class... Parts>
void log_info(const Parts&... parts) {
  write_log(LogLevel::info, detail::joined(parts...));
}
template <class... Parts>
void log_warn(const Parts&... parts) {
  write_log(LogLevel::warn, detail::joined(parts...));
}
template <class... Parts>
void log_error(const Parts&... parts) {
  write_log(LogLevel::error, detail::joined(parts...));
}

}  // namespace tact
