#include "contact/traversal/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tact::contact {
namespace {

/// Radii are rounded to single precision.
constexpr double kRadiusSlack = 1 + 2e-6;
/// What place_in_cells() displaces a point by, in parts of its coordinates, with room to spare.
constexpr double kPlacing = 1e-6;
/// A tool farther than this, in cells, touches nothing, and single precision could not tell how far it is.
constexpr double kFarOff = 1e8;

std::size_t whole_vectors(std::size_t count, std::size_t lanes) { return (count + lanes - 1) / lanes * lanes; }

}  // namespace

bool is_rigid(const Pose& X) noexcept { return X.finite() && std::fabs(X.q.norm() - 1) < 1e-3; }

Traversal::Traversal(DistanceField field, std::shared_ptr<const Pointshell> shell)
    : field_(std::move(field)),
      field_in_cells_(field_),
      shell_(std::move(shell)),
      level_(shell_->size()),
      next_level_(shell_->size()),
      candidates_(shell_->size()),
      deepest_(shell_->size() + 1) {
  std::uint32_t last_top = 0;  // first node of the last level that is taken at once with those above
  for (const std::uint32_t end : shell_->level_begin) {
    if (top_size_ > 0 && end > kChunk) break;
    last_top = top_size_;
    top_size_ = end;
  }
  std::uint32_t leaves = 0;  // nothing from here on has children
  for (std::uint32_t i = 0; i < shell_->size(); ++i) {
    const Eigen::Vector3f &p = shell_->position_T[i], &n = shell_->normal_T[i];
    all_.nodes.push_back({p.x(), p.y(), p.z(), shell_->radius_m[i]});
    normals_.push_back({n.x(), n.y(), n.z(), 0});
    farthest_m_ = std::max(farthest_m_, p.cast<double>().norm());
    if (i >= last_top && shell_->child_begin[i] < shell_->child_end[i]) leaves = i + 1;
  }
  all_.nodes.resize(shell_->size() + kBeyond);
  for (std::uint32_t i = 0; i < leaves; ++i) {
    const std::uint32_t begin = shell_->child_begin[i], end = shell_->child_end[i];
    all_.families.push_back({begin, i >= last_top && begin < end ? end - begin : 0});
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
      found.clearance_m = std::max(0.0, field_.voxel_m() * static_cast<double>(clearance - frame.to_cells.slack));
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
  frame.b = cells_per_m * (X_OT.p - field_.min_O());
  frame.to_cells.A = (cells_per_m * frame.R_OT).cast<float>();
  frame.to_cells.b = frame.b.cast<float>();
  frame.to_cells.factor = static_cast<float>(kRadiusSlack * cells_per_m);
  frame.to_cells.slack =
      kClearanceSlack + static_cast<float>(kPlacing * (cells_per_m * farthest_m_ + frame.b.cwiseAbs().maxCoeff()));
  return frame;
}

/// Fills candidates_. Returns the clearance in cells, 0 when not wanted.
float Traversal::search(const Frame& frame, bool want_clearance, Findings& found) noexcept {
  float clearance = want_clearance ? std::numeric_limits<float>::infinity() : 0;
  candidates_.size = 0;
  level_.size = 0;
  append({0, top_size_}, all_, level_);
  while (level_.size > 0) {
    next_level_.size = 0;
    found.nodes_visited += level_.size;
    for (std::size_t begin = 0; begin < level_.size; begin += kChunk) {
      visit(begin, std::min(kChunk, level_.size - begin), frame.to_cells, clearance);
    }
    std::swap(level_, next_level_);
  }
  return clearance;
}

void Traversal::visit(std::size_t begin, std::size_t count, const ToCells& to_cells, float& clearance) noexcept {
  static_assert(kPlacedAtOnce == kPlacesAtOnce && kBeyond >= kPlacesAtOnce);
  alignas(64) float x[kChunk], y[kChunk], z[kChunk], needed[kChunk], enough[kChunk], clear[kChunk];
  // While the clearance may still exceed half a voxel (below that nobody needs it), go a little deeper than contacts
  // demand: a skipped subtree then tells its clearance within a factor of two, a point within that of the field.
  const bool search_clearance = clearance > 0.5f;
  ToCells to = to_cells;
  if (search_clearance) to.factor *= 2;
  const std::size_t whole =
      whole_vectors(count, kPlacesAtOnce);  // behind the last one are nodes that were there before
  place_in_cells(to, level_.node.data() + begin, whole, {x, y, z, needed});
  if (search_clearance) {
    const float more = field_in_cells_.band;
    for (std::size_t i = 0; i < whole; ++i) enough[i] = needed[i] + more;
  }
  clearances(field_in_cells_, {x, y, z, whole}, search_clearance ? enough : needed, clear);

  const Cleared nodes{level_.id.data() + begin, clear, needed, count};
  const std::size_t known = candidates_.size;
  part(nodes, to.slack, candidates_);
  for (std::size_t k = known; k < candidates_.size; ++k) __builtin_prefetch(&normals_[candidates_.id[k]]);
  if (clearance > 0) {
    const float share = search_clearance ? 0.5f : 1.0f;
    for (std::size_t i = 0; i < count; ++i) {
      const float free = clear[i] > needed[i] ? clear[i] - needed[i] * share : clear[i];
      clearance = free < clearance ? free : clearance;
    }
  }
  if (nodes.id[0] < all_.families.size()) descend(nodes, all_, next_level_);
}

void Traversal::place_and_sample(const Frame& frame, std::size_t begin, std::size_t count,
                                 Sampled& out) const noexcept {
  alignas(64) Node point[kChunk], normal[kChunk];
  alignas(64) double p[3][kChunk];
  const std::size_t whole = whole_vectors(count, 8);
  for (std::size_t k = 0; k < whole; ++k) {
    const std::uint32_t id = candidates_.id[begin + std::min(k, count - 1)];
    out.id[k] = id;
    point[k] = all_.nodes[id];
    normal[k] = normals_[id];
  }
  const auto all = [](double(&v)[3][kChunk]) { return Placed{v[0], v[1], v[2]}; };
  place(frame.R_OT, frame.p_OT, point, whole, all(p));
  place(frame.R_OT, Vec3::Zero(), point, whole, all(out.r));
  place(frame.R_OT, Vec3::Zero(), normal, whole, all(out.N));
  field_.sample({p[0], p[1], p[2], whole}, {out.value, out.g[0], out.g[1], out.g[2], out.in_field});
}

/// Leaves the candidates in contact, and of these no more than the buffer holds.
void Traversal::keep_deepest(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept {
  std::size_t touching = 0;
  Sampled sampled;
  for (std::size_t begin = 0; begin < candidates_.size; begin += kChunk) {
    const std::size_t count = std::min(kChunk, candidates_.size - begin);
    place_and_sample(frame, begin, count, sampled);
    for (std::size_t k = 0; k < count; ++k) {
      deepest_[touching] = {-sampled.value[k], sampled.id[k]};
      touching += sampled.value[k] < 0 ? 1 : 0;
      found.max_depth_m = std::max(found.max_depth_m, -sampled.value[k]);
    }
  }
  const auto begin = deepest_.begin(), end = begin + static_cast<std::ptrdiff_t>(touching);
  auto kept = end;
  if (touching > contacts.capacity()) {
    contacts.dropped = touching - contacts.capacity();
    found.status |= bit(Status::overflow);
    kept = begin + static_cast<std::ptrdiff_t>(contacts.capacity());
    std::nth_element(begin, kept, end, [](const Deep& a, const Deep& b) {
      return a.depth_m != b.depth_m ? a.depth_m > b.depth_m : a.id < b.id;
    });
    std::sort(begin, kept, [](const Deep& a, const Deep& b) { return a.id < b.id; });
  }
  candidates_.size = 0;
  for (auto it = begin; it != kept; ++it) candidates_.id[candidates_.size++] = it->id;
}

void Traversal::fill(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept {
  if (candidates_.size > contacts.capacity()) keep_deepest(frame, contacts, found);
  contacts.size = 0;
  Sampled sampled;
  for (std::size_t begin = 0; begin < candidates_.size; begin += kChunk) {
    const std::size_t count = std::min(kChunk, candidates_.size - begin);
    place_and_sample(frame, begin, count, sampled);
    const Emitted emitted = emit(sampled, count, contacts);
    found.max_depth_m = std::max(found.max_depth_m, emitted.deepest_m);
    found.status |= emitted.flags;
  }
}

}  // namespace tact::contact
