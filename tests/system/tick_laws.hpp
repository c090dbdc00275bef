#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fault/fault.hpp"
#include "session/session.hpp"
#include "support/flight_file.hpp"

namespace tact::test {

/// The law of every executed tick: the gate's face of that mode; extrapolated for five ticks, never growing from there,
/// nothing and named stale from the twentieth on.
inline void expect_gate_and_staleness(const std::vector<FlightTick>& ticks, const std::string& mode) {
  const MachineSpec gate;
  const double step_n = gate.force_slope_n_per_s / gate.rate_hz;
  constexpr double kDriverSpring_n_per_m = 2000;  // of the simulated arm at 1 kHz, README of coupling
  ASSERT_GT(ticks.size(), 2000u);
  for (auto t = std::next(ticks.begin()); t != ticks.end(); ++t) {
    const auto before = std::prev(t);
    if (t->tick != before->tick + 1) continue;  // the disk was too slow for the recorder
    if (mode == "impedance") {
      ASSERT_LE((t->F_sent_W.force - before->F_sent_W.force).norm(), step_n + 1e-6) << "tick " << t->tick;
      ASSERT_LE(t->F_sent_W.force.norm(), gate.force_limit_n + 1e-6) << "tick " << t->tick;
    } else {
      ASSERT_LE(kDriverSpring_n_per_m * (t->X_sent.p - t->X_BH.p).norm(), gate.force_limit_n + 1e-6)
          << "tick " << t->tick;
    }
    if (t->reply_seq == 0) continue;
    if (t->wrench_age_ticks > 6) {
      ASSERT_LE(t->F_contact_W.force.norm(), before->F_contact_W.force.norm() + 1e-9) << "tick " << t->tick;
    }
    if (t->wrench_age_ticks >= 20) {
      ASSERT_EQ(t->F_contact_W.force.norm(), 0) << "tick " << t->tick;
      ASSERT_NE(t->faults & bit(Fault::wrench_stale), 0u) << "tick " << t->tick;
    }
  }
}

}  // namespace tact::test
