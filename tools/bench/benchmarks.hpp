#pragma once
#include "bench/report.hpp"

namespace tact::bench {

struct Effort {
  bool quick = false;  ///< smaller cases, fewer repetitions: a minute for all
  std::size_t scaled(std::size_t full) const { return quick ? full / 5 : full; }
};

/// Each measures one thing and adds its tables and bars to the report (README).
void bench_contact(const Effort& effort, Report& report);
void bench_sample(const Effort& effort, Report& report);
void bench_bake(const Effort& effort, Report& report);
void bench_laws(const Effort& effort, Report& report);
void bench_stability(const Effort& effort, Report& report);
void bench_judgement(const Effort& effort, Report& report);
void bench_work(const Effort& effort, Report& report);
void bench_growth(const Effort& effort, Report& report);
void bench_limit(const Effort& effort, Report& report);
void bench_start(const Effort& effort, Report& report);
void bench_accuracy(const Effort& effort, Report& report);
void bench_cluster(const Effort& effort, Report& report);
void bench_gradient(const Effort& effort, Report& report);
void bench_walls(const Effort& effort, Report& report);
void bench_assemblies(const Effort& effort, Report& report);
void bench_wedge(const Effort& effort, Report& report);

}  // namespace tact::bench
