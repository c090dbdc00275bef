#include "contact/stiffness/potential.hpp"

#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <Eigen/Eigenvalues>

#include "contact/contact_set.hpp"

namespace tact::contact {
namespace {

using test::ContactSet;
constexpr int kDirections = 64;

std::vector<double> forces(Potential& law, const ContactSet& set) {
  ContactBuffer b = set.buffer();
  law.weigh(b);
  std::vector<double> f;
  for (std::size_t i = 0; i < b.size; ++i) f.push_back(b.weight[i] * b.depth_m[i]);
  return f;
}

Potential::Params params(int p, int q = 8, double reach_deg = 60) {
  return {p, q, kDirections, reach_deg * std::numbers::pi / 180};
}

/// w as in the header, summed contact by contact and direction by direction, without groups or scaling.
std::vector<double> definition(const ContactSet& set, const Potential::Params& params) {
  const std::vector<Vec3> u = Potential::directions(params.directions);
  const double p = params.p, limit = std::cos(params.reach_rad);
  const auto beta = [&](std::size_t i, const Vec3& direction) {
    const double b = std::pow(std::max(0.0, (set.N[i].normalized().dot(direction) - limit) / (1 - limit)), params.q);
    return b < 1e-30 ? 0 : b;
  };
  std::vector<double> gamma(set.size()), w(set.size(), 0.0);
  for (std::size_t i = 0; i < set.size(); ++i) {
    double sum = 0;
    for (const Vec3& v : u) sum += std::pow(beta(i, v), 2.0 / p);
    gamma[i] = 1 / std::sqrt(sum);
  }
  for (const Vec3& v : u) {
    double A = 0;
    for (std::size_t i = 0; i < set.size(); ++i) A += beta(i, v) * std::pow(gamma[i] * set.depth_m[i], p);
    for (std::size_t i = 0; i < set.size() && A > 0; ++i) {
      w[i] += gamma[i] * gamma[i] * beta(i, v) * std::pow(std::pow(gamma[i] * set.depth_m[i], p) / A, (p - 2.0) / p);
    }
  }
  return w;
}

TEST(Potential, EqualsItsDefinition) {
  std::mt19937 rng(6);
  for (const auto& it : {params(16), params(8), params(2), params(3, 5), params(10, 1), params(16, 8, 30),
                         params(16, 8, 180), params(6, 4, 90)}) {
    for (const int n : {1, 2, 17, 120}) {
      const ContactSet set = test::random_contacts(rng, n, n / 3, 0.3);
      Potential law(set.shell(), it, set.size());
      ContactBuffer b = set.buffer();
      const auto w = definition(set, it);
      for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
        b.force_along = along;
        law.weigh(b);
        // beta is kept in single precision.
        for (std::size_t i = 0; i < set.size(); ++i) EXPECT_NEAR(b.weight[i], w[i], 1e-6) << it.p << " " << n;
      }
    }
  }
}

TEST(Potential, EqualsItsDefinitionForManyContacts) {
  std::mt19937 rng(16);
  ContactSet equal;
  for (int i = 0; i < 10000; ++i) equal.add(Vec3(1e-5 * i, 0, 0), Vec3(0.6, 0, 0.8), test::uniform(rng, 1e-5, 1e-3));
  for (const ContactSet& set : {test::random_contacts(rng, 200), test::random_contacts(rng, 10000), equal}) {
    Potential law(set.shell(), params(16), set.size());
    ContactBuffer b = set.buffer();
    law.weigh(b);
    const auto w = definition(set, params(16));
    for (std::size_t i = 0; i < set.size(); ++i) ASSERT_NEAR(b.weight[i], w[i], 2e-6 * w[i] + 1e-12) << set.size();
  }
}

TEST(Potential, EqualNormalsAreSummedAsOneAndGiveTheSameWeights) {
  std::mt19937 rng(7);
  ContactSet set = test::random_contacts(rng, 90, 6, 0.0);
  Potential law(set.shell(), params(16), set.size());
  ContactBuffer b = set.buffer();
  law.weigh(b);
  const auto w = definition(set, params(16));
  for (std::size_t i = 0; i < set.size(); ++i) EXPECT_NEAR(b.weight[i], w[i], 1e-6);
}

TEST(Potential, EveryInstructionSetGivesTheSameWeightsAndSums) {
  std::mt19937 rng(13);
  const ContactSet set = test::random_contacts(rng, 150, 40, 0.2);
  Potential law(set.shell(), params(16), set.size());
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
    ContactBuffer first(1);
    Mat6 first_ss = Mat6::Zero(), first_sh = Mat6::Zero();
    for (const std::int64_t target : targets) {
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      ContactBuffer b = set.buffer();
      b.force_along = along;
      law.weigh(b);
      Mat6 ss = Mat6::Zero(), sh = Mat6::Zero();
      law.include_weight_derivative(ss, sh);
      if (first.size == 0) first = b, first_ss = ss, first_sh = sh;
      for (std::size_t i = 0; i < b.size; ++i) EXPECT_NEAR(b.weight[i], first.weight[i], 1e-12);
      EXPECT_LT((ss - first_ss).norm(), 1e-10 * ss.norm()) << hwy::TargetName(target);
      EXPECT_LT((sh - first_sh).norm(), 1e-10 * sh.norm()) << hwy::TargetName(target);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(Potential, FacesFurtherApartThanTwiceTheReachKnowNothingOfEachOther) {
  std::mt19937 rng(14);
  ContactSet up = test::flat_face(3, 3, 0.1, 0), both = up;
  for (auto& d : up.depth_m) d = test::uniform(rng, 1e-5, 1e-3);
  both.depth_m = up.depth_m;
  for (int i = 0; i < 5; ++i) both.add(Vec3(0.01 * i, 0, 0.1), Vec3(0.9, 0.1 * i, -0.7), 2e-3);  // over 120 degrees
  Potential alone(up.shell(), params(16), up.size()), together(both.shell(), params(16), both.size());
  const auto f = forces(alone, up), g = forces(together, both);
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(g[i], f[i], 1e-12);
}

/// Contacts with normals within alpha of an axis, the rest of the tool's contacts beyond twice the reach from them:
/// k depth <= sum of their forces <= force of this cluster along the axis / cos alpha, whatever else pushes the tool.
TEST(Potential, NoPointIsDeeperThanTheLoadOfItsClusterOverStiffness) {
  std::mt19937 rng(15);
  const double alpha = 0.35;
  for (int trial = 0; trial < 100; ++trial) {
    ContactSet set;
    const int n = 1 + trial % 40;
    for (int i = 0; i < 2 * n; ++i) {
      const Vec3 axis = i < n ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
      const Vec3 side = axis.cross(test::random_unit(rng));
      const double angle = test::uniform(rng, 0, alpha);
      set.add(0.1 * test::random_unit(rng), std::cos(angle) * axis + std::sin(angle) * side.normalized(),
              std::pow(10, test::uniform(rng, -6, -3)));
    }
    Potential law(set.shell(), params(16), set.size());
    const auto f = forces(law, set);
    for (const int half : {0, 1}) {
      double sum = 0, deepest = 0, along = 0;
      for (int i = half * n; i < (half + 1) * n; ++i) {
        const auto c = static_cast<std::size_t>(i);
        sum += f[c];
        along += f[c] * std::fabs(set.N[c].z());
        deepest = std::max(deepest, set.depth_m[c]);
      }
      EXPECT_GE(sum, deepest * (1 - 1e-6));
      EXPECT_GE(along / std::cos(alpha), deepest * (1 - 1e-6));
    }
  }
}

/// All normals there are, all at one depth: the stiffness of the whole sphere is 1 / mean(beta^(2/p)) k at most.
TEST(Potential, TheStiffnessOfAllDirectionsTogetherIsBounded) {
  ContactSet set;
  for (const Vec3& n : Potential::directions(4000)) set.add(0.05 * n, n, 1e-4);
  for (const double reach_deg : {180.0, 90.0, 60.0, 45.0}) {
    Potential law(set.shell(), params(16, 8, reach_deg), set.size());
    double total = 0;
    for (const double f : forces(law, set)) total += f / 1e-4;
    // mean of t over the sphere, t = (x - cos)/(1 - cos): (1 - cos)/4. Many equal points add their n^(2/p).
    const double bound = 4 / (1 - std::cos(reach_deg * std::numbers::pi / 180));
    EXPECT_LT(total, bound * std::pow(4000, 2.0 / 16)) << reach_deg;
    EXPECT_GT(total, bound * 0.9) << reach_deg;
  }
}

/// The forces are the gradient of an energy: their matrix of derivatives by the depths is symmetric, positive
/// semidefinite, and what include_weight_derivative says it is.
TEST(Potential, TheHessianInTheDepthsIsSymmetricPositiveSemidefiniteAndTheOneReported) {
  std::mt19937 rng(8);
  for (const int p : {2, 8, 16}) {
    ContactSet set = test::random_contacts(rng, 12, 3, 0.4);
    for (auto& depth : set.depth_m) depth = test::uniform(rng, 3e-4, 1e-3);
    Potential law(set.shell(), params(p), set.size());
    const auto n = static_cast<Eigen::Index>(set.size());
    Eigen::MatrixXd H(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double step = 1e-9;
      ContactSet plus = set, minus = set;
      plus.depth_m[static_cast<std::size_t>(j)] += step;
      minus.depth_m[static_cast<std::size_t>(j)] -= step;
      const auto f_plus = forces(law, plus), f_minus = forces(law, minus);
      for (Eigen::Index i = 0; i < n; ++i) {
        H(i, j) = (f_plus[static_cast<std::size_t>(i)] - f_minus[static_cast<std::size_t>(i)]) / (2 * step);
      }
    }
    EXPECT_LT((H - H.transpose()).norm(), 1e-6 * H.norm()) << p;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(H).eigenvalues().minCoeff(), -1e-6 * H.norm()) << p;

    for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
      ContactBuffer b = set.buffer();
      b.force_along = along;
      b.g[3].setZero();  // beyond the band
      law.weigh(b);
      Eigen::MatrixXd S(6, n), Sh(6, n);
      Mat6 ss = Mat6::Zero(), sh = Mat6::Zero();
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto c = static_cast<std::size_t>(i);
        const Vec3& e = b.force_direction(c);
        S.col(i) << e, b.r[c].cross(e);
        Sh.col(i) << b.g[c], b.r[c].cross(b.g[c]);
        ss += b.weight[c] * S.col(i) * S.col(i).transpose();
        sh += b.weight[c] * S.col(i) * Sh.col(i).transpose();
      }
      law.include_weight_derivative(ss, sh);
      EXPECT_LT((ss - S * H * S.transpose()).norm(), 1e-5 * ss.norm()) << p;
      EXPECT_LT((sh - S * H * Sh.transpose()).norm(), 1e-5 * sh.norm()) << p;
    }
  }
}

