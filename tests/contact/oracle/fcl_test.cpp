#include <gtest/gtest.h>

#include <random>

#include "bench/peers/fcl_peer.hpp"
#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/shell_bake.hpp"
#include "contact/traversal/traversal.hpp"
#include "math/exp_log.hpp"
#include "shapes/shapes.hpp"

namespace tact::contact {
namespace {

Mesh grown(const Mesh& mesh, double by_m) {
  std::vector<Eigen::Vector3f> normal(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    for (const auto v : t) normal[v] += (b - a).cross(c - a).normalized();
  }
  Mesh out = mesh;
  for (std::size_t i = 0; i < out.vertices.size(); ++i) {
    out.vertices[i] += static_cast<float>(by_m) * normal[i].normalized();
  }
  return out;
}

/// Two alphas that slide along one another. A shell point inside by more than the field may err must be a touch for
/// FCL as well; and where FCL still sees a touch with the tool shrunk by the gaps of the shell and the field's error,
/// there must be a contact.
TEST(Fcl, SeesATouchWhereTheContactSetDoesAndTheOtherWayRound) {
  const Mesh alpha = make_shape("alpha", {});
  FieldReport field_report;
  const DistanceField field = make_field(bake_field(clean_soup(alpha), {.resolution = 192}, {}, field_report));
  ShellReport shell_report;
  const auto shell =
      std::make_shared<const Pointshell>(bake_shell(clean_soup(alpha), {.points = 8000}, {}, shell_report));
  const double h = field.voxel_m(), error_m = field_report.quality.error_largest_m;
  // A sharp edge between two points, or between two corners of the field, is missed by at most this.
  const double margin = 0.6 * shell_report.largest_gap_m + error_m;
  bench::FclPair exact(alpha, alpha), smaller(alpha, grown(alpha, -1.5 * margin));

  Traversal traversal(field, shell);
  ContactBuffer contacts(shell->size());
  std::mt19937 rng(61);
  std::uniform_real_distribution<double> any(-1, 1);
  int touching = 0, apart = 0;
  for (int step = 0; step < 400; ++step) {
    const Quat q = exp_so3(0.8 * Vec3(any(rng), any(rng), any(rng)));
    const Pose X_OM{Vec3(0.20 * any(rng), 0.20 * any(rng), 0.10 * any(rng)), q};
    const Findings found = traversal.find(X_OM * shell->X_TM.inverse(), contacts);
    const bool fcl = exact.collide(X_OM, 1) > 0;
    if (found.max_depth_m > error_m && found.max_depth_m < h) {
      EXPECT_TRUE(fcl) << "depth " << found.max_depth_m << " at step " << step;
    }
    if (smaller.collide(X_OM, 1) > 0) {
      EXPECT_GT(contacts.size, 0u) << "step " << step;
    }
    touching += fcl;
    apart += !fcl && contacts.size == 0;
  }
  EXPECT_GT(touching, 50);
  EXPECT_GT(apart, 50);
}

}  // namespace
}  // namespace tact::contact
