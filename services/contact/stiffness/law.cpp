#include "contact/stiffness/law.hpp"

#include <array>
#include <cmath>
#include <string>

#include "contact/stiffness/adaptive.hpp"
#include "contact/stiffness/cluster.hpp"
#include "contact/stiffness/potential.hpp"
#include "contact/stiffness/uniform.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"none",          "global",        "cluster",
                                                    "adaptive-3dof", "adaptive-6dof", "potential"};

void require(bool ok, const char* key, double found, const char* expected) {
  if (ok) return;
  std::string value = std::to_string(found);
  throw SetupError(std::string("contact.") + key + ": found " + value + ", expected " + expected);
}

}  // namespace

void Law::include_weight_derivative(Mat6&, Mat6&) const noexcept {}

std::span<const std::string_view> law_names() noexcept { return kNames; }

std::unique_ptr<Law> make_law(std::string_view name, const LawParams& params, const Pointshell& shell,
                              std::size_t capacity) {
  if (name == "none") return std::make_unique<NoScaling>();
  if (name == "global") {
    require(params.n0 >= 1, "n0", params.n0, "1 or more");
    return std::make_unique<GlobalScaling>(params.n0);
  }
  if (name == "adaptive-3dof" || name == "adaptive-6dof") {
    require(params.epsilon >= 1e-4 && params.epsilon <= 2, "epsilon", params.epsilon, "1e-4 to 2");
    require(params.lever_floor_m > 0, "lever_floor_m", params.lever_floor_m, "more than 0");
    if (name == "adaptive-3dof") return std::make_unique<Adaptive3Dof>(shell, params.epsilon);
    if (params.lever_unit_m > 0) {
      // Longer directions would be rounded by more than 1e-10 of the usual epsilon.
      require(params.lever_unit_m >= 1e-4 * shell.bounding_radius_m, "lever_unit_m", params.lever_unit_m,
              "0, or the tool's radius over 10000 or more");
    } else {
      require(params.lever_unit_m == 0, "lever_unit_m", params.lever_unit_m, "0 (unit torque directions) or more");
    }
    return std::make_unique<Adaptive6Dof>(shell, params.epsilon, params.lever_floor_m, params.lever_unit_m);
  }
  if (name == "cluster") {
    require(params.cluster_radius_m > 0, "cluster_voxels", params.cluster_radius_m, "more than 0");
    if (params.cluster_law == "cluster") {
      throw SetupError("contact.cluster_law: found \"cluster\", expected another law, to weigh the clusters");
    }
    return std::make_unique<Cluster>(shell, params.cluster_radius_m, capacity,
                                     make_law(params.cluster_law, params, shell, capacity));
  }
  if (name == "potential") {
    require(params.p >= 2 && params.p <= 64, "p", params.p, "2 to 64");
    require(params.q >= 1 && params.q <= 64, "q", params.q, "1 to 64");
    require(params.directions >= 32 && params.directions <= 4096, "directions", params.directions, "32 to 4096");
    // Directions are sqrt(4 pi / n) apart; every normal must reach a few.
    const double reach_min = 1.5 * 180 / M_PI * std::sqrt(4 * M_PI / params.directions);
    require(params.reach_deg >= reach_min && params.reach_deg <= 180, "reach_deg", params.reach_deg,
            (std::to_string(reach_min) + " (for " + std::to_string(params.directions) + " directions) to 180").c_str());
    const Potential::Params potential{params.p, params.q, params.directions, params.reach_deg * M_PI / 180};
    return std::make_unique<Potential>(shell, potential, capacity);
  }
  std::string known;
  for (std::string_view n : kNames) known += (known.empty() ? "" : ", ") + std::string(n);
  throw SetupError("contact.law: found \"" + std::string(name) + "\", expected one of " + known);
}

}  // namespace tact::contact