TEST(Potential, ForcesGrowInProportionToTheDepths) {
  std::mt19937 rng(9);
  ContactSet set = test::random_contacts(rng, 40);
  Potential law(set.shell(), params(16), set.size());
  const auto f = forces(law, set);
  for (const double scale : {1e-12, 1e-3, 1e6}) {
    ContactSet scaled = set;
    for (auto& d : scaled.depth_m) d *= scale;
    const auto g = forces(law, scaled);
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(g[i] / scale, f[i], 1e-12 * (f[i] + 1e-9));
  }
}

TEST(Potential, NoPointIsDeeperThanForceOverStiffnessWhileNormalsAreParallel) {
  std::mt19937 rng(10);
  for (int trial = 0; trial < 50; ++trial) {
    ContactSet set = test::flat_face(7, 5, 0.1, 0);
    for (auto& d : set.depth_m) d = std::pow(10, test::uniform(rng, -7, -3));
    Potential law(set.shell(), params(16), set.size());
    const auto f = forces(law, set);
    double total = 0, work = 0, deepest = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      total += f[i];
      work += f[i] * set.depth_m[i];
      deepest = std::max(deepest, set.depth_m[i]);
    }
    EXPECT_GE(total, deepest * (1 - 1e-12));
    EXPECT_GE(work, deepest * deepest * (1 - 1e-12));
  }
}

