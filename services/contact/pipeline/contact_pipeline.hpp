#pragma once
#include <cstdint>
#include <memory>

#include "contact/pipeline/handover.hpp"
#include "contact/pipeline/params.hpp"
#include "contact/pipeline/side_memory.hpp"
#include "contact/response/assemble.hpp"
#include "contact/stiffness/law.hpp"
#include "contact/traversal/traversal.hpp"

namespace tact::contact {

/// Where the tool is and how it moves: V of the origins To and Oo, in W.
struct ToolQuery {
  Pose X_WT;
  Twist V_WT;
  Pose X_WO;
  Twist V_WO;
};

/// The answer: the contact wrench on the tool about To and its derivatives, all in W.
struct ContactResult {
  Pose X_WT, X_WO;                ///< poses answered
  Response response_W;            ///< F, G, K, B, see assemble.hpp
  std::size_t contact_count = 0;  ///< contacts rendered
  std::size_t dropped = 0;        ///< contacts beyond capacity
  double max_depth_m = 0;         ///< deepest shell point; of held ones the depth that is held
  double clearance_m = 0;         ///< no shell point is nearer the surface; 0 in contact
  double stiffness_n_per_m = 0;   ///< k in force
  double x_max_m = 0;             ///< F_max = k x_max
  std::uint64_t params_version = 0;
  std::uint32_t status = 0;  ///< Status bits
};

/// From pose to wrench: traverse, weigh, assemble. With force_along = "held" the answer depends on the poses before.
/// One thread steps; any other one changes parameters.
class ContactPipeline {
 public:
  /// Allocates everything. `capacity`: most contacts rendered at once. Throws SetupError as make_law does.
  ContactPipeline(DistanceField field, std::shared_ptr<const Pointshell> shell, std::size_t capacity,
                  const PipelineParams& params);

  /// The contact wrench at a pose. Real-time: does not allocate, lock or throw. A pose or twist that is not finite, or
  /// not a rotation, is answered with no wrench and Status::pose_invalid. The result is valid until the next step.
  const ContactResult& step(const ToolQuery& query) noexcept;

  /// The contacts of the last step, in O, weighed: for whoever shows them.
  const ContactBuffer& contacts() const { return contacts_; }

  /// Builds the law here, in force from the next step on. Not for the stepping thread; one caller at a time.
  /// Throws SetupError as make_law does; the old parameters stay in force then.
  void set_params(const PipelineParams& params);

 private:
  struct Setup {
    PipelineParams params;
    std::unique_ptr<Law> law;
  };
  std::unique_ptr<Setup> make_setup(const PipelineParams& params) const;
  const ContactResult& refuse(const ToolQuery& query, const PipelineParams& params) noexcept;
  const ContactResult& report(const ToolQuery& query, const PipelineParams& params, const Findings& found,
                              const Response& response_W) noexcept;

  Traversal traversal_;
  ContactBuffer contacts_;
  SideMemory sides_;
  Handover<Setup> setup_;
  ContactResult result_;
};

}  // namespace tact::contact
