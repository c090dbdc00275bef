#include "contact/bake/worker/signs.hpp"

#include <array>
#include <atomic>
#include <cmath>

#include "contact/bake/worker/parallel.hpp"
#include "contact/bake/worker/union_find.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

constexpr std::uint8_t kAlone = 255;  ///< a corner in no region

/// Regions of one block: each corner's region, 0 .. count-1, or kAlone.
struct Labels {
  std::array<std::uint8_t, kBlockValues> of;
  std::uint32_t count = 0;
};

/// A block with a rim of one, so that no neighbour needs a check of bounds.
constexpr int kPadded = kBlockCorners + 2;
constexpr int padded_index(int x, int y, int z) { return ((z + 1) * kPadded + y + 1) * kPadded + x + 1; }

/// The 26 neighbours of a corner.
struct Step {
  int offset;
  double length;
};
const std::array<Step, 26> kSteps = [] {
  std::array<Step, 26> steps{};
  std::size_t n = 0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        if (x == 0 && y == 0 && z == 0) continue;
        steps[n++] = {padded_index(x, y, z) - padded_index(0, 0, 0),
                      std::sqrt(static_cast<double>(x * x + y * y + z * z))};
      }
    }
  }
  return steps;
}();

Labels label_block(const FieldBlock& block, double cell_steps) {
  std::array<int, 26> limits{};
  for (std::size_t s = 0; s < kSteps.size(); ++s) {
    limits[s] = static_cast<int>(std::ceil(kSteps[s].length * cell_steps)) + 2;  // two roundings
  }
  constexpr int kSeen = -1000000;  // and the rim: no sum with it exceeds a limit
  std::array<int, kPadded * kPadded * kPadded> q;
  q.fill(kSeen);
  std::array<std::uint16_t, kBlockValues> place;  // in the padded block
  std::array<std::uint16_t, kPadded * kPadded * kPadded> index;
  std::size_t n = 0;
  for (int z = 0; z < kBlockCorners; ++z) {
    for (int y = 0; y < kBlockCorners; ++y) {
      for (int x = 0; x < kBlockCorners; ++x, ++n) {
        place[n] = static_cast<std::uint16_t>(padded_index(x, y, z));
        index[place[n]] = static_cast<std::uint16_t>(n);
        q[place[n]] = block.q[n];
      }
    }
  }
  Labels labels;
  labels.of.fill(kAlone);
  std::array<std::pair<std::uint16_t, int>, kBlockValues> region;  // places and their values
  for (const std::uint16_t start : place) {
    if (q[start] == kSeen) continue;
    std::size_t size = 0;
    const auto add = [&](std::size_t at) {
      region[size++] = {static_cast<std::uint16_t>(at), q[at]};
      q[at] = kSeen;
    };
    add(start);
    for (std::size_t i = 0; i < size; ++i) {
      const auto [at, value] = region[i];
      for (std::size_t s = 0; s < kSteps.size(); ++s) {
        const auto next = static_cast<std::size_t>(at + kSteps[s].offset);
        if (value + q[next] > limits[s]) add(next);
      }
    }
    if (size < 2 || labels.count == kAlone) continue;
    for (std::size_t i = 0; i < size; ++i) labels.of[index[region[i].first]] = static_cast<std::uint8_t>(labels.count);
    ++labels.count;
  }
  return labels;
}

class Solver {
 public:
  Solver(FieldParts& parts, const Inside& side, const std::vector<std::uint8_t>& rim, const StageProgress& progress)
      : parts_(parts),
        inside_(side),
        progress_(progress),
        block_at_(parts.blocks.size()),
        on_rim_(parts.blocks.size(), 0) {
    const FieldGrid& grid = parts.grid;
    for (int z = 0; z < grid.blocks[2]; ++z) {
      for (int y = 0; y < grid.blocks[1]; ++y) {
        for (int x = 0; x < grid.blocks[0]; ++x) {
          const std::size_t index = grid.block_index(x, y, z);
          const CoarseEntry& entry = parts.coarse[index];
          if (!entry.stored()) continue;
          block_at_[entry.slot()] = {x, y, z};
          on_rim_[entry.slot()] = rim[index];
        }
      }
    }
  }

