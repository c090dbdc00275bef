#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "contact/bake/test_meshes.hpp"
#include "contact/hierarchy.hpp"
#include "contact/pipeline/contact_pipeline.hpp"
#include "field/field_builder.hpp"
#include "math/exp_log.hpp"

namespace tact::contact {
namespace {

/// A body as a formula. Its box is the grid's: all is symmetric, so that no face falls on a lattice plane by itself.
struct Body {
  std::function<double(const Vec3&)> distance_m;
  Vec3 low, high;
  bool from_above = false;  // there is no other side
};

const Vec3 kOff(0.0003, -0.0007, 0.0011);  // from the lattice's symmetry planes

Body half_space() {
  return {[](const Vec3& p) { return p.z() - kOff.z(); }, Vec3(-0.06, -0.06, -0.02), Vec3(0.06, 0.06, 0.02), true};
}
Body sphere() {
  return {[](const Vec3& p) { return (p - kOff).norm() - 0.03; }, Vec3::Constant(-0.032), Vec3::Constant(0.032)};
}
Body box() {
  return {[](const Vec3& p) {
            return tact::test::box_distance(p - kOff, Vec3(-0.03, -0.02, -0.025), Vec3(0.03, 0.02, 0.025));
          },
          Vec3::Constant(-0.032), Vec3::Constant(0.032)};
}
Body cylinder() {
  return {[](const Vec3& p) { return tact::test::cylinder_distance(p - kOff, 0.02, 0.03); }, Vec3::Constant(-0.032),
          Vec3::Constant(0.032)};
}
Body torus() {
  return {[](const Vec3& p) { return tact::test::torus_distance(p - kOff, 0.03, 0.012); }, Vec3(-0.044, -0.044, -0.014),
          Vec3(0.044, 0.044, 0.014)};
}

double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto edge = [&](const Vec3& from, const Vec3& to) {
    const double t = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (p - from - t * (to - from)).norm();
  };
  const Vec3 n = (b - a).cross(c - a).normalized(), q = p - n.dot(p - a) * n;
  const auto left = [&](const Vec3& from, const Vec3& to) { return (to - from).cross(q - from).dot(n) >= 0; };
  const double rim = std::min({edge(a, b), edge(b, c), edge(c, a)});
  return left(a, b) && left(b, c) && left(c, a) ? std::fabs(n.dot(p - a)) : rim;
}

/// Two tetrahedra on either side of a common face, one leaning over: not convex.
Body two_tetrahedra() {
  static const std::array<Vec3, 5> v{Vec3(-0.025, -0.02, 0), Vec3(0.02, -0.018, 0.001), Vec3(-0.012, 0.022, 0.002),
                                     Vec3(0.026, 0.02, 0.028), Vec3(-0.01, -0.008, -0.028)};
  const auto in_tetrahedron = [](const Vec3& p, std::size_t apex) {
    const std::size_t corners[4] = {0, 1, 2, apex};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 &a = v[corners[(i + 1) % 4]], &b = v[corners[(i + 2) % 4]], &c = v[corners[(i + 3) % 4]];
      const Vec3 n = (b - a).cross(c - a);
      if (n.dot(p - a) * n.dot(v[corners[i]] - a) < 0) return false;
    }
    return true;
  };
  return {[=](const Vec3& p) {
            double least = 1;
            for (const auto& [a, b, c] : {std::array{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}}) {
              const auto at = [&](int i) { return v[static_cast<std::size_t>(i)]; };
              least = std::min(least, triangle_distance(p, at(a), at(b), at(c)));
            }
            return in_tetrahedron(p, 3) || in_tetrahedron(p, 4) ? -least : least;
          },
          Vec3::Constant(-0.03), Vec3::Constant(0.03)};
}

