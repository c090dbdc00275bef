#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/model/contact.hpp"
#include "contact/model/pointshell.hpp"
#include "contact/traversal/place.hpp"
#include "field/distance_field.hpp"

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
/// All scratch is allocated here (48 bytes a point); find() does not allocate, lock or throw. Cost: one block look-up
/// for each node visited, a few ns: nodes of a level are taken many at a time (README).
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
  struct Candidate {
    double depth_m;
    std::uint32_t id;
  };
  /// Where the tool is: exactly, and as cells of the field for culling.
  struct Frame {
    Mat3 R_OT;
    Vec3 p_OT;
    Mat3 A;       ///< R_OT / h
    Vec3 b;       ///< (p_OT - min_O) / h
    float slack;  ///< cells: of clearances, and of what rounding displaces
  };
  /// Children side by side. Nodes that are taken together with their children have none.
  struct Family {
    std::uint32_t begin, count;
  };
  /// Nodes of a level that are to be visited, ascending.
  struct Queue {
    std::size_t size = 0;
    std::vector<std::uint32_t> id;
  };

  Frame frame_of(const Pose& X_OT) const noexcept;
  float search(const Frame& frame, bool want_clearance, Findings& found) noexcept;
  void append(Family family, Queue& to) const noexcept;
  void visit(std::span<const std::uint32_t> ids, const Frame& frame, Queue& next, float& clearance) noexcept;
  void keep_deepest(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept;
  void fill(const Frame& frame, ContactBuffer& contacts, Findings& found) noexcept;

  DistanceField field_;
  std::shared_ptr<const Pointshell> shell_;
  std::vector<Node> nodes_;
  std::vector<Family> families_;  ///< of the nodes before the leaves
  Queue level_, next_level_;
  std::vector<Candidate> candidates_;  ///< points that may be in contact
  std::size_t candidate_count_ = 0;
  std::uint32_t top_size_ = 0;  ///< nodes of the top levels, taken at once whatever they promise
  double farthest_m_ = 0;       ///< a node from To
  bool touched_ = false;        ///< the last find() had contacts
};

}  // namespace tact::contact
