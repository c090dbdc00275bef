#pragma once
#include <ostream>
#include <span>

#include "bench/benchmarks.hpp"

namespace tact::evidence {

/// One figure of [P], or one question of ours.
struct Experiment {
  const char* name;    ///< fig-2, closed-paths, ...: what `tact report NAME` says
  const char* title;   ///< a line
  const char* tested;  ///< what is done and why, for a reader who does not know [P]
  void (*run)(const bench::Effort& effort, bench::Report& report);

  friend void PrintTo(const Experiment& e, std::ostream* out) { *out << e.name; }
};

/// In the order of the page.
std::span<const Experiment> experiments();

// Those made here; the others are benchmarks (tools/bench).
void fig_2(const bench::Effort& effort, bench::Report& report);
void fig_3(const bench::Effort& effort, bench::Report& report);
void fig_6(const bench::Effort& effort, bench::Report& report);
void fig_7(const bench::Effort& effort, bench::Report& report);
void fig_8(const bench::Effort& effort, bench::Report& report);
void fig_10(const bench::Effort& effort, bench::Report& report);
void fig_11(const bench::Effort& effort, bench::Report& report);
void fig_13(const bench::Effort& effort, bench::Report& report);
void translation_only(const bench::Effort& effort, bench::Report& report);
void paper_errors(const bench::Effort& effort, bench::Report& report);
void rates(const bench::Effort& effort, bench::Report& report);

}  // namespace tact::evidence
