#include "contact/traversal/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tact::contact {
namespace {

/// Radii are rounded to single precision.
constexpr double kRadiusSlack = 1 + 1e-6;

}  // namespace

bool is_rigid(const Pose& X) noexcept { return X.finite() && std::fabs(X.q.norm() - 1) < 1e-3; }

Traversal::Traversal(DistanceField field, std::shared_ptr<const Pointshell> shell)
    : field_(std::move(field)),
      shell_(std::move(shell)),
      level_(shell_->size() + 1),
      next_level_(shell_->size() + 1),
      candidates_(shell_->size()) {}

Findings Traversal::find(const Pose& X_OT, ContactBuffer& contacts) noexcept {
  Findings found;
  contacts.size = contacts.dropped = 0;
  candidate_count_ = 0;
  if (!is_rigid(X_OT)) {
    found.status = bit(Status::pose_invalid);
    return found;
  }
  const Pointshell& shell = *shell_;
  const Mat3 R_OT = X_OT.q.normalized().toRotationMatrix();
  const Vec3 p_OT = X_OT.p;
  double clearance = std::numeric_limits<double>::infinity();

  std::size_t level_count = 0;
  if (shell.level_begin.size() > 1) level_[level_count++] = {shell.level_begin[0], shell.level_begin[1]};
  while (level_count > 0) {
    std::size_t next_count = 0;
    for (std::size_t k = 0; k < level_count; ++k) {
      const Range range = level_[k];
      found.nodes_visited += range.end - range.begin;
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const Vec3 p_O = R_OT * shell.position_T[i].cast<double>() + p_OT;
        const DistanceField::Probe probe = field_.probe(p_O);
        const double radius = kRadiusSlack * static_cast<double>(shell.radius_m[i]);
        // While the clearance may still exceed half a voxel (below that nobody needs it), go a little deeper than
        // contacts demand: a skipped subtree then tells its clearance within a factor of two.
        const double enough = clearance > 0.5 * field_.voxel_m() ? 2 * radius : radius;
        if (probe.clearance_m > enough) {
          clearance = std::min(clearance, probe.clearance_m - radius);
          continue;
        }
        clearance = std::min(clearance, probe.clearance_m);
        if (probe.value_m < 0) candidates_[candidate_count_++] = {-probe.value_m, i};
        if (shell.child_begin[i] < shell.child_end[i]) {
          next_level_[next_count++] = {shell.child_begin[i], shell.child_end[i]};
        }
      }
    }
    level_.swap(next_level_);
    level_count = next_count;
  }
  for (std::size_t k = 0; k < candidate_count_; ++k) {
    found.max_depth_m = std::max(found.max_depth_m, candidates_[k].depth_m);
  }
  found.clearance_m = candidate_count_ > 0 ? 0.0 : std::max(clearance, 0.0);
  keep_deepest(contacts, found);
  fill(R_OT, p_OT, contacts, found);
  return found;
}

void Traversal::keep_deepest(ContactBuffer& contacts, Findings& found) noexcept {
  if (candidate_count_ <= contacts.capacity()) return;
  contacts.dropped = candidate_count_ - contacts.capacity();
  found.status |= bit(Status::overflow);
  const auto begin = candidates_.begin();
  const auto kept = begin + static_cast<std::ptrdiff_t>(contacts.capacity());
  std::nth_element(begin, kept, begin + static_cast<std::ptrdiff_t>(candidate_count_),
                   [](const Candidate& a, const Candidate& b) {
                     return a.depth_m != b.depth_m ? a.depth_m > b.depth_m : a.id < b.id;
                   });
  std::sort(begin, kept, [](const Candidate& a, const Candidate& b) { return a.id < b.id; });
  candidate_count_ = contacts.capacity();
}

void Traversal::fill(const Mat3& R_OT, const Vec3& p_OT, ContactBuffer& contacts, Findings& found) noexcept {
  contacts.size = candidate_count_;
  for (std::size_t k = 0; k < candidate_count_; ++k) {
    const std::uint32_t i = candidates_[k].id;
    const Vec3 r = R_OT * shell_->position_T[i].cast<double>();
    const Vec3 N = R_OT * shell_->normal_T[i].cast<double>();
    const DistanceField::Sample sample = field_.sample(r + p_OT);
    std::uint32_t flags = 0;
    if (!sample.in_band) flags |= bit(Status::beyond_band);
    if (sample.doubtful) flags |= bit(Status::sign_doubtful);
    if (sample.gradient.dot(N) < -0.5 * sample.gradient.norm()) flags |= bit(Status::past_mid_surface);
    contacts.point_id[k] = i;
    contacts.r[k] = r;
    contacts.N[k] = N;
    contacts.g[k] = sample.gradient;
    contacts.depth_m[k] = candidates_[k].depth_m;
    contacts.flags[k] = flags;
    found.status |= flags;
  }
}

}  // namespace tact::contact
