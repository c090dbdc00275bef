#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "contact/pipeline/contact_pipeline.hpp"

namespace tact::contact {

/// The contacts of one step for whoever shows them: all, or the ones with the largest force when there are more. In O.
struct ContactSnapshot {
  static constexpr std::size_t kMax = 512;  // the wire's bound

  struct Item {
    std::uint32_t point_id = 0, flags = 0;
    Vec3 r = Vec3::Zero(), N = Vec3::Zero(), g = Vec3::Zero();
    Vec3 e = Vec3::Zero();  ///< direction of the force
    double depth_m = 0, weight = 0;
  };

  std::uint64_t pose_epoch = 0, pose_seq = 0;
  std::int64_t pose_t_mono_ns = 0, compute_ns = 0;
  Pose X_WT, X_WO;
  Wrench F_W;
  double stiffness_n_per_m = 0;
  std::uint64_t params_version = 0;
  std::uint32_t total = 0;  ///< before truncation
  std::uint32_t size = 0;
  std::array<Item, kMax> items;  ///< sorted by force, largest first, when truncated
};

/// Fills snapshots. Owns the scratch memory: a copy of nothing is kept.
class SnapshotTaker {
 public:
  explicit SnapshotTaker(std::size_t capacity) : order_(capacity) {}

  /// O(contacts). Real-time: does not allocate, lock or throw.
  /// @pre contacts.size <= capacity
  void take(const ContactBuffer& contacts, const ContactResult& result, ContactSnapshot& out) noexcept;

 private:
  std::vector<std::uint32_t> order_;
};

}  // namespace tact::contact
