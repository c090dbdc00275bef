#include "contact/traversal/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tact::contact {
namespace {

/// Radii are rounded to single precision.
constexpr double kRadiusSlack = 1 + 1e-6;
/// Nodes probed at once: enough to hide the latency of memory.
constexpr std::size_t kChunk = 64;
/// Children queued at once; what is written too much is overwritten by the next.
constexpr std::uint32_t kAppend = 8;

/// A chunk of nodes, made whole vectors: behind the last one itself again.
struct Chunk {
  alignas(64) Node node[kChunk];
  alignas(64) double x[kChunk], y[kChunk], z[kChunk], radius[kChunk];
  std::size_t padded;

  void place(const Mat3& R, const Vec3& t, std::size_t count) noexcept {
    for (padded = count; padded % 8 != 0; ++padded) node[padded] = node[padded - 1];
    tact::contact::place(R, t, node, padded, {x, y, z, radius});
  }
  DistanceField::Points points() const noexcept { return {x, y, z, padded}; }
};

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
  std::uint32_t leaves = 0;  // nothing from here on has children
  nodes_.reserve(shell_->size() + kAppend);
  for (std::uint32_t i = 0; i < shell_->size(); ++i) {
    const Eigen::Vector3f& p = shell_->position_T[i];
    nodes_.push_back({p.x(), p.y(), p.z(), shell_->radius_m[i]});
    if (i >= last_top && shell_->child_begin[i] < shell_->child_end[i]) leaves = i + 1;
  }
  for (std::uint32_t i = 0; i < leaves; ++i) {
    const std::uint32_t begin = shell_->child_begin[i], end = shell_->child_end[i];
    families_.push_back({begin, i >= last_top && begin < end ? end - begin : 0});
  }
  nodes_.resize(shell_->size() + kAppend);  // prefetched
  level_.id.resize(shell_->size() + kAppend);
  next_level_.id.resize(shell_->size() + kAppend);
}

void Traversal::append(Family family, Queue& to) const noexcept {
  std::uint32_t* out = to.id.data() + to.size;
  to.size += family.count;
  for (std::uint32_t k = 0; k < family.count; k += kAppend) {  // once, but for large families
    for (std::uint32_t j = 0; j < kAppend; ++j) out[k + j] = family.begin + k + j;
    for (std::uint32_t j = 0; j < kAppend; j += 4) __builtin_prefetch(nodes_.data() + family.begin + k + j);
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
  append({0, top_size_}, level_);
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
  Chunk chunk;
  double enough[kChunk], value[kChunk], promise[kChunk];
  const std::size_t count = ids.size();
  const Node* nodes = nodes_.data();
  for (std::size_t i = 0; i < count; ++i) chunk.node[i] = nodes[ids[i]];
  chunk.place(R_OT, p_OT, count);

  // While the clearance may still exceed half a voxel (below that nobody needs it), go a little deeper than contacts
  // demand: a skipped subtree then tells its clearance within a factor of two, a point within that of the field.
  const bool search_clearance = clearance > 0.5 * field_.voxel_m();
  const double factor = (search_clearance ? 2 : 1) * kRadiusSlack, more = search_clearance ? field_.band_m() : 0;
  for (std::size_t i = 0; i < chunk.padded; ++i) enough[i] = factor * chunk.radius[i] + more;
  field_.probe(chunk.points(), enough, value, promise);

  // Without branches that depend on where nodes lie.
  Candidate* found = candidates_.data() + candidate_count_;
  for (std::size_t i = 0; i < count; ++i) {
    *found = {-value[i], ids[i]};
    found += value[i] < 0 ? 1 : 0;
  }
  for (const Candidate* c = candidates_.data() + candidate_count_; c < found; ++c) {
    __builtin_prefetch(&shell_->normal_T[c->id]);
  }
  candidate_count_ = static_cast<std::size_t>(found - candidates_.data());
  if (clearance > 0) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool skip = promise[i] > factor * chunk.radius[i];
      const double free = promise[i] - (skip ? kRadiusSlack * chunk.radius[i] : 0.0);
      clearance = free < clearance ? free : clearance;
    }
  }
  if (ids.front() >= families_.size()) return;  // leaves
  std::uint32_t open[kChunk];                   // nodes to go deeper at
  std::size_t open_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    open[open_count] = ids[i];
    open_count += promise[i] > factor * chunk.radius[i] ? 0 : 1;
  }
  for (std::size_t k = 0; k < open_count; ++k) {
    if (open[k] < families_.size()) append(families_[open[k]], next);
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
    Chunk r, N;
    double value[kChunk], gx[kChunk], gy[kChunk], gz[kChunk];
    std::uint8_t in_field[kChunk];
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = candidates_[begin + k].id;
      const Eigen::Vector3f& n = shell_->normal_T[i];
      r.node[k] = nodes_[i];
      N.node[k] = {n.x(), n.y(), n.z(), 0};
    }
    r.place(R_OT, Vec3::Zero(), count);
    N.place(R_OT, Vec3::Zero(), count);
    for (std::size_t k = 0; k < count; ++k) {
      contacts.r[begin + k] = {r.x[k], r.y[k], r.z[k]};
      contacts.N[begin + k] = {N.x[k], N.y[k], N.z[k]};
    }
    for (std::size_t k = 0; k < r.padded; ++k) r.x[k] += p_OT.x(), r.y[k] += p_OT.y(), r.z[k] += p_OT.z();
    field_.sample(r.points(), {value, gx, gy, gz, in_field});
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