TEST(Potential, TheSlopeNeverFallsBelowKAsShallowContactsJoinADeepOne) {
  // A deep point and 176 shallower ones that enter in turn as the tool sinks. Averaging laws pull here.
  const double step = 1e-7;
  double before = -1;
  ContactSet all = test::flat_face(177, 1, 0.1, 0);
  Potential law(all.shell(), params(16), all.size());
  for (double sunk = 1e-4; sunk < 3e-4; sunk += step) {
    ContactBuffer b(all.size());
    double force = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double depth = sunk - (i == 0 ? 0 : 1e-4 + 1e-6 * static_cast<double>(i));
      if (depth <= 0) continue;
      b.point_id[b.size] = static_cast<std::uint32_t>(i);
      b.r[b.size] = all.r[i];
      b.N[b.size] = b.g[b.size] = all.N[i];
      b.depth_m[b.size++] = depth;
    }
    law.weigh(b);
    for (std::size_t i = 0; i < b.size; ++i) force += b.weight[i] * b.depth_m[i];
    if (before >= 0) {
      ASSERT_GE(force - before, step * (1 - 1e-6)) << sunk;
    }
    before = force;
  }
}

/// Slope of the force along `n` as all contacts move that way: n^T (sum_ij N_i H_ij N_j^T) n.
double slope_along(const ContactSet& set, const Vec3& n) {
  Potential law(set.shell(), params(16), set.size());
  ContactBuffer b = set.buffer();
  b.force_along = ForceDirection::normal;
  law.weigh(b);
  Mat6 ss = Mat6::Zero(), sh = Mat6::Zero();
  for (std::size_t i = 0; i < b.size; ++i) {
    ss.topLeftCorner<3, 3>() += b.weight[i] * b.N[i] * b.N[i].transpose();
  }
  law.include_weight_derivative(ss, sh);
  return n.dot(ss.topLeftCorner<3, 3>() * n);
}

