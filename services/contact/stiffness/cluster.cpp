#include "contact/stiffness/cluster.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "fault/fault.hpp"

namespace tact::contact {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostPairs = std::size_t{1} << 26;

/// All (i, j), j < i, with points less than `radius` apart, by sweeping along x.
std::vector<std::pair<std::uint32_t, std::uint32_t>> near_pairs(const Pointshell& shell, double radius_m) {
  const auto at = [&](std::uint32_t i) { return Vec3(shell.position_T[i].cast<double>()); };
  std::vector<std::uint32_t> order(shell.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return std::pair(at(a).x(), a) < std::pair(at(b).x(), b); });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const Vec3 p = at(order[a]);
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      const Vec3 d = at(order[b]) - p;
      if (d.x() >= radius_m) break;
      if (d.squaredNorm() >= radius_m * radius_m) continue;
      pairs.emplace_back(std::max(order[a], order[b]), std::min(order[a], order[b]));
      if (pairs.size() > kMostPairs) {
        throw SetupError("contact.cluster_voxels: found " + std::to_string(radius_m) +
                         " m, expected a distance nearer to the spacing of the tool's points");
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

Cluster::Cluster(const Pointshell& shell, double radius_m, std::size_t capacity, std::unique_ptr<Law> weigher)
    : weigher_(std::move(weigher)),
      near_begin_(shell.size() + 1),
      in_contact_((shell.size() + 63) / 64),
      place_(shell.size()),
      root_(std::min(capacity, shell.size())),
      members_(root_.size()),
      groups_(root_.size()) {
  for (const auto& [i, j] : near_pairs(shell, radius_m)) {
    ++near_begin_[i + 1];
    near_.push_back(j);
  }
  std::partial_sum(near_begin_.begin(), near_begin_.end(), near_begin_.begin());
}

void Cluster::weigh(ContactBuffer& contacts) noexcept {
  group_count_ = 0;
  if (link(contacts)) merge(contacts);
  weigher_->weigh(contacts);
  for (std::size_t c = 0; c < group_count_; ++c) groups_[c].weight = contacts.weight[c];
}

std::uint32_t Cluster::find_root(std::uint32_t contact) noexcept {
  while (root_[contact] != contact) {
    root_[contact] = root_[root_[contact]];
    contact = root_[contact];
  }
  return contact;
}

/// Joins contacts that are near each other under the first of them. False: there are none.
bool Cluster::link(const ContactBuffer& contacts) noexcept {
  bool any = false;
  for (std::uint32_t i = 0; i < contacts.size; ++i) {
    const std::uint32_t id = contacts.point_id[i];
    in_contact_[id / 64] |= std::uint64_t{1} << (id % 64);
    place_[id] = i;
    root_[i] = i;
    for (std::uint32_t n = near_begin_[id]; n < near_begin_[id + 1]; ++n) {  // of lower id: they have been here
      const std::uint32_t other = near_[n];
      if ((in_contact_[other / 64] >> (other % 64) & 1) == 0) continue;
      const std::uint32_t a = find_root(i), b = find_root(place_[other]);
      root_[std::max(a, b)] = std::min(a, b);
      any = true;
    }
  }
  for (std::uint32_t i = 0; i < contacts.size; ++i) in_contact_[contacts.point_id[i] / 64] = 0;
  return any;
}

/// Writes the groups over the contacts. A root comes before the other members, so it opens its group.
void Cluster::merge(ContactBuffer& contacts) noexcept {
  along_normal_ = contacts.force_along == ForceDirection::normal;
  for (std::uint32_t i = 0; i < contacts.size; ++i) {
    Member& m = members_[i];
    m = {contacts.r[i], contacts.N[i], contacts.g[i], contacts.depth_m[i], kNone, 0};
    const std::uint32_t root = find_root(i), flags = contacts.flags[i];
    if (root == i) {
      m.group = static_cast<std::uint32_t>(group_count_++);
      groups_[m.group] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 0, 0, 0, i, i};
      contacts.point_id[m.group] = contacts.point_id[i];
      contacts.flags[m.group] = 0;
    }
    const std::uint32_t c = members_[root].group;
    Group& group = groups_[c];
    group.r += m.depth_m * m.r;
    group.N += m.depth_m * m.N;
    group.g += m.depth_m * m.g;
    group.depth_m += m.depth_m * m.depth_m;
    group.depth_sum_m += m.depth_m;
    contacts.flags[c] |= flags;
    if (root != i) members_[std::exchange(group.last, i)].next = i;
  }
  for (std::size_t c = 0; c < group_count_; ++c) {
    Group& group = groups_[c];
    if (group.first != group.last) {
      const double share = 1 / group.depth_sum_m;
      group.r *= share;
      group.N *= share;
      group.g *= share;
      group.depth_m *= share;
    } else {
      const Member& m = members_[group.first];  // alone: as it is, to the last bit
      group.r = m.r, group.N = m.N, group.g = m.g, group.depth_m = m.depth_m;
    }
    contacts.r[c] = group.r;
    contacts.N[c] = group.N;
    contacts.g[c] = group.g;
    contacts.depth_m[c] = group.depth_m;
  }
  contacts.size = group_count_;
}

/// With d depth_i = -sh_i.dx and D = sum depth_i^2 / sum depth_i of the group,
///   dD = -sum_i c_i sh_i.dx,        c_i = (2 depth_i - D) / sum depth
///   de = -sum_i (e_i - e) sh_i.dx / sum depth,   dr = -sum_i (r_i - r) sh_i.dx / sum depth
/// and a group's part of sh is w times the derivative of -D (e, r x e). What r and N do by turning with the tool is no
/// part of it.
void Cluster::include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept {
  weigher_->include_weight_derivative(ss, sh);
  for (std::size_t c = 0; c < group_count_; ++c) {
    const Group& group = groups_[c];
    if (group.first == group.last) continue;
    const bool along_N = along_normal_ || group.g.isZero(0);
    const Vec3& e = along_N ? group.N : group.g;
    Vec6 s, mean;
    s << e, group.r.cross(e);
    mean << group.g, group.r.cross(group.g);
    Mat6 change = -s * mean.transpose();
    const double inverse = 1 / group.depth_sum_m;
    for (std::uint32_t i = group.first; i != kNone; i = members_[i].next) {
      const Member& m = members_[i];
      const Vec3 de = (along_N ? m.N : m.g) - e;
      Vec6 turn, own;
      turn << de, (m.r - group.r).cross(e) + group.r.cross(de);
      own << m.g, m.r.cross(m.g);
      change += inverse * ((2 * m.depth_m - group.depth_m) * s + group.depth_m * turn) * own.transpose();
    }
    sh += group.weight * change;
  }
}

}  // namespace tact::contact
