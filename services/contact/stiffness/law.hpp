#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "contact/model/contact.hpp"
#include "contact/model/pointshell.hpp"

namespace tact::contact {

/// Numbers of the laws. make_law throws SetupError when one that the chosen law uses is out of range.
struct LawParams {
  double epsilon = 0.01;           ///< eq. 6: directions this near count as one. [1e-4, 2]
  int n0 = 10;                     ///< eq. 2: contacts before scaling begins. >= 1
  int p = 16;                      ///< potential: exponent of the depths. [2, 64]
  int q = 8;                       ///< potential: sharpness of beta. [1, 64]
  double reach_deg = 60;           ///< potential: beta is zero beyond this angle. [305 / sqrt(directions), 180]
  int directions = 64;             ///< potential: directions on the sphere. [32, 4096]
  double lever_floor_m = 1e-3;     ///< adaptive-6dof: |r x N| below which T fades to zero, see adaptive.hpp. > 0
  double lever_unit_m = 0;         ///< adaptive-6dof, 0: unit T, eq. 10; > 0: T = r x N / this, eq. 13
  double cluster_radius_m = 5e-4;  ///< cluster: contacts nearer than this are one. > 0
  std::string cluster_law = "adaptive-6dof";  ///< cluster: weighs what it leaves; any law but cluster
};

/// Rescales the stiffness of each contact: force of contact i = w_i k depth_i e_i, e_i = contacts.force_direction(i). A
/// lonely contact has w = 1.
///
/// A law belongs to one rigid shell: normals and torque directions turn together with the tool, so whatever depends
/// on angles between them is prepared per point when the law is made. Building allocates; serving never does.
class Law {
 public:
  Law() = default;
  Law(const Law&) = delete;
  Law& operator=(const Law&) = delete;
  virtual ~Law() = default;

  /// Writes contacts.weight[0, size). A law may reduce the contacts first: to fewer, in ascending order of point_id,
  /// each standing for several ("cluster"). Real-time: does not allocate, lock or throw.
  /// @pre contacts.size <= capacity given to make_law; every point_id belongs to the shell, none occurs twice.
  virtual void weigh(ContactBuffer& contacts) noexcept = 0;

  /// Takes the stiffness sums of the contacts weighed last from fixed weights to weights that follow the depths:
  ///   ss = sum_i w_i s_i s_i^T  ->  sum_ij s_i H_ij s_j^T,   sh = sum_i w_i s_i sh_i^T  ->  sum_ij s_i H_ij sh_j^T
  /// where H_ij = d(w_i depth_i)/d depth_j, s = (e, r x e), sh = (g, r x g). Laws whose weights do not depend on the
  /// depths leave both as they are: their weights are constant while the contact set is. `ss` stays positive
  /// semidefinite. Real-time.
  virtual void include_weight_derivative(Mat6& ss, Mat6& sh) const noexcept;
};

/// "none", "global", "cluster", "adaptive-3dof", "adaptive-6dof", "potential".
std::span<const std::string_view> law_names() noexcept;

/// Throws SetupError when the name is unknown or a parameter of that law is out of range. The law keeps no reference
/// to the shell. Allocates what this law needs and nothing more (none, global: nothing).
std::unique_ptr<Law> make_law(std::string_view name, const LawParams& params, const Pointshell& shell,
                              std::size_t capacity);

}  // namespace tact::contact
