#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/stiffness/law.hpp"

namespace tact::contact {

/// Law "cluster", [P:18] as [P] fig. 12 compares with it: contacts nearer than radius_m to each other are one group,
/// also through others; a group becomes one contact; another law weighs those.
///   a_i = depth_i / sum_j depth_j;   depth, r, N, g of the group = sum_i a_i (depth_i, r_i, N_i, g_i)
/// N and g are means, shorter than their members where these differ: a group that faces all ways does not push. Flags
/// of members are united. point_id is the group's lowest, the coarsest in the hierarchy: its direction stands for the
/// group on the Gauss map. So the law that weighs reads constants of the shell, as ever, and weights do not jump while
/// the contact set stays.
///
/// Distances between points of a rigid shell do not change: who is near whom is listed once, when the law is made.
/// Cost: O(contacts + near pairs) and the law that weighs.
class Cluster final : public Law {
 public:
  /// Throws SetupError when more than 2^26 pairs of points are that near: `radius_m` is far above the shell's spacing.
  Cluster(const Pointshell& shell, double radius_m, std::size_t capacity, std::unique_ptr<Law> weigher);

  /// Replaces the contacts by one for each group, in ascending order of point_id, and weighs these.
  /// @pre contacts in ascending order of point_id, as the traversal finds them
  void weigh(ContactBuffer& contacts) noexcept override;
  /// What the law that weighs includes, and in `sh` how shares a_i follow the depths: exact while weights of groups do
  /// not (all laws but potential).
  void include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept override;

 private:
  struct Member {
    Vec3 r, N, g;
    double depth_m;
    std::uint32_t next;   // of the same group, ascending; kNone: the last
    std::uint32_t group;  // of the first in a group
  };
  struct Group {
    Vec3 r, N, g;
    double depth_m = 0, depth_sum_m = 0, weight = 0;
    std::uint32_t first = 0, last = 0;  // members
  };

  bool link(const ContactBuffer& contacts) noexcept;
  std::uint32_t find_root(std::uint32_t contact) noexcept;
  void merge(ContactBuffer& contacts) noexcept;

  std::unique_ptr<Law> weigher_;
  // near_[near_begin_[i], near_begin_[i + 1]): points of lower id within the radius of point i.
  std::vector<std::uint32_t> near_begin_, near_;
  std::vector<std::uint64_t> in_contact_;  // per point, a bit each; all 0 in between
  std::vector<std::uint32_t> place_;       // per point in contact: its contact
  std::vector<std::uint32_t> root_;        // per contact: one of lower or equal id in its group; its own: the first
  std::vector<Member> members_;            // per contact, when there are groups of several
  std::vector<Group> groups_;
  std::size_t group_count_ = 0;
  bool along_normal_ = false;
};

}  // namespace tact::contact
