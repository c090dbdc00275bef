#include "contact/pipeline/contact_pipeline.hpp"

#include <algorithm>

namespace tact::contact {
namespace {

/// Twist of To relative to the field body, in O.
Twist relative_twist_O(const ToolQuery& q, const Quat& q_WO) noexcept {
  const Vec3 v_To = q.V_WO.linear + q.V_WO.angular.cross(q.X_WT.p - q.X_WO.p);  // of the field body's point at To
  const Quat q_OW = q_WO.conjugate();
  return {q_OW * (q.V_WT.linear - v_To), q_OW * (q.V_WT.angular - q.V_WO.angular)};
}

bool is_valid(const ToolQuery& q) noexcept {
  return is_rigid(q.X_WT) && is_rigid(q.X_WO) && q.V_WT.vector().allFinite() && q.V_WO.vector().allFinite();
}

}  // namespace

ContactPipeline::ContactPipeline(DistanceField field, std::shared_ptr<const Pointshell> shell, std::size_t capacity,
                                 const PipelineParams& params)
    : traversal_(std::move(field), std::move(shell)),
      contacts_(capacity),
      sides_(traversal_.shell().size()),
      setup_(make_setup(params)) {}

std::unique_ptr<ContactPipeline::Setup> ContactPipeline::make_setup(const PipelineParams& params) const {
  auto law = make_law(params.law, params.law_params, traversal_.shell(), contacts_.capacity());
  return std::make_unique<Setup>(Setup{params, std::move(law)});
}

void ContactPipeline::set_params(const PipelineParams& params) { setup_.submit(make_setup(params)); }

const ContactResult& ContactPipeline::step(const ToolQuery& query) noexcept {
  Setup& setup = setup_.current();
  if (!is_valid(query)) return refuse(query, setup.params);
  const Pose X_WO{query.X_WO.p, query.X_WO.q.normalized()};
  const Twist V_O = relative_twist_O(query, X_WO.q);
  if (!V_O.vector().allFinite()) return refuse(query, setup.params);  // numbers so large that their product is not one

  const Pose X_OT = X_WO.inverse() * query.X_WT;
  Findings found = traversal_.find(X_OT, contacts_);
  if (setup.params.hold_thin_parts) {
    found.max_depth_m = std::max(found.max_depth_m, sides_.hold(traversal_.field(), X_OT.p, contacts_));
  }
  contacts_.force_along = setup.params.force_along;
  setup.law->weigh(contacts_);
  const Response response_O =
      assemble(contacts_, *setup.law, setup.params.stiffness_n_per_m, setup.params.damping_n_s_per_m, V_O);
  return report(query, setup.params, found, rotated(response_O, X_WO.R()));
}

const ContactResult& ContactPipeline::refuse(const ToolQuery& query, const PipelineParams& params) noexcept {
  contacts_.size = contacts_.dropped = 0;
  Findings nothing;
  nothing.status = bit(Status::pose_invalid);
  return report(query, params, nothing, Response{});
}

const ContactResult& ContactPipeline::report(const ToolQuery& query, const PipelineParams& params,
                                             const Findings& found, const Response& response_W) noexcept {
  result_.X_WT = query.X_WT;
  result_.X_WO = query.X_WO;
  result_.response_W = response_W;
  result_.contact_count = contacts_.size;
  result_.dropped = contacts_.dropped;
  result_.max_depth_m = found.max_depth_m;
  result_.clearance_m = found.clearance_m;
  result_.stiffness_n_per_m = params.stiffness_n_per_m;
  result_.x_max_m = params.x_max_m;
  result_.params_version = params.version;
  result_.status = found.status | response_W.status;
  return result_;
}

}  // namespace tact::contact
