#include "contact/bake/worker/inside.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tact::contact {
namespace {

constexpr int kPairs = 12;
constexpr double kForEver = std::numeric_limits<double>::infinity();

/// One of each opposite pair, so that a lone sheet gets exactly half of the votes. Spread over the sphere (Fibonacci),
/// turned off every axis, plane and diagonal that CAD likes; the order makes the first few, too, look all round.
const std::array<Vec3, kPairs>& directions() {
  static const std::array<Vec3, kPairs> kDirections = [] {
    std::array<Vec3, kPairs> d;
    const Mat3 turn = Eigen::AngleAxisd(0.7123, Vec3(0.3171, -0.8113, 0.4911).normalized()).toRotationMatrix();
    for (int i = 0; i < kPairs; ++i) {
      const int k = i * 5 % kPairs;
      const double z = 1 - (k + 0.5) / kPairs, a = k * 2.399963229728653;  // half a sphere
      d[static_cast<std::size_t>(i)] =
          turn * Vec3(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
    }
    return d;
  }();
  return kDirections;
}

std::vector<Crossing>& scratch() {
  thread_local std::vector<Crossing> found;
  found.clear();
  return found;
}

}  // namespace

Inside::Inside(Surface surface, std::vector<std::uint32_t> part, std::vector<std::uint32_t> component,
               std::vector<std::int8_t> role)
    : surface_(std::move(surface)),
      part_(std::make_shared<const std::vector<std::uint32_t>>(std::move(part))),
      component_(std::make_shared<const std::vector<std::uint32_t>>(std::move(component))),
      role_(std::move(role)) {}

Inside::Answer Inside::ask_ray(const Vec3& p, const Vec3& direction, std::vector<std::uint32_t>& odd) const {
  std::vector<Crossing>& found = scratch();
  surface_.cross(p, direction, kForEver, found);
  int held = 0;
  bool by_closed_parts = true;
  std::size_t n = found.size(), open = 0;
  while (n > 0) {  // one part after the other, or component of the rest; there are few along a ray
    const std::uint32_t part = this->part(found[n - 1].triangle), component = (*component_)[found[n - 1].triangle];
    int winding = 0, crossings = 0;
    std::size_t others = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t t = found[i].triangle;
      if (this->part(t) == part && (part != 0 || (*component_)[t] == component)) {
        winding += found[i].against ? 1 : -1;
        ++crossings;
      } else {
        found[others++] = found[i];
      }
    }
    n = others;
    by_closed_parts = by_closed_parts && part != 0;
    if (part != 0) {
      if (winding != 0) held += role_[part];
    } else if (crossings % 2 == 1) {
      odd.push_back(component);
      ++open;
    }
  }
  if (open % 2 == 1) held += role_[0];
  return {held > 0, by_closed_parts, open};
}

Vote Inside::count(int in, std::vector<std::uint32_t>& odd, double close_from) const {
  constexpr double kRays = 2 * kPairs, kMost = 0.6 * kRays;
  std::sort(odd.begin(), odd.end());
  bool alone = false;
  for (auto first = odd.begin(); first != odd.end() && !alone;) {
    const auto last = std::upper_bound(first, odd.end(), *first);
    alone = static_cast<double>(last - first) > kMost;
    first = last;
  }
  const bool together = in > kMost, disputed = alone && !together;
  return {together || alone, disputed || (in >= close_from * kRays && in <= (1 - close_from) * kRays), false, disputed};
}

Vote Inside::vote(const Vec3& p) const {
  int in = 0, out = 0;
  bool by_closed_parts = true, several = false;
  thread_local std::vector<std::uint32_t> odd;
  odd.clear();
  const auto cast = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      const Vec3& d = directions()[static_cast<std::size_t>(i)];
      for (const Vec3& along : {d, Vec3(-d)}) {
        const Answer answer = ask_ray(p, along, odd);
        ++(answer.inside ? in : out);
        by_closed_parts = by_closed_parts && answer.by_closed_parts;
        several = several || (answer.open > 1 && !answer.inside);
      }
    }
  };
  cast(0, 2);
  if (!several && (in == 0 || out == 0)) return {in > 0, false, by_closed_parts};
  cast(2, 4);
  if (!several && (in >= 7 || out >= 7)) return {in >= 7, false, false};
  cast(4, kPairs);
  return count(in, odd, 0.4);
}

Vote Inside::careful_vote(const Vec3& p) const {
  int in = 0;
  thread_local std::vector<std::uint32_t> odd;
  odd.clear();
  for (const Vec3& d : directions()) {
    for (const Vec3& along : {d, Vec3(-d)}) in += ask_ray(p, along, odd).inside ? 1 : 0;
  }
  return count(in, odd, 0.25);
}

std::vector<std::uint32_t> Inside::parts_around(const Vec3& p) const {
  std::vector<std::uint32_t> held;  // once for each ray that says so
  std::vector<Crossing>& found = scratch();
  for (const Vec3& d : directions()) {
    found.clear();
    surface_.cross(p, d, kForEver, found);
    const auto by_part = [&](const Crossing& a, const Crossing& b) { return part(a.triangle) < part(b.triangle); };
    std::sort(found.begin(), found.end(), by_part);
    for (auto c = found.begin(); c != found.end();) {
      const std::uint32_t k = part(c->triangle);
      int winding = 0;
      for (; c != found.end() && part(c->triangle) == k; ++c) winding += c->against ? 1 : -1;
      if (k == 0 ? winding % 2 != 0 : winding != 0) held.push_back(k);  // the sum has the parity of the count
    }
  }
  std::sort(held.begin(), held.end());
  std::vector<std::uint32_t> around;
  for (auto first = held.begin(); first != held.end();) {
    const auto last = std::upper_bound(first, held.end(), *first);
    if (2 * (last - first) > kPairs) around.push_back(*first);
    first = last;
  }
  return around;
}

}  // namespace tact::contact
