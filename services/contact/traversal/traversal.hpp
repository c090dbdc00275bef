#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/model/contact.hpp"
#include "contact/model/pointshell.hpp"
#include "contact/traversal/frontier.hpp"
#include "contact/traversal/place.hpp"
#include "field/distance_field.hpp"
#include "field/field_clearance.hpp"

namespace tact::contact {

/// What one traversal found besides the contacts.
struct Findings {
  double max_depth_m = 0;  ///< deepest shell point; also of dropped ones
  /// No shell point is nearer the zero of the field than this, so no smaller motion touches; 0 in contact. Within a
  /// small factor of the true distance, but not accurate below half a voxel.
  double clearance_m = 0;
  std::uint32_t status = 0;  ///< Status bits
  std::size_t nodes_visited = 0;
};

/// True when all numbers are finite and the quaternion is a rotation (norm 1 within 1e-3).
bool is_rigid(const Pose& X) noexcept;

/// Finds the shell points inside the field: breadth-first over all levels, always completed. A subtree is skipped only
/// when the field promises that no sample in its sphere is negative (clearances(), in single precision, its rounding
/// allowed for); what is left is sampled in double. So the contacts are exactly those of brute force over all points: {
/// i : sample(X_OT p_i).value_m < 0 }, points placed by place(), in ascending order of id.
///
/// All scratch is allocated here (some 100 bytes a point); find() does not allocate, lock or throw. Cost: one block
/// look-up for each node visited, a few ns: nodes of a level are taken many at a time (README).
class Traversal {
 public:
  /// @pre field not empty
  Traversal(DistanceField field, std::shared_ptr<const Pointshell> shell);

  /// Fills `contacts` (O: the field's frame) except the weights. Beyond its capacity the deepest are kept, equal depths
  /// by lower id; `dropped` counts the others, Status::overflow is set. A contact deeper than the stored band has
  /// depth = band, g = 0 and Status::beyond_band. Status::past_mid_surface marks g.N < -|g|/2: the field pushes this
  /// point out against its own normal, so the force along N pulls it in deeper. A pose that is not rigid yields no
  /// contacts, clearance 0 and Status::pose_invalid. @pre the same shell as ever
  Findings find(const Pose& X_OT, ContactBuffer& contacts) noexcept;

  const DistanceField& field() const { return field_; }
  const Pointshell& shell() const { return *shell_; }

 private:
  struct Deep {
    double depth_m;
    std::uint32_t id;
  };
  /// Where the tool is: exactly, and as cells of the field for culling.
  struct Frame {
    Mat3 R_OT;
    Vec3 p_OT;
    Vec3 b;            ///< (p_OT - min_O) / h
    ToCells to_cells;  ///< its slack: of clearances, and of what rounding displaces
  };

  Frame frame_of(const Pose& X_OT) const noexcept;
  float search(const Frame& frame, bool want_clearance, Findings& found) noexcept;
  void visit(std::size_t begin, std::size_t count, const ToCells& to_cells, float& clearance) noexcept;
  void place_and_sample(const Frame& frame, std::size_t begin, std::size_t count, Sampled& out) const noexcept;
  void keep_deepest(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept;
  void fill(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept;

  DistanceField field_;
  ClearanceView field_in_cells_;
  std::shared_ptr<const Pointshell> shell_;
  Hierarchy all_;
  std::vector<Node> normals_;
  Frontier level_, next_level_;
  Candidates candidates_;
  std::vector<Deep> deepest_;   ///< scratch of keep_deepest
  std::uint32_t top_size_ = 0;  ///< nodes of the top levels, taken at once whatever they promise
  double farthest_m_ = 0;       ///< a node from To
  bool touched_ = false;        ///< the last find() had contacts
};

}  // namespace tact::contact
