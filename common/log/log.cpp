#include "log/log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <vector>

#include "fault/fault.hpp"

namespace tact {
namespace {

constexpr const char* kPattern = "%Y-%m-%d %H:%M:%S.%e %n %^%l%$ %v";

spdlog::level::level_enum level_of(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return spdlog::level::debug;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::warn:
      return spdlog::level::warn;
    case LogLevel::error:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

std::shared_ptr<spdlog::logger> make(const std::string& name, const std::vector<spdlog::sink_ptr>& sinks) {
  auto logger = std::make_shared<spdlog::logger>(name, sinks.begin(), sinks.end());
  logger->set_pattern(kPattern);
  logger->flush_on(spdlog::level::warn);
  return logger;
}

/// Replaced by open_log only, before a service starts its threads. Never destroyed: threads may log until the end.
std::shared_ptr<spdlog::logger>& logger() {
  static auto* const instance =
      new std::shared_ptr<spdlog::logger>(make("tact", {std::make_shared<spdlog::sinks::stderr_color_sink_mt>()}));
  return *instance;
}

}  // namespace

void open_log(const std::string& name, LogLevel least, const std::filesystem::path& file) {
  std::vector<spdlog::sink_ptr> sinks{std::make_shared<spdlog::sinks::stderr_color_sink_mt>()};
  if (!file.empty()) {
    try {
      sinks.push_back(std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), true));
    } catch (const spdlog::spdlog_ex& e) {
      throw SetupError(file.string() + ": cannot be written as a log file: " + e.what());
    }
  }
  logger() = make(name, sinks);
  logger()->set_level(level_of(least));
  if (!file.empty()) {
    spdlog::set_default_logger(logger());  // flush_every serves registered loggers
    spdlog::flush_every(std::chrono::seconds{1});
  }
}

void write_log(LogLevel level, const std::string& text) { logger()->log(level_of(level), text); }

void flush_log() { logger()->flush(); }

}  // namespace tact
