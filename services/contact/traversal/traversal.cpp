#include "contact/traversal/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "field/field_clearance.hpp"

namespace tact::contact {
namespace {

/// Radii are rounded to single precision.
constexpr double kRadiusSlack = 1 + 2e-6;
/// What place_in_cells() displaces a point by, in parts of its coordinates, with room to spare.
constexpr double kPlacing = 1e-6;
/// A tool farther than this, in cells, touches nothing, and single precision could not tell how far it is.
constexpr double kFarOff = 1e8;
/// Nodes probed at once: enough to hide the latency of memory.
constexpr std::size_t kChunk = 64;
/// Children queued at once; what is written too much is overwritten by the next.
constexpr std::uint32_t kAppend = 8;

/// A chunk of nodes, made whole vectors: behind the last one itself again.
struct Chunk {
  alignas(64) Node node[kChunk];
  std::size_t padded = 0;

  void pad(std::size_t count) noexcept {
    for (padded = count; padded % 8 != 0; ++padded) node[padded] = node[padded - 1];
  }
};

/// A chunk of points, placed.
struct Points {
  double x[kChunk], y[kChunk], z[kChunk];

  void place(const Mat3& R, const Chunk& chunk) noexcept {
    tact::contact::place(R, Vec3::Zero(), chunk.node, chunk.padded, {x, y, z});
  }
  void move(const Vec3& by, std::size_t count) noexcept {
    for (std::size_t k = 0; k < count; ++k) x[k] += by.x(), y[k] += by.y(), z[k] += by.z();
  }
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
    farthest_m_ = std::max(farthest_m_, p.cast<double>().norm());
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
  const Frame frame = frame_of(X_OT);
  const double away = frame.b.cwiseAbs().maxCoeff();
  if (!(away < kFarOff)) {
    const double size = (field_.max_O() - field_.min_O()).norm() + farthest_m_;
    found.clearance_m = std::max(0.0, (1 - kPlacing) * (field_.voxel_m() * away - size));
    return found;
  }

