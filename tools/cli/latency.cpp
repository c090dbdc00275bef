#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "fault/fault.hpp"
#include "latency/latency.hpp"
#include "link/roudi.hpp"
#include "session/session.hpp"

namespace tact::cli {
namespace {

using Json = nlohmann::ordered_json;
using latency::Figure;

constexpr int kMissed = 3;  // exit status, as tact bench

Json to_json(const std::string& what, const Figure& f) {
  Json out{{"what", what}};
  if (!f.error.empty()) out["error"] = f.error;
  out.update({{"n", f.spread.n},
              {"p50_us", f.spread.p50_us},
              {"p99_us", f.spread.p99_us},
              {"p999_us", f.spread.p999_us},
              {"max_us", f.spread.max_us},
              {"missed", f.missed},
              {"fifo", f.conditions.fifo},
              {"priority", f.conditions.priority},
              {"memory_locked", f.conditions.locked},
              {"cpu_dma_latency_held", f.conditions.awake}});
  return out;
}

void print(const std::string& what, const Figure& f) {
  if (!f.error.empty()) {
    std::printf("%-28s not measured: %s\n", what.c_str(), f.error.c_str());
    return;
  }
  std::printf("%-28s %8.1f %8.1f %8.1f %9.1f %7llu   %s\n", what.c_str(), f.spread.p50_us, f.spread.p99_us,
              f.spread.p999_us, f.spread.max_us, static_cast<unsigned long long>(f.missed),
              f.conditions.text().c_str());
  std::fflush(stdout);
}

void print_head() {
  std::printf("%-28s %8s %8s %8s %9s %7s   measured under\n", "microseconds", "p50", "p99", "p99.9", "max", "missed");
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

int against_cyclictest(const latency::Effort& effort, bool json) {
  constexpr int kRepeats = 5;
  constexpr double kBar = 1.5;
  Json rows = Json::array();
  std::vector<double> ours, theirs;
  if (!json) print_head();
  for (int i = 0; i < kRepeats; ++i) {
    const Figure mine = latency::measure_apart([&] { return latency::wakeup(effort); });
    const auto peer = latency::cyclictest(effort);
    if (!peer) throw SetupError("cyclictest: not installed; apt-get install rt-tests (tools/setup --tests)");
    for (const Figure* f : {&mine, &*peer}) {
      if (!f->error.empty()) throw SetupError("latency: " + f->error);
    }
    ours.push_back(mine.spread.p99_us);
    theirs.push_back(peer->spread.p99_us);
    rows.push_back(to_json("tact", mine));
    rows.push_back(to_json("cyclictest", *peer));
    if (!json) {
      print("tact, repeat " + std::to_string(i + 1), mine);
      print("cyclictest, repeat " + std::to_string(i + 1), *peer);
    }
  }
  const double ratio = median(ours) / std::max(median(theirs), 1.0);
  const bool met = ratio <= kBar;
  if (json) {
    std::printf("%s\n", Json{{"repeats", rows}, {"p99_ratio", ratio}, {"bar", kBar}, {"met", met}}.dump(2).c_str());
  } else {
    std::printf("Wake-up p99, median of %d alternating repeats: %.1f us against %.1f us, ratio %.2f: bar %.1f %s\n",
                kRepeats, median(ours), median(theirs), ratio, kBar, met ? "met" : "MISSED");
  }
  return met ? 0 : kMissed;
}

}  // namespace

int latency(const LatencyOptions& options) {
  const latency::Effort effort{options.rate_hz, options.seconds, options.cpu};
  if (options.against_cyclictest) return against_cyclictest(effort, options.json);
  if (!options.json) print_head();
  Json rows = Json::array();
  const auto take = [&](const std::string& what, const Figure& figure) {
    rows.push_back(to_json(what, figure));
    if (!options.json) print(what, figure);
    return figure;
  };
  const Figure wakeup = take("wake-up on the grid", latency::measure_apart([&] { return latency::wakeup(effort); }));
  take("two processes, futex", latency::measure_apart([&] { return latency::process_pair(effort); }));
  Figure shm;
  try {
    const RoudiLease lease(share_dir() / "roudi.toml");
    shm = take("round trip, shared memory", latency::measure_apart([&] { return latency::round_trip(effort, "shm"); }));
  } catch (const SetupError& e) {
    shm.error = e.what();
    take("round trip, shared memory", shm);
  }
  const Figure udp =
      take("round trip, UDP", latency::measure_apart([&] { return latency::round_trip(effort, "udp"); }));
  const latency::Advice by_shm = latency::advise(wakeup, shm, options.compute_us),
                        by_udp = latency::advise(wakeup, udp, options.compute_us);
  const auto said = [](const latency::Advice& a) {
    return a.rate_hz > 0 ? std::to_string(static_cast<int>(a.rate_hz)) + " Hz" : std::string("none");
  };
  if (options.json) {
    const auto advice = [](const latency::Advice& a) { return Json{{"rate_hz", a.rate_hz}, {"reason", a.reason}}; };
    std::printf(
        "%s\n",
        Json{{"figures", rows}, {"advice", {{"shm", advice(by_shm)}, {"udp", advice(by_udp)}}}}.dump(2).c_str());
    return 0;
  }
  std::printf("\nAdvised rate (device.rate_hz)\n  shared memory: %s. %s\n  UDP: %s. %s\n", said(by_shm).c_str(),
              by_shm.reason.c_str(), said(by_udp).c_str(), by_udp.reason.c_str());
  return 0;
}

}  // namespace tact::cli