Vec3 gradient(const Body& body, const Vec3& p) {
  constexpr double e = 1e-7;
  Vec3 g;
  for (int k = 0; k < 3; ++k) {
    g[k] = (body.distance_m(p + e * Vec3::Unit(k)) - body.distance_m(p - e * Vec3::Unit(k))) / (2 * e);
  }
  return g;
}

/// The contacts of the formula itself: no grid, no traversal.
ContactBuffer exact_contacts(const Body& body, const Pointshell& shell, const Pose& X_OT, ForceDirection along) {
  ContactBuffer contacts(shell.size());
  contacts.force_along = along;
  for (std::uint32_t i = 0; i < shell.size(); ++i) {
    const Vec3 r = X_OT.q * shell.position_T[i].cast<double>();
    const double depth = -body.distance_m(X_OT.p + r);
    if (depth <= 0) continue;
    const std::size_t c = contacts.size++;
    contacts.point_id[c] = i;
    contacts.r[c] = r;
    contacts.N[c] = X_OT.q * shell.normal_T[i].cast<double>();
    contacts.g[c] = gradient(body, X_OT.p + r);
    contacts.depth_m[c] = depth;
  }
  return contacts;
}

/// The tool turned at random, moved in from a random side until its deepest point is `depth_m` deep.
Pose pressed(const Body& body, const Pointshell& shell, double depth_m, std::mt19937& rng) {
  Vec3 u = test::random_unit(rng);
  if (body.from_above) u = (Vec3(0, 0, 3) + u).normalized();
  const Quat q = exp_so3(3 * test::random_unit(rng));
  double in = 0, out = 0.15;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (in + out);
    double deepest = -1;
    for (const auto& p : shell.position_T) {
      deepest = std::max(deepest, -body.distance_m(middle * u + q * p.cast<double>()));
    }
    (deepest > depth_m ? in : out) = middle;
  }
  return {out * u, q};
}

PipelineParams params(std::string_view law, ForceDirection along) {
  ContactSpec spec;
  spec.law = law;
  spec.stiffness_n_per_m = 1e4;
  spec.force_along = along == ForceDirection::normal ? "normal" : "gradient";
  PipelineParams p = pipeline_params(spec, 1e-3, 0.2, 1);  // laws take lengths from a voxel: the same for all grids
  p.law_params.epsilon = 0.3;
  return p;
}

/// Relative error of the wrench, rms over poses, on grids of 2, 1 and 0.5 mm.
std::array<double, 3> errors(const Body& body, std::string_view law, ForceDirection along) {
  std::mt19937 rng(91);
  const auto shell = std::make_shared<const Pointshell>(test::sphere_shell(rng, 3000, 0.025));
  std::vector<Pose> poses;
  std::vector<Vec6> reference;
  const PipelineParams p = params(law, along);
  const auto weigher = make_law(law, p.law_params, *shell, shell->size());
  for (int i = 0; i < 15; ++i) {
    poses.push_back(pressed(body, *shell, 1.2e-3, rng));
    ContactBuffer exact = exact_contacts(body, *shell, poses.back(), along);
    weigher->weigh(exact);
    reference.push_back(assemble(exact, *weigher, p.stiffness_n_per_m, 0, {}).F.vector());
  }
  std::array<double, 3> out{};
  for (std::size_t grid = 0; grid < out.size(); ++grid) {
    const double voxel = 2e-3 / std::pow(2, static_cast<double>(grid));
    ContactPipeline pipeline(build_field(body.low, body.high, voxel, body.distance_m), shell, shell->size(), p);
    double sum = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      ToolQuery query;
      query.X_WT = poses[i];
      const Vec6 off = pipeline.step(query).response_W.F.vector() - reference[i];
      const auto size = [](const Vec6& F) { return std::hypot(F.head<3>().norm(), F.tail<3>().norm() / 0.025); };
      sum += std::pow(size(off) / size(reference[i]), 2);
    }
    out[grid] = std::sqrt(sum / static_cast<double>(poses.size()));
  }
  return out;
}