  // In contact the clearance is 0 and needs no search. Contact mostly goes on: if it ended, search again.
  if (touched_) {
    search(frame, false, found);
    fill(frame, contacts, found);
  }
  if (contacts.size == 0) {
    const float clearance = search(frame, true, found);
    fill(frame, contacts, found);
    if (contacts.size == 0) {
      found.clearance_m = std::max(0.0, field_.voxel_m() * static_cast<double>(clearance - frame.slack));
    }
  }
  touched_ = contacts.size > 0;
  return found;
}

Traversal::Frame Traversal::frame_of(const Pose& X_OT) const noexcept {
  Frame frame;
  const double cells_per_m = 1 / field_.voxel_m();
  frame.R_OT = X_OT.q.normalized().toRotationMatrix();
  frame.p_OT = X_OT.p;
  frame.A = cells_per_m * frame.R_OT;
  frame.b = cells_per_m * (X_OT.p - field_.min_O());
  frame.slack =
      kClearanceSlack + static_cast<float>(kPlacing * (cells_per_m * farthest_m_ + frame.b.cwiseAbs().maxCoeff()));
  return frame;
}

/// Fills candidates_. Returns the clearance in cells, 0 when not wanted.
float Traversal::search(const Frame& frame, bool want_clearance, Findings& found) noexcept {
  float clearance = want_clearance ? std::numeric_limits<float>::infinity() : 0;
  candidate_count_ = 0;
  level_.size = 0;
  append({0, top_size_}, level_);
  while (level_.size > 0) {
    next_level_.size = 0;
    found.nodes_visited += level_.size;
    for (std::size_t begin = 0; begin < level_.size; begin += kChunk) {
      const std::size_t count = std::min(kChunk, level_.size - begin);
      visit({level_.id.data() + begin, count}, frame, next_level_, clearance);
    }
    std::swap(level_, next_level_);
  }
  return clearance;
}

void Traversal::visit(std::span<const std::uint32_t> ids, const Frame& frame, Queue& next, float& clearance) noexcept {
  Chunk chunk;
  alignas(64) float x[kChunk], y[kChunk], z[kChunk], radius[kChunk], enough[kChunk], clear[kChunk];
  const std::size_t count = ids.size();
  const Node* nodes = nodes_.data();
  for (std::size_t i = 0; i < count; ++i) chunk.node[i] = nodes[ids[i]];
  chunk.pad(count);
  place_in_cells(frame.A, frame.b, kRadiusSlack / field_.voxel_m(), chunk.node, chunk.padded, {x, y, z, radius});

  // While the clearance may still exceed half a voxel (below that nobody needs it), go a little deeper than contacts
  // demand: a skipped subtree then tells its clearance within a factor of two, a point within that of the field.
  const bool search_clearance = clearance > 0.5f;
  const float factor = search_clearance ? 2 : 1;
  const float more = search_clearance ? static_cast<float>(field_.band_m() / field_.voxel_m()) : 0;
  for (std::size_t i = 0; i < chunk.padded; ++i) {
    radius[i] = factor * radius[i] + frame.slack;  // what it takes to skip
    enough[i] = radius[i] + more;
  }
  clearances(field_, {x, y, z, chunk.padded}, enough, clear);

  // Without branches that depend on where nodes lie.
  Candidate* last = candidates_.data() + candidate_count_;
  for (std::size_t i = 0; i < count; ++i) {
    last->id = ids[i];
    last += clear[i] > frame.slack ? 0 : 1;
  }
  for (const Candidate* c = candidates_.data() + candidate_count_; c < last; ++c) {
    __builtin_prefetch(&shell_->normal_T[c->id]);
  }
  candidate_count_ = static_cast<std::size_t>(last - candidates_.data());
  if (clearance > 0) {
    for (std::size_t i = 0; i < count; ++i) {
      const float free = clear[i] > radius[i] ? clear[i] - radius[i] / factor : clear[i];
      clearance = free < clearance ? free : clearance;
    }
  }
  if (ids.front() >= families_.size()) return;  // leaves
  std::uint32_t open[kChunk];                   // nodes to go deeper at
  std::size_t open_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    open[open_count] = ids[i];
    open_count += clear[i] > radius[i] ? 0 : 1;
  }
  for (std::size_t k = 0; k < open_count; ++k) {
    if (open[k] < families_.size()) append(families_[open[k]], next);
  }
}

/// Leaves the candidates in contact, and of these no more than the buffer holds.
void Traversal::keep_deepest(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept {
  std::size_t touching = 0;
  for (std::size_t begin = 0; begin < candidate_count_; begin += kChunk) {
    const std::size_t count = std::min(kChunk, candidate_count_ - begin);
    Chunk chunk;
    Points p;
    double value[kChunk], gx[kChunk], gy[kChunk], gz[kChunk];
    std::uint8_t in_field[kChunk];
    for (std::size_t k = 0; k < count; ++k) chunk.node[k] = nodes_[candidates_[begin + k].id];
    chunk.pad(count);
    p.place(frame.R_OT, chunk);
    p.move(frame.p_OT, chunk.padded);
    field_.sample({p.x, p.y, p.z, chunk.padded}, {value, gx, gy, gz, in_field});
    for (std::size_t k = 0; k < count; ++k) {
      const Candidate candidate{-value[k], candidates_[begin + k].id};
      candidates_[touching] = candidate;
      touching += value[k] < 0 ? 1 : 0;
      found.max_depth_m = std::max(found.max_depth_m, candidate.depth_m);
    }
  }
  candidate_count_ = std::min(touching, contacts.capacity());
  if (touching <= contacts.capacity()) return;
  contacts.dropped = touching - contacts.capacity();
  found.status |= bit(Status::overflow);
  const auto begin = candidates_.begin();
  const auto kept = begin + static_cast<std::ptrdiff_t>(contacts.capacity());
  std::nth_element(begin, kept, begin + static_cast<std::ptrdiff_t>(touching),
                   [](const Candidate& a, const Candidate& b) {
                     return a.depth_m != b.depth_m ? a.depth_m > b.depth_m : a.id < b.id;
                   });
  std::sort(begin, kept, [](const Candidate& a, const Candidate& b) { return a.id < b.id; });
}

void Traversal::fill(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept {
  if (candidate_count_ > contacts.capacity()) keep_deepest(frame, contacts, found);
  std::size_t n = 0;
  for (std::size_t begin = 0; begin < candidate_count_; begin += kChunk) {
    const std::size_t count = std::min(kChunk, candidate_count_ - begin);
    Chunk chunk, normal;
    Points r, N, p;
    double value[kChunk], gx[kChunk], gy[kChunk], gz[kChunk];
    std::uint8_t in_field[kChunk];
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = candidates_[begin + k].id;
      const Eigen::Vector3f& n_T = shell_->normal_T[i];
      chunk.node[k] = nodes_[i];
      normal.node[k] = {n_T.x(), n_T.y(), n_T.z(), 0};
    }
    chunk.pad(count);
    normal.pad(count);
    r.place(frame.R_OT, chunk);
    N.place(frame.R_OT, normal);
    p = r;
    p.move(frame.p_OT, chunk.padded);
    field_.sample({p.x, p.y, p.z, chunk.padded}, {value, gx, gy, gz, in_field});
    for (std::size_t k = 0; k < count; ++k) {
      if (!(value[k] < 0)) continue;
      const Vec3 g(gx[k], gy[k], gz[k]), N_k(N.x[k], N.y[k], N.z[k]);
      std::uint32_t flags = 0;
      if ((in_field[k] & DistanceField::kInBand) == 0) flags |= bit(Status::beyond_band);
      if ((in_field[k] & DistanceField::kDoubtful) != 0) flags |= bit(Status::sign_doubtful);
      if (g.dot(N_k) < -0.5 * g.norm()) flags |= bit(Status::past_mid_surface);
      contacts.point_id[n] = candidates_[begin + k].id;
      contacts.r[n] = {r.x[k], r.y[k], r.z[k]};
      contacts.N[n] = N_k;
      contacts.g[n] = g;
      contacts.depth_m[n] = -value[k];
      contacts.flags[n] = flags;
      found.max_depth_m = std::max(found.max_depth_m, -value[k]);
      found.status |= flags;
      ++n;
    }
  }
  contacts.size = n;
}

}  // namespace tact::contact
