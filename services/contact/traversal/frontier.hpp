#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "contact/model/contact.hpp"
#include "contact/traversal/place.hpp"

namespace tact::contact {

/// Nodes are taken in chunks: enough to hide the latency of memory, few enough to stay in the first-level cache.
inline constexpr std::size_t kChunk = 64;
/// Whole vectors are read and written: arrays reach this far beyond what is in use.
inline constexpr std::size_t kBeyond = 16;

/// Children side by side. Nodes that are taken together with their children have none.
struct Family {
  std::uint32_t begin, count;
};

/// All nodes of a shell, and kBeyond more.
struct Hierarchy {
  std::vector<Node> nodes;
  std::vector<Family> families;  ///< of the nodes before the leaves
};

/// Nodes of a level that are to be visited, ascending, copied side by side.
struct Frontier {
  explicit Frontier(std::size_t most) : id(most + kBeyond), node(most + kBeyond) {}
  std::size_t size = 0;
  std::vector<std::uint32_t> id;
  std::vector<Node> node;
};

/// Adds a family. Real-time. @pre `to` has room
void append(Family family, const Hierarchy& all, Frontier& to) noexcept;

/// Nodes of a chunk, the clearance of each, and what its sphere needs to be skipped.
struct Cleared {
  const std::uint32_t* id;
  const float *clear, *needed;
  std::size_t count;
};

/// Points that may be in contact.
struct Candidates {
  explicit Candidates(std::size_t most) : id(most + kBeyond) {}
  std::size_t size = 0;
  std::vector<std::uint32_t> id;
};

/// Adds nodes not clear of contact by more than `slack` to `candidates`, and the children of nodes not clear as needed
/// to `next`. Without branches that depend on where nodes lie. The widest SIMD the processor has is chosen at run time.
/// Real-time: does not allocate, lock or throw.
void part(const Cleared& nodes, float slack, Candidates& candidates) noexcept;
void descend(const Cleared& nodes, const Hierarchy& all, Frontier& next) noexcept;

/// Candidates of a chunk, placed and sampled.
struct Sampled {
  alignas(64) double r[3][kChunk], N[3][kChunk], g[3][kChunk], value[kChunk];
  alignas(64) std::uint32_t id[kChunk];
  std::uint8_t in_field[kChunk];
};

/// Appends the candidates inside the body to the contacts, except their weights. Returns the deepest, and all their
/// flags. Real-time.
struct Emitted {
  double deepest_m;
  std::uint32_t flags;
};
Emitted emit(const Sampled& candidates, std::size_t count, ContactBuffer& contacts) noexcept;

}  // namespace tact::contact
