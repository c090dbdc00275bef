#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "bench/presses.hpp"
#include "bench/report.hpp"

namespace tact::bench {

enum class Quantity { contact, coupling };

/// One search: where, and the largest stable stiffness there.
struct StabilityResult {
  Quantity quantity = Quantity::contact;
  std::string scene, law, mode, coupling, integrator, hand;
  double rate_hz = 0, damping_ratio = 0;
  int delay_ticks = 0;
  StableStiffness found;
  double most = 0;  ///< where the search ended

  std::string text() const { return text_of(found, most); }
};

StabilityResult result_of(Quantity quantity, const std::string& scene, const std::string& hand,
                          const lockstep::Experiment& setup, const StableStiffness& found, double most);

/// A line a search; the header names the columns. Throws SetupError.
void write_csv(const std::vector<StabilityResult>& results, const std::filesystem::path& csv);

/// Four charts: contact stiffness by hard case and law; by extra delay and rate, scaled and not; by delay and coupling;
/// coupling stiffness by rate and coupling.
void draw(const std::vector<StabilityResult>& results, Report& report);

}  // namespace tact::bench
