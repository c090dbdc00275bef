#include "coupling/link/scene_model.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

#include "fault/fault.hpp"
#include "link/convert.hpp"

namespace tact::coupling {
namespace {

constexpr double kReach_m = 1000, kSmallest_m = 1e-9;
constexpr double kStiffest_n_per_m = 1e9;

constexpr const char* kBakeAnew =
    "remove the cached files of this scene, so that it is baked anew, and start tact-contact and tact-coupling "
    "from one installation";
constexpr const char* kUnit = "is the unit of the mesh right (--unit)?";

template <class Found>
[[noreturn]] void refuse(const char* field, const Found& found, const char* expected, const char* what_to_do) {
  std::ostringstream text;
  text << "contact server: SceneInfo." << field << ": found " << found << ", expected " << expected << "; "
       << what_to_do;
  throw SetupError(text.str());
}

/// Also what is not a number is outside.
double within(const char* field, double value, double least, double most, const char* expected,
              const char* what_to_do) {
  if (!(value >= least && value <= most)) refuse(field, value, expected, what_to_do);
  return value;
}

/// A number that is sound but for its size is most likely one in another unit.
double length(const char* field, double value) {
  return within(field, value, kSmallest_m, kReach_m, "a length from 1e-9 to 1000 m",
                std::isfinite(value) && value > 0 ? kUnit : kBakeAnew);
}

Pose pose(const char* field, const geometry_msgs_msg_dds__Pose_& in) {
  const Pose X = tact::from_wire(in);
  const bool sane = X.finite() && X.p.cwiseAbs().maxCoeff() <= kReach_m && std::abs(X.q.squaredNorm() - 1) < 1e-3;
  if (!sane) {
    std::ostringstream found;
    found << "position (" << X.p.transpose() << "), quaternion xyzw (" << X.q.coeffs().transpose() << ")";
    refuse(field, found.str(), "a position within 1000 m and a unit quaternion",
           X.finite() && X.p.cwiseAbs().maxCoeff() > kReach_m ? kUnit : kBakeAnew);
  }
  return {X.p, X.q.normalized()};
}

/// Of unit mass: symmetric, principal moments not negative and none above the sum of the others.
Mat3 inertia_shape(const char* field, const double (&in)[9]) {
  const Mat3 I = tact::from_wire(in);
  const char* const expected = "the inertia of a body of unit mass, in m^2";
  const double scale = I.cwiseAbs().maxCoeff();
  if (I.allFinite() && scale > kReach_m * kReach_m) refuse(field, I.reshaped().transpose(), expected, kUnit);
  if (!I.allFinite() || (I - I.transpose()).cwiseAbs().maxCoeff() > 1e-6 * scale)
    refuse(field, I.reshaped().transpose(), expected, kBakeAnew);
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(I, Eigen::EigenvaluesOnly).eigenvalues();  // ascending
  const double rounding = 1e-6 * moments[2];
  const bool of_a_body = moments[2] >= kSmallest_m * kSmallest_m && moments[0] >= -rounding &&
                         moments[0] + moments[1] >= moments[2] - rounding;
  if (!of_a_body) refuse(field, I.reshaped().transpose(), expected, kBakeAnew);
  return I;
}

}  // namespace

SceneModel scene_model(const wire::SceneInfo& info) {
  if (info.schema != wire::kSchema) refuse("schema", info.schema, "that of this build", kBakeAnew);
  SceneModel model;
  model.server_epoch = info.server_epoch;
  model.identity = {info.field_hash, info.shell_hash};
  model.X_TM = pose("X_TM", info.X_TM);
  model.X_WO = pose("X_WO", info.X_WO);
  model.inertia_shape_m2 = inertia_shape("inertia_shape_m2", info.inertia_shape_m2);
  model.gyration_radius_m = length("gyration_radius_m", info.gyration_radius_m);
  model.tool_radius_m = length("tool_radius_m", info.tool_radius_m);
  model.voxel_m = length("voxel_m", info.voxel_m);
  model.stiffness_n_per_m = within("stiffness_n_per_m", info.stiffness_n_per_m, 1e-3, kStiffest_n_per_m,
                                   "a stiffness from 1e-3 to 1e9 N/m", kBakeAnew);
  model.x_max_m = length("x_max_m", info.x_max_m);
  return model;
}

}  // namespace tact::coupling
