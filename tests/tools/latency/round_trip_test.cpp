// Two real processes, real RouDi.
#include <gtest/gtest.h>

#include "latency/latency.hpp"
#include "link/roudi.hpp"
#include "session/session.hpp"

namespace tact::latency {
namespace {

TEST(RoundTrip, IsMeasuredOverBothTransports) {
  const Effort effort{.rate_hz = 1000, .seconds = 0.5, .cpu = -1};
  {
    const RoudiLease lease(share_dir() / "roudi.toml");
    const Figure shm = measure_apart([&] { return round_trip(effort, "shm"); });
    EXPECT_EQ(shm.error, "");
    EXPECT_GT(shm.spread.n, 400u);
  }
  const Figure udp = measure_apart([&] { return round_trip(effort, "udp"); });
  EXPECT_EQ(udp.error, "");
  EXPECT_GT(udp.spread.n, 400u);
}

}  // namespace
}  // namespace tact::latency