/// Where normals differ, a contact lends its directions to a deeper one: along its own normal the slope can be below k.
/// Along the normal of the deepest contact hardly (0.93 k is the least that a search found).
TEST(Potential, TheSlopeAlongAShallowContactsNormalCanFallBelowKButHardlyAlongTheDeepest) {
  ContactSet two;
  const double angle = 54 * std::numbers::pi / 180;
  two.add(Vec3::Zero(), Vec3::UnitZ(), 1e-3);
  two.add(Vec3::Zero(), Vec3(std::sin(angle), 0, std::cos(angle)), 1.3e-4);
  EXPECT_LT(slope_along(two, two.N[1]), 0.9);
  EXPECT_GT(slope_along(two, two.N[0]), 0.99);

  std::mt19937 rng(17);
  for (int trial = 0; trial < 3000; ++trial) {
    const int n = 2 + trial % 6;
    ContactSet set;
    const Vec3 axis = test::random_unit(rng);
    for (int i = 0; i < n; ++i) {
      const double spread = test::uniform(rng, 0.1, 2);
      set.add(Vec3::Zero(), axis + spread * test::random_unit(rng), 1e-3 * std::exp(-test::uniform(rng, 0, 2)));
    }
    const auto deepest = std::max_element(set.depth_m.begin(), set.depth_m.end()) - set.depth_m.begin();
    ASSERT_GT(slope_along(set, set.N[static_cast<std::size_t>(deepest)]), 0.9) << trial;
  }
}

TEST(Potential, HugeRangesOfDepthNeitherOverflowNorVanish) {
  std::mt19937 rng(11);
  for (int trial = 0; trial < 20; ++trial) {
    ContactSet set = test::random_contacts(rng, 60);
    for (auto& d : set.depth_m) d = std::pow(10, test::uniform(rng, -40, 2));
    set.add(Vec3(0.01, 0, 0), Vec3::UnitZ(), 1.0);
    set.add(Vec3(0.01, 0, 0), -Vec3::UnitZ(), 1e-9);  // straight opposite: alone in its directions
    for (const int p : {2, 16, 64}) {
      Potential law(set.shell(), params(p, 64), set.size());
      ContactBuffer b = set.buffer();
      law.weigh(b);
      Mat6 ss = Mat6::Identity(), sh = Mat6::Identity();
      law.include_weight_derivative(ss, sh);
      EXPECT_TRUE(ss.allFinite() && sh.allFinite());
      for (std::size_t i = 0; i < b.size; ++i) {
        EXPECT_TRUE(b.weight[i] >= 0 && b.weight[i] <= 1 + 1e-9) << b.weight[i];
      }
    }
  }
}

}  // namespace
}  // namespace tact::contact