/// From the coarsest to the finest grid.
double order(const std::array<double, 3>& e) { return 0.5 * std::log2(e[0] / e[2]); }

constexpr std::string_view kLaws[] = {"none", "adaptive-6dof", "potential"};

TEST(ClosedForm, AHalfSpaceIsExactWhateverTheGrid) {
  for (const std::string_view law : kLaws) {
    for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
      // Values are stored in steps of a 32767th of some four voxels.
      for (const double e : errors(half_space(), law, along)) EXPECT_LT(e, 1e-3) << law;
    }
  }
}

/// Depths are of second order. So are forces along the points' normals; along the gradient, which turns from cell to
/// cell, they are of first order at least.
TEST(ClosedForm, WrenchesOfSmoothBodiesAreOfSecondOrderAlongNormalsAndFirstAlongTheGradient) {
  for (const Body& body : {sphere(), torus()}) {
    for (const std::string_view law : kLaws) {
      const auto normal = errors(body, law, ForceDirection::normal), g = errors(body, law, ForceDirection::gradient);
      EXPECT_LT(normal[2], 0.03) << law;
      // Weights of the adaptive laws jump with the contact set, which differs by a point or two.
      EXPECT_GT(order(normal), law == "adaptive-6dof" ? 1.0 : 1.6) << law;
      EXPECT_LT(g[2], 0.03) << law;
      EXPECT_GT(order(g), 0.9) << law;
    }
  }
}

/// At edges the grid rounds: an error in proportion to the voxel along normals. Along the gradient the formula itself
/// jumps where two faces are equally near; the interpolated one turns over a voxel there. The fewer contacts bear the
/// load, the more that shows.
TEST(ClosedForm, WrenchesOfBodiesWithEdgesConvergeAlongNormalsAndSlowlyAlongTheGradient) {
  for (const Body& body : {box(), cylinder(), two_tetrahedra()}) {
    for (const std::string_view law : kLaws) {
      const auto normal = errors(body, law, ForceDirection::normal), g = errors(body, law, ForceDirection::gradient);
      EXPECT_LT(normal[2], 0.1) << law;
      EXPECT_GT(order(normal), 0.8) << law;
      EXPECT_LT(g[2], 0.5) << law;
      EXPECT_GT(order(g), 0.1) << law;
    }
  }
}

/// By hand: n points of a box's face, depth d, net stiffness n (none), n0 (global), 1 (3dof), n^(2/p) (potential).
TEST(ClosedForm, AFlatFacePressedOnAHalfSpaceGivesTheForceOfTheTable) {
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 400; ++i) {
    points.emplace_back(0.001 * (i % 20) - 0.0095, 0.001 * (i / 20) - 0.0095, -0.01);
    normals.push_back(Vec3::UnitZ());
  }
  const auto shell = std::make_shared<const Pointshell>(test::make_hierarchy(points, normals, 4, 5));
  const double voxel = 1e-3, depth = 4e-4;
  const DistanceField field = build_field(half_space().low, half_space().high, voxel, half_space().distance_m);
  ToolQuery query;
  query.X_WT = {Vec3(0.002, -0.003, kOff.z() + 0.01 - depth), Quat::Identity()};
  for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
    for (const auto& [law, net] : {std::pair<std::string_view, double>{"none", 400},
                                   {"global", 10},
                                   {"adaptive-3dof", 1},
                                   {"potential", std::pow(400, 2.0 / 16)}}) {
      ContactPipeline pipeline(field, shell, 1000, params(law, along));
      const Wrench F = pipeline.step(query).response_W.F;
      EXPECT_NEAR(F.force.z(), 1e4 * net * depth, 2e-3 * 1e4 * net * depth) << law;
      EXPECT_LT(F.force.head<2>().norm(), 1e-3 * F.force.z()) << law;
      EXPECT_LT(F.torque.norm(), 1e-3 * 0.01 * F.force.z()) << law;
    }
  }
}

}  // namespace
}  // namespace tact::contact