  SignReport run() {
    label();
    const auto nodes = static_cast<std::size_t>(first_far_) + parts_.coarse.size();
    UnionFind regions(nodes);
    join(regions);
    vote_parts();
    decide(regions);
    apply(regions);
    report_.voted_corners = alone_;
    report_.close_votes = close_;
    for (const CoarseEntry& entry : parts_.coarse) report_.doubtful_blocks += entry.doubtful() ? 1 : 0;
    return report_;
  }

 private:
  enum Sign : std::uint8_t { outside, inside, leaking, unknown };

  std::uint32_t part(std::uint32_t slot, std::uint8_t label) const { return first_part_[slot] + label; }
  std::uint32_t far(std::size_t index) const { return first_far_ + static_cast<std::uint32_t>(index); }
  Vec3 corner(std::uint32_t slot, int i) const {
    const auto& b = block_at_[slot];
    return parts_.grid.corner_O(kBlockCells * b[0] + i % kBlockCorners,
                                kBlockCells * b[1] + i / kBlockCorners % kBlockCorners,
                                kBlockCells * b[2] + i / (kBlockCorners * kBlockCorners));
  }
  bool vote(const Vec3& p, bool& close) { return vote(p, close, close); }
  bool vote(const Vec3& p, bool& close, bool& disputed) {
    const Vote v = inside_.vote(p);
    disputed = disputed || v.disputed;
    if (v.close) {
      close = true;
      ++close_;
    }
    return v.inside;
  }
  void doubt(std::uint32_t slot) {
    const auto& b = block_at_[slot];
    parts_.coarse[parts_.grid.block_index(b[0], b[1], b[2])].slot_and_flags |= CoarseEntry::kDoubtful;
  }

