#include <algorithm>
#include <cmath>
#include <queue>

#include "contact/bake/worker/point_grid.hpp"
#include "contact/bake/worker/samples.hpp"

namespace tact::contact {
namespace {

/// Drops points from `alive` until `target` are left, the most crowded first. Returns the dropped, in order.
std::vector<std::uint32_t> drop_crowded(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& preferred,
                                        std::vector<std::uint32_t>& alive, std::size_t target, double area_m2) {
  std::vector<Vec3> at;
  at.reserve(alive.size());
  for (const std::uint32_t i : alive) at.push_back(points[i]);
  const double reach = packing_spacing(area_m2, target);  // 2 r_max of the paper
  const PointGrid grid(at, reach);
  const auto influence = [reach](double square) {
    const double x = 1 - std::sqrt(square) / reach;
    const double x2 = x * x, x4 = x2 * x2;
    return x4 * x4;
  };
  std::vector<double> weight(at.size(), 0);
  for (std::size_t i = 0; i < at.size(); ++i) {
    grid.within(at[i], reach, [&](std::uint32_t j, double square) {
      if (j != i) weight[i] += influence(square);
    });
  }
  const auto key = [&](std::uint32_t i) { return weight[i] - (preferred[alive[i]] ? 1e6 : 0); };
  using Entry = std::pair<double, std::uint32_t>;
  std::vector<Entry> entries;
  for (std::uint32_t i = 0; i < at.size(); ++i) entries.emplace_back(key(i), i);
  std::priority_queue<Entry> queue(std::less<Entry>{}, std::move(entries));
  std::vector<std::uint8_t> gone(at.size(), 0);
  std::vector<std::uint32_t> dropped;
  while (at.size() - dropped.size() > target) {
    const double k = queue.top().first;
    const std::uint32_t i = queue.top().second;
    queue.pop();
    if (k > key(i) + 1e-12) {  // a neighbour went meanwhile
      queue.emplace(key(i), i);
      continue;
    }
    gone[i] = 1;
    dropped.push_back(alive[i]);
    grid.within(at[i], reach, [&](std::uint32_t j, double square) {
      if (j != i && !gone[j]) weight[j] -= influence(square);
    });
  }
  std::vector<std::uint32_t> left;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!gone[i]) left.push_back(alive[i]);
  }
  alive = std::move(left);
  return dropped;
}

}  // namespace

std::vector<std::uint32_t> spread_order(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& preferred,
                                        std::size_t count, double area_m2, const StageProgress& progress) {
  const auto report = [&](double fraction) {
    if (progress && !progress("blue noise", fraction)) throw Cancelled();
  };
  report(0);
  std::vector<std::uint32_t> alive(points.size());
  std::iota(alive.begin(), alive.end(), 0u);
  if (alive.size() > count) drop_crowded(points, preferred, alive, count, area_m2);
  report(0.7);
  // Halve again and again; what goes first comes last.
  const std::vector<std::uint8_t> equal(points.size(), 0);
  std::vector<std::uint32_t> backwards;
  while (alive.size() > 1) {
    const auto dropped = drop_crowded(points, equal, alive, alive.size() / 2, area_m2);
    backwards.insert(backwards.end(), dropped.begin(), dropped.end());
  }
  if (!alive.empty()) backwards.push_back(alive.front());
  std::reverse(backwards.begin(), backwards.end());
  report(1);
  return backwards;
}

}  // namespace tact::contact
