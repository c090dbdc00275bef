#include "contact/traversal/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/traversal/place.hpp"

namespace tact::contact {
namespace {

/// Radii are rounded to single precision.
constexpr double kRadiusSlack = 1 + 1e-6;
/// Nodes probed at once: enough to hide the latency of memory.
constexpr std::size_t kChunk = 64;
/// Children queued at once; what is written too much is overwritten by the next.
constexpr std::uint32_t kAppend = 8;

std::size_t whole_vectors(std::size_t n) { return (n + 7) / 8 * 8; }

}  // namespace

bool is_rigid(const Pose& X) noexcept { return X.finite() && std::fabs(X.q.norm() - 1) < 1e-3; }

Traversal::Traversal(DistanceField field, std::shared_ptr<const Pointshell> shell)
    : field_(std::move(field)), shell_(std::move(shell)), candidates_(shell_->size() + 1) {
  std::uint32_t last_top = 0;  // first node of the last level that is taken at once with those above
  for (const std::uint32_t end : shell_->level_begin) {
    if (top_size_ > 0 && end > kChunk) break;
    last_top = top_size_;
    top_size_ = end;
  }
  nodes_.reserve(shell_->size() + kAppend);
  for (std::size_t i = 0; i < shell_->size(); ++i) {
    const Eigen::Vector3f& p = shell_->position_T[i];
    const std::uint32_t begin = shell_->child_begin[i], end = shell_->child_end[i];
    nodes_.push_back({p.x(), p.y(), p.z(), shell_->radius_m[i], begin, i >= last_top && begin < end ? end - begin : 0});
  }
  nodes_.resize(shell_->size() + kAppend);  // prefetched
  level_.id.resize(shell_->size() + kAppend);
  next_level_.id.resize(shell_->size() + kAppend);
}

void Traversal::append(std::uint32_t begin, std::uint32_t count, Queue& to) const noexcept {
  std::uint32_t* out = to.id.data() + to.size;
  to.size += count;
  for (std::uint32_t k = 0; k < count; k += kAppend) {  // once, but for large families
    for (std::uint32_t j = 0; j < kAppend; ++j) out[k + j] = begin + k + j;
    for (std::uint32_t j = 0; j < kAppend; j += 2) __builtin_prefetch(nodes_.data() + begin + k + j);
  }
}

Findings Traversal::find(const Pose& X_OT, ContactBuffer& contacts) noexcept {
  Findings found;
  contacts.size = contacts.dropped = 0;
  if (!is_rigid(X_OT)) {
    found.status = bit(Status::pose_invalid);
    return found;
  }
  const Mat3 R_OT = X_OT.q.normalized().toRotationMatrix();
  const Vec3 p_OT = X_OT.p;

  // In contact the clearance is 0 and needs no search. Contact mostly goes on: if it ended, search again.
  if (touched_) search(R_OT, p_OT, false, found);
  if (!touched_ || candidate_count_ == 0) search(R_OT, p_OT, true, found);
  touched_ = candidate_count_ > 0;

  for (std::size_t k = 0; k < candidate_count_; ++k) {
    found.max_depth_m = std::max(found.max_depth_m, candidates_[k].depth_m);
  }
  keep_deepest(contacts, found);
  fill(R_OT, p_OT, contacts, found);
  return found;
}

void Traversal::search(const Mat3& R_OT, const Vec3& p_OT, bool want_clearance, Findings& found) noexcept {
  double clearance = want_clearance ? std::numeric_limits<double>::infinity() : 0;
  candidate_count_ = 0;
  level_.size = 0;
  append(0, top_size_, level_);
  while (level_.size > 0) {
    next_level_.size = 0;
    found.nodes_visited += level_.size;
    for (std::size_t begin = 0; begin < level_.size; begin += kChunk) {
      const std::size_t count = std::min(kChunk, level_.size - begin);
      visit({level_.id.data() + begin, count}, R_OT, p_OT, next_level_, clearance);
    }
    std::swap(level_, next_level_);
  }
  found.clearance_m = candidate_count_ > 0 ? 0.0 : std::max(clearance, 0.0);
}

void Traversal::visit(std::span<const std::uint32_t> ids, const Mat3& R_OT, const Vec3& p_OT, Queue& next,
                      double& clearance) noexcept {
  float x_T[kChunk], y_T[kChunk], z_T[kChunk], radii[kChunk];
  bool has_children[kChunk];
  double x[kChunk], y[kChunk], z[kChunk], value[kChunk], promise[kChunk];
  const std::size_t padded = whole_vectors(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Node& node = nodes_[ids[i]];
    x_T[i] = node.x;
    y_T[i] = node.y;
    z_T[i] = node.z;
    radii[i] = node.radius;
    has_children[i] = node.child_count > 0;
  }
  for (std::size_t i = ids.size(); i < padded; ++i) {  // whole vectors: the last one again
    x_T[i] = x_T[i - 1];
    y_T[i] = y_T[i - 1];
    z_T[i] = z_T[i - 1];
  }
  place(R_OT, p_OT, x_T, y_T, z_T, padded, x, y, z);
  field_.probe({x, y, z, padded}, value, promise);

  // While the clearance may still exceed half a voxel (below that nobody needs it), go a little deeper than contacts
  // demand: a skipped subtree then tells its clearance within a factor of two.
  const double enough = clearance > 0.5 * field_.voxel_m() ? 2 : 1;
  std::uint32_t open[kChunk];  // nodes to go deeper at
  std::size_t open_count = 0;
  const std::size_t first_new = candidate_count_;
  double least = clearance;
  for (std::size_t i = 0; i < ids.size(); ++i) {  // without branches that depend on where nodes lie
    const double radius = kRadiusSlack * static_cast<double>(radii[i]);
    const int skip = promise[i] > enough * radius;
    const double free = promise[i] - skip * radius;
    least = free < least ? free : least;
    candidates_[candidate_count_] = {-value[i], ids[i]};
    candidate_count_ += value[i] < 0 ? 1 : 0;
    open[open_count] = ids[i];
    open_count += static_cast<std::size_t>((1 - skip) & static_cast<int>(has_children[i]));
  }
  clearance = least;
  for (std::size_t k = first_new; k < candidate_count_; ++k) {
    __builtin_prefetch(&shell_->position_T[candidates_[k].id]);
    __builtin_prefetch(&shell_->normal_T[candidates_[k].id]);
  }
  for (std::size_t k = 0; k < open_count; ++k) {
    append(nodes_[open[k]].child_begin, nodes_[open[k]].child_count, next);
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
    const std::size_t padded = whole_vectors(count);
    for (std::size_t k = count; k < padded; ++k) x[k] = x[k - 1], y[k] = y[k - 1], z[k] = z[k - 1];
    field_.sample({x, y, z, padded}, {value, gx, gy, gz, in_field});
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
