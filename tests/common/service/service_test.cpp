#include <gtest/gtest.h>
#include <signal.h>

#include <stdexcept>
#include <thread>

#include "fault/fault.hpp"
#include "service/service_main.hpp"
#include "service/stop_signal.hpp"

namespace tact {
namespace {

using namespace std::chrono_literals;

int run(std::vector<const char*> arguments, const std::function<int(const ServiceOptions&)>& serve) {
  arguments.insert(arguments.begin(), "tact-test");
  return service_main("tact-test", static_cast<int>(arguments.size()), const_cast<char**>(arguments.data()), serve);
}

TEST(ServiceMain, PassesTheOptionsAndTheExitCode) {
  ServiceOptions seen;
  const auto serve = [&](const ServiceOptions& o) {
    seen = o;
    return kExitFault;
  };
  EXPECT_EQ(run({"--session", "a.toml", "--check"}, serve), kExitFault);
  EXPECT_EQ(seen.session_file, "a.toml");
  EXPECT_TRUE(seen.check_only);
}

TEST(ServiceMain, AWrongCommandLineServesNothing) {
  const auto serve = [](const ServiceOptions&) -> int { throw std::logic_error("served"); };
  EXPECT_EQ(run({}, serve), kExitSetupError);
  EXPECT_EQ(run({"--session", "a.toml", "--fast"}, serve), kExitSetupError);
  EXPECT_EQ(run({"--help"}, serve), kExitOk);
}

TEST(ServiceMain, SetupErrorsAreToldApartFromDefects) {
  EXPECT_EQ(run({"--session", "a"}, [](const ServiceOptions&) -> int { throw SetupError("a.toml: no such file"); }),
            kExitSetupError);
  EXPECT_EQ(run({"--session", "a"}, [](const ServiceOptions&) -> int { throw std::runtime_error("?"); }), kExitFault);
}

TEST(StopSignal, IsQuietUntilAskedAndStaysSet) {
  StopSignal stop;
  EXPECT_FALSE(stop.wait_for(1ms));
  stop.request();
  EXPECT_TRUE(stop.requested());
  EXPECT_TRUE(stop.wait_for(1h));
}

TEST(StopSignal, TerminationWakesWhoeverWaits) {
  for (const int number : {SIGINT, SIGTERM}) {
    const StopSignal stop;
    std::thread sender([number] { ::kill(::getpid(), number); });
    EXPECT_TRUE(stop.wait_for(1h));
    sender.join();
  }
}

TEST(StopSignal, GivesTheHandlersBack) {
  struct sigaction before {
  }, after{};
  ::sigaction(SIGTERM, nullptr, &before);
  { const StopSignal stop; }
  ::sigaction(SIGTERM, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

}  // namespace
}  // namespace tact