  void label() {
    const std::size_t n = parts_.blocks.size();
    labels_.resize(n);
    const double cell_steps = 32767 * parts_.grid.voxel_m / parts_.grid.range_m();
    parallel_stage("regions", n, progress_,
                   [&](std::size_t i) { labels_[i] = label_block(parts_.blocks[i], cell_steps); });
    first_part_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      first_part_[i] = first_far_;
      first_far_ += labels_[i].count;
    }
  }

  /// Neighbouring blocks share the corners of a face, and a block far from the surface is all one sign.
  void join(UnionFind& regions) {
    const FieldGrid& grid = parts_.grid;
    for (int z = 0; z < grid.blocks[2]; ++z) {
      for (int y = 0; y < grid.blocks[1]; ++y) {
        for (int x = 0; x < grid.blocks[0]; ++x) {
          for (int axis = 0; axis < 3; ++axis) {
            int n[3] = {x, y, z};
            if (++n[axis] >= grid.blocks[static_cast<std::size_t>(axis)]) continue;
            join_face(regions, grid.block_index(x, y, z), grid.block_index(n[0], n[1], n[2]), axis);
          }
        }
      }
    }
  }

  void join_face(UnionFind& regions, std::size_t low, std::size_t high, int axis) {
    const CoarseEntry &a = parts_.coarse[low], &b = parts_.coarse[high];
    if (!a.stored() && !b.stored()) {
      regions.join(far(low), far(high));
      return;
    }
    for (int u = 0; u < kBlockCorners; ++u) {
      for (int v = 0; v < kBlockCorners; ++v) {
        int c[3];
        c[(axis + 1) % 3] = u;
        c[(axis + 2) % 3] = v;
        const auto node = [&](const CoarseEntry& entry, std::size_t index, int at) -> std::uint32_t {
          if (!entry.stored()) return far(index);
          c[axis] = at;
          const std::uint8_t l =
              labels_[entry.slot()].of[static_cast<std::size_t>(FieldBlock::index(c[0], c[1], c[2]))];
          return l == kAlone ? ~0u : part(entry.slot(), l);
        };
        const std::uint32_t p = node(a, low, kBlockCells), q = node(b, high, 0);
        if (p != ~0u && q != ~0u) regions.join(p, q);
      }
    }
  }

  void vote_parts() {
    part_inside_.assign(first_far_, 0);
    part_close_.assign(first_far_, 0);
    part_disputed_.assign(first_far_, 0);
    parallel_stage("inside or outside", parts_.blocks.size(), progress_, [&](std::size_t i) {
      const auto slot = static_cast<std::uint32_t>(i);
      std::array<int, kAlone> best;
      best.fill(-1);
      for (int c = 0; c < kBlockValues; ++c) {
        const std::uint8_t l = labels_[i].of[static_cast<std::size_t>(c)];
        if (l == kAlone) continue;
        const auto& q = parts_.blocks[i].q;
        if (best[l] < 0 || q[static_cast<std::size_t>(c)] > q[static_cast<std::size_t>(best[l])]) best[l] = c;
      }
      for (std::uint32_t l = 0; l < labels_[i].count; ++l) {
        bool close = false, disputed = false;
        part_inside_[first_part_[i] + l] = vote(corner(slot, best[l]), close, disputed);
        part_close_[first_part_[i] + l] = close;
        part_disputed_[first_part_[i] + l] = disputed;
      }
    });
  }

  void decide(UnionFind& regions) {
    struct Tally {
      std::uint32_t in = 0, out = 0, disputed = 0;
    };
    const std::size_t nodes = first_far_ + parts_.coarse.size();
    std::vector<Tally> tally(nodes);
    for (std::uint32_t p = 0; p < first_far_; ++p) {
      Tally& t = tally[regions.find(p)];
      ++(part_inside_[p] ? t.in : t.out);
      t.disputed += part_disputed_[p];
    }
    sign_.assign(nodes, unknown);
    disputed_.assign(nodes, 0);
    for (std::uint32_t i = 0; i < nodes; ++i) {
      const bool used = i < first_far_ || !parts_.coarse[i - first_far_].stored();
      if (!used || regions.find(i) != i) continue;
      ++report_.components;
      const Tally& t = tally[i];
      const std::uint32_t all = t.in + t.out, few = std::min(t.in, t.out);
      disputed_[i] = 2 * t.disputed > all;
      if (all == 0) {
        sign_[i] = leaking;  // no block beside it: each far block for itself
      } else if (static_cast<double>(few) <= 0.01 * all) {
        sign_[i] = t.in > t.out ? inside : outside;
      } else {
        sign_[i] = leaking;
        ++report_.leaking;
      }
    }
  }

  void apply(UnionFind& regions) {
    std::vector<std::uint32_t> root(first_far_);
    for (std::uint32_t p = 0; p < first_far_; ++p) root[p] = regions.find(p);
    parallel_stage("near the surface", parts_.blocks.size(), progress_, [&](std::size_t i) { sign_block(i, root); });
    for (std::size_t i = 0; i < parts_.coarse.size(); ++i) {
      CoarseEntry& entry = parts_.coarse[i];
      if (entry.stored()) continue;
      const std::uint32_t region = regions.find(far(i));
      Sign s = sign_[region];
      if (disputed_[region]) entry.slot_and_flags |= CoarseEntry::kDoubtful;
      if (s == leaking) {
        bool close = false;
        const auto n = static_cast<std::size_t>(parts_.grid.blocks[0]),
                   m = static_cast<std::size_t>(parts_.grid.blocks[1]);
        const auto x = static_cast<int>(i % n), y = static_cast<int>(i / n % m), z = static_cast<int>(i / n / m);
        s = vote(parts_.grid.block_centre_O(x, y, z), close) ? inside : outside;
        if (close) entry.slot_and_flags |= CoarseEntry::kDoubtful;
      }
      if (s == inside) entry.slot_and_flags |= CoarseEntry::kInside;
    }
  }

  void sign_block(std::size_t i, const std::vector<std::uint32_t>& root) {
    const auto slot = static_cast<std::uint32_t>(i);
    const Labels& labels = labels_[i];
    bool doubtful = false;
    std::array<Sign, kAlone + 1> sign;
    sign.fill(leaking);  // of kAlone and of mixed parts: each corner for itself
    for (std::uint32_t l = 0; l < labels.count; ++l) {
      const std::uint32_t p = first_part_[i] + l;
      const Sign s = sign_[root[p]];
      sign[l] = s;
      doubtful = doubtful || part_disputed_[p];
      if (s == leaking) {
        sign[l] = spread_vote(slot, static_cast<std::uint8_t>(l), part_inside_[p] != 0);
        doubtful = doubtful || sign[l] == leaking || part_close_[p];
        if (on_rim_[i] != 0) sign[l] = leaking;
      } else {
        doubtful = doubtful || (s == inside) != (part_inside_[p] != 0);  // outvoted
      }
    }
    FieldBlock& block = parts_.blocks[i];
    for (int c = 0; c < kBlockValues; ++c) {
      const auto at = static_cast<std::size_t>(c);
      const Sign s = sign[labels.of[at]];
      bool in = s == inside;
      if (s == leaking && block.q[at] != 0) {
        if (labels.of[at] == kAlone) ++alone_;
        in = vote(corner(slot, c), doubtful);
      }
      if (in) block.q[at] = static_cast<std::int16_t>(-block.q[at]);
    }
    if (doubtful) doubt(slot);
  }

  /// The sign of one part of a leaking region when its extreme corners agree, else `leaking`.
  Sign spread_vote(std::uint32_t slot, std::uint8_t label, bool first) {
    std::array<int, 8> best;
    best.fill(-1);
    const auto& q = parts_.blocks[slot].q;
    const auto& of = labels_[slot].of;
    for (int c = 0; c < kBlockValues; ++c) {
      if (of[static_cast<std::size_t>(c)] != label) continue;
      const int x = c % kBlockCorners, y = c / kBlockCorners % kBlockCorners, z = c / (kBlockCorners * kBlockCorners);
      const auto octant = static_cast<std::size_t>((x > 4 ? 1 : 0) + (y > 4 ? 2 : 0) + (z > 4 ? 4 : 0));
      if (best[octant] < 0 || q[static_cast<std::size_t>(c)] > q[static_cast<std::size_t>(best[octant])])
        best[octant] = c;
    }
    for (const int c : best) {
      if (c < 0) continue;
      Vote v = inside_.vote(corner(slot, c));
      if (!v.sure) v = inside_.careful_vote(corner(slot, c));
      close_ += v.close ? 1 : 0;
      if (v.inside != first || v.close) return leaking;
    }
    return first ? inside : outside;
  }

  FieldParts& parts_;
  const Inside& inside_;
  const StageProgress& progress_;
  SignReport report_;
  std::vector<std::array<int, 3>> block_at_;  ///< by slot
  std::vector<std::uint8_t> on_rim_;          ///< by slot
  std::vector<Labels> labels_;                ///< by slot
  std::vector<std::uint32_t> first_part_;     ///< by slot: node of its region 0
  std::uint32_t first_far_ = 0;               ///< nodes from here on are unstored blocks, by block index
  std::vector<std::uint8_t> part_inside_, part_close_, part_disputed_;
  std::vector<Sign> sign_;              ///< by node, at roots
  std::vector<std::uint8_t> disputed_;  ///< the same: most parts of the region are
  std::atomic<std::size_t> alone_ = 0, close_ = 0;
};

}  // namespace

SignReport settle_signs(FieldParts& parts, const Inside& inside, const std::vector<std::uint8_t>& rim,
                        const StageProgress& progress) {
  return Solver(parts, inside, rim, progress).run();
}

}  // namespace tact::contact
