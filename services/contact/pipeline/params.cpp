#include "contact/pipeline/params.hpp"

#include <cmath>

#include "fault/fault.hpp"

namespace tact::contact {
namespace {

void require(bool ok, const char* key, double found, const char* expected) {
  if (!ok)
    throw SetupError(std::string("contact.") + key + ": found " + std::to_string(found) + ", expected " + expected);
}

int whole(const char* key, double value) {
  require(std::fabs(value) < 1e6 && value == std::floor(value), key, value, "a whole number");
  return static_cast<int>(value);
}

}  // namespace

PipelineParams pipeline_params(const ContactSpec& spec, double voxel_m, double mass_kg, std::uint64_t version) {
  const auto finite = [](double v) { return std::isfinite(v); };
  require(finite(spec.x_max_voxels) && spec.x_max_voxels > 0, "x_max_voxels", spec.x_max_voxels, "more than 0");
  require(finite(spec.stiffness_n_per_m) && spec.stiffness_n_per_m >= 0, "stiffness_n_per_m", spec.stiffness_n_per_m,
          "0 (f_max_n / x_max) or more");
  require(finite(spec.f_max_n) && spec.f_max_n > 0, "f_max_n", spec.f_max_n, "more than 0");
  require(finite(spec.damping_ratio) && spec.damping_ratio >= 0, "damping_ratio", spec.damping_ratio, "0 or more");
  if (spec.force_along != "gradient" && spec.force_along != "held" && spec.force_along != "normal") {
    throw SetupError("contact.force_along: found \"" + spec.force_along + "\", expected gradient, held or normal");
  }
  PipelineParams out;
  out.force_along = spec.force_along == "normal" ? ForceDirection::normal : ForceDirection::gradient;
  out.hold_thin_parts = spec.force_along == "held";
  out.law = spec.law;
  out.law_params.epsilon = spec.epsilon;
  out.law_params.n0 = spec.n0;
  out.law_params.p = whole("p", spec.p);
  out.law_params.q = whole("q", spec.q);
  out.law_params.reach_deg = spec.reach_deg;
  out.law_params.directions = spec.directions;
  out.law_params.lever_floor_m = voxel_m;
  out.law_params.lever_unit_m = spec.lever_unit_m;
  out.law_params.cluster_radius_m = spec.cluster_voxels * voxel_m;
  out.law_params.cluster_law = spec.cluster_law;
  out.x_max_m = spec.x_max_voxels * voxel_m;
  out.stiffness_n_per_m = spec.stiffness_n_per_m > 0 ? spec.stiffness_n_per_m : spec.f_max_n / out.x_max_m;
  out.damping_n_s_per_m = 2 * spec.damping_ratio * std::sqrt(out.stiffness_n_per_m * mass_kg);
  out.version = version;
  return out;
}

}  // namespace tact::contact
