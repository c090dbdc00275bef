#include "contact/traversal/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "contact/traversal/place.hpp"

namespace tact::contact {
namespace {

/// Radii are rounded to single precision.
constexpr double kRadiusSlack = 1 + 1e-6;
/// Nodes probed at once: enough to hide the latency of memory.
constexpr std::size_t kChunk = 64;
/// Children copied at once.
constexpr std::size_t kAppend = 8;

}  // namespace

bool is_rigid(const Pose& X) noexcept { return X.finite() && std::fabs(X.q.norm() - 1) < 1e-3; }

/// Beyond the last node: what append() copies and whole vectors read too much.
constexpr std::size_t kRoom = 16;

Traversal::Nodes::Nodes(std::size_t capacity)
    : x(capacity + kRoom), y(capacity + kRoom), z(capacity + kRoom), radius(capacity + kRoom), id(capacity + kRoom) {}

Traversal::Traversal(DistanceField field, std::shared_ptr<const Pointshell> shell)
    : field_(std::move(field)),
      shell_(std::move(shell)),
      all_(shell_->size()),
      level_(shell_->size()),
      next_level_(shell_->size()),
      candidates_(shell_->size() + 1) {
  for (std::uint32_t i = 0; i < shell_->size(); ++i) {
    all_.x[i] = shell_->position_T[i].x();
    all_.y[i] = shell_->position_T[i].y();
    all_.z[i] = shell_->position_T[i].z();
    all_.radius[i] = shell_->radius_m[i];
    all_.id[i] = i;
  }
}

void Traversal::append(std::uint32_t begin, std::uint32_t end, Nodes& to) const noexcept {
  // Whole vectors: what is copied too much is overwritten by the next.
  for (; begin < end; begin += kAppend) {
    const std::size_t at = to.size;
    std::memcpy(&to.x[at], &all_.x[begin], kAppend * sizeof(float));
    std::memcpy(&to.y[at], &all_.y[begin], kAppend * sizeof(float));
    std::memcpy(&to.z[at], &all_.z[begin], kAppend * sizeof(float));
    std::memcpy(&to.radius[at], &all_.radius[begin], kAppend * sizeof(float));
    std::memcpy(&to.id[at], &all_.id[begin], kAppend * sizeof(std::uint32_t));
    to.size += std::min<std::size_t>(end - begin, kAppend);
  }
}

Findings Traversal::find(const Pose& X_OT, ContactBuffer& contacts) noexcept {
  Findings found;
  contacts.size = contacts.dropped = 0;
  candidate_count_ = 0;
  if (!is_rigid(X_OT)) {
    found.status = bit(Status::pose_invalid);
    return found;
  }
  const Mat3 R_OT = X_OT.q.normalized().toRotationMatrix();
  const Vec3 p_OT = X_OT.p;
  double clearance = std::numeric_limits<double>::infinity();

  level_.size = 0;
  if (shell_->level_begin.size() > 1) append(shell_->level_begin[0], shell_->level_begin[1], level_);
  while (level_.size > 0) {
    next_level_.size = 0;
    found.nodes_visited += level_.size;
    for (std::size_t begin = 0; begin < level_.size; begin += kChunk) {
      visit(level_, begin, std::min(kChunk, level_.size - begin), R_OT, p_OT, next_level_, clearance);
    }
    std::swap(level_, next_level_);
  }
  for (std::size_t k = 0; k < candidate_count_; ++k) {
    found.max_depth_m = std::max(found.max_depth_m, candidates_[k].depth_m);
  }
  found.clearance_m = candidate_count_ > 0 ? 0.0 : std::max(clearance, 0.0);
  keep_deepest(contacts, found);
  fill(R_OT, p_OT, contacts, found);
  return found;
}

void Traversal::visit(const Nodes& level, std::size_t begin, std::size_t count, const Mat3& R_OT, const Vec3& p_OT,
                      Nodes& next, double& clearance) noexcept {
  double x[kChunk], y[kChunk], z[kChunk], value[kChunk], promise[kChunk];
  place(R_OT, p_OT, &level.x[begin], &level.y[begin], &level.z[begin], (count + 7) / 8 * 8, x, y, z);
  field_.probe({x, y, z, count}, value, promise);

  // While the clearance may still exceed half a voxel (below that nobody needs it), go a little deeper than contacts
  // demand: a skipped subtree then tells its clearance within a factor of two.
  const double enough = clearance > 0.5 * field_.voxel_m() ? 2 : 1;
  std::uint32_t open[kChunk];  // nodes to go deeper at
  std::size_t open_count = 0;
  double least = clearance;
  for (std::size_t i = 0; i < count; ++i) {  // without branches that depend on where nodes lie
    const double radius = kRadiusSlack * static_cast<double>(level.radius[begin + i]);
    const int skip = promise[i] > enough * radius;
    const double free = promise[i] - skip * radius;
    least = free < least ? free : least;
    candidates_[candidate_count_] = {-value[i], level.id[begin + i]};
    candidate_count_ += value[i] < 0 ? 1 : 0;
    open[open_count] = level.id[begin + i];
    open_count += static_cast<std::size_t>(1 - skip);
  }
  clearance = least;
  for (std::size_t k = 0; k < open_count; ++k) {
    append(shell_->child_begin[open[k]], shell_->child_end[open[k]], next);
  }
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
  for (std::size_t begin = 0; begin < candidate_count_; begin += kChunk) {
    const std::size_t count = std::min(kChunk, candidate_count_ - begin);
    double x[kChunk], y[kChunk], z[kChunk], value[kChunk], gx[kChunk], gy[kChunk], gz[kChunk];
    std::uint8_t in_field[kChunk];
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = candidates_[begin + k].id;
      const Vec3 r = R_OT * shell_->position_T[i].cast<double>();
      const Vec3 p = r + p_OT;
      x[k] = p.x(), y[k] = p.y(), z[k] = p.z();
      contacts.r[begin + k] = r;
      contacts.N[begin + k] = R_OT * shell_->normal_T[i].cast<double>();
    }
    field_.sample({x, y, z, count}, {value, gx, gy, gz, in_field});
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 g(gx[k], gy[k], gz[k]);
      const double along = g.dot(contacts.N[begin + k]);
      std::uint32_t flags = 0;
      if ((in_field[k] & DistanceField::kInBand) == 0) flags |= bit(Status::beyond_band);
      if ((in_field[k] & DistanceField::kDoubtful) != 0) flags |= bit(Status::sign_doubtful);
      if (along < -0.5 * g.norm()) flags |= bit(Status::past_mid_surface);
      contacts.point_id[begin + k] = candidates_[begin + k].id;
      contacts.g[begin + k] = g;
      contacts.depth_m[begin + k] = candidates_[begin + k].depth_m;
      contacts.flags[begin + k] = flags;
      found.status |= flags;
    }
  }
}

}  // namespace tact::contact
