#pragma once
#include <cstdint>
#include <string>

#include "contact/stiffness/law.hpp"
#include "session/session.hpp"

namespace tact::contact {

/// What may change between two steps.
struct PipelineParams {
  std::string law = "potential";
  LawParams law_params;
  ForceDirection force_along = ForceDirection::gradient;
  bool hold_thin_parts = false;  ///< see SideMemory
  double stiffness_n_per_m = 0;  ///< k of a lonely contact
  double x_max_m = 0;            ///< depth at which coupling saturates: F_max = k x_max, eq. 15
  double damping_n_s_per_m = 0;  ///< b of a lonely contact
  std::uint64_t version = 0;     ///< echoed with every result
};

/// From a scene: x_max = x_max_voxels * voxel; k = stiffness_n_per_m, or f_max_n / x_max when that is 0;
/// b = damping_ratio * 2 sqrt(k mass), critical for one contact on a free tool; lever floor = one voxel.
/// Throws SetupError naming the key when a value is impossible (the numbers of the law are checked by make_law).
PipelineParams pipeline_params(const ContactSpec& spec, double voxel_m, double mass_kg, std::uint64_t version);

}  // namespace tact::contact
