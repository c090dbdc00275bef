#include "contact/stiffness/potential.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "contact/contact_set.hpp"

namespace tact::contact {
namespace {

using test::ContactSet;
constexpr int kDirections = 162;

std::vector<double> forces(Potential& law, const ContactSet& set) {
  ContactBuffer b = set.buffer();
  law.weigh(b);
  std::vector<double> f;
  for (std::size_t i = 0; i < b.size; ++i) f.push_back(b.weight[i] * b.depth_m[i]);
  return f;
}

/// w as in the header, summed contact by contact and direction by direction, without groups or scaling.
std::vector<double> definition(const ContactSet& set, int p, int q) {
  const PotentialDirections u(kDirections);
  const double c = (2.0 * q / p + 1) / kDirections;
  const auto beta = [&](std::size_t i, std::size_t j) {
    const Vec3 N = set.N[i].normalized();
    return std::pow(0.5 + N.x() * u.x[j] + N.y() * u.y[j] + N.z() * u.z[j], q);
  };
  std::vector<double> gamma(set.size()), w(set.size(), 0.0);
  for (std::size_t i = 0; i < set.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < kDirections; ++j) sum += std::pow(beta(i, j), 2.0 / p);
    gamma[i] = 1 / std::sqrt(c * sum);
  }
  for (std::size_t j = 0; j < kDirections; ++j) {
    double A = 0;
    for (std::size_t i = 0; i < set.size(); ++i) A += beta(i, j) * std::pow(gamma[i] * set.depth_m[i], p);
    for (std::size_t i = 0; i < set.size(); ++i) {
      w[i] +=
          c * gamma[i] * gamma[i] * beta(i, j) * std::pow(std::pow(gamma[i] * set.depth_m[i], p) / A, (p - 2.0) / p);
    }
  }
  return w;
}

TEST(Potential, EqualsItsDefinition) {
  std::mt19937 rng(6);
  for (const auto& [p, q] : {std::pair{16, 8}, std::pair{8, 8}, std::pair{2, 8}, std::pair{3, 5}, std::pair{10, 1}}) {
    for (const int n : {1, 2, 17, 120}) {
      const ContactSet set = test::random_contacts(rng, n, n / 3, 0.3);
      Potential law(set.shell(), p, q, kDirections, set.size());
      ContactBuffer b = set.buffer();
      law.weigh(b);
      const auto w = definition(set, p, q);
      for (std::size_t i = 0; i < set.size(); ++i) EXPECT_NEAR(b.weight[i], w[i], 1e-11) << p << " " << q << " " << n;
    }
  }
}

TEST(Potential, EqualNormalsAreSummedAsOneAndGiveTheSameWeights) {
  std::mt19937 rng(7);
  ContactSet set = test::random_contacts(rng, 90, 6, 0.0);
  Potential law(set.shell(), 16, 8, kDirections, set.size());
  ContactBuffer b = set.buffer();
  law.weigh(b);
  const auto w = definition(set, 16, 8);
  for (std::size_t i = 0; i < set.size(); ++i) EXPECT_NEAR(b.weight[i], w[i], 1e-11);
}

/// The forces are the gradient of an energy: their matrix of derivatives by the depths is symmetric, positive
/// semidefinite, and what include_weight_derivative says it is.
TEST(Potential, TheHessianInTheDepthsIsSymmetricPositiveSemidefiniteAndTheOneReported) {
  std::mt19937 rng(8);
  for (const int p : {2, 8, 16}) {
    ContactSet set = test::random_contacts(rng, 12, 3, 0.4);
    for (auto& depth : set.depth_m) depth = test::uniform(rng, 3e-4, 1e-3);
    Potential law(set.shell(), p, 8, kDirections, set.size());
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

    ContactBuffer b = set.buffer();
    law.weigh(b);
    Eigen::MatrixXd S(6, n), Sh(6, n);
    Mat6 ss = Mat6::Zero(), sh = Mat6::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto c = static_cast<std::size_t>(i);
      S.col(i) << b.N[c], b.r[c].cross(b.N[c]);
      Sh.col(i) << b.g[c], b.r[c].cross(b.g[c]);
      ss += b.weight[c] * S.col(i) * S.col(i).transpose();
      sh += b.weight[c] * S.col(i) * Sh.col(i).transpose();
    }
    law.include_weight_derivative(ss, sh);
    EXPECT_LT((ss - S * H * S.transpose()).norm(), 1e-5 * ss.norm()) << p;
    EXPECT_LT((sh - S * H * Sh.transpose()).norm(), 1e-5 * sh.norm()) << p;
  }
}

TEST(Potential, ForcesGrowInProportionToTheDepths) {
  std::mt19937 rng(9);
  ContactSet set = test::random_contacts(rng, 40);
  Potential law(set.shell(), 16, 8, kDirections, set.size());
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
    Potential law(set.shell(), 16, 8, kDirections, set.size());
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
  Potential law(all.shell(), 16, 8, kDirections, all.size());
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

TEST(Potential, HugeRangesOfDepthNeitherOverflowNorVanish) {
  std::mt19937 rng(11);
  for (int trial = 0; trial < 20; ++trial) {
    ContactSet set = test::random_contacts(rng, 60);
    for (auto& d : set.depth_m) d = std::pow(10, test::uniform(rng, -40, 2));
    set.add(Vec3(0.01, 0, 0), Vec3::UnitZ(), 1.0);
    set.add(Vec3(0.01, 0, 0), -Vec3::UnitZ(), 1e-9);  // straight opposite: alone in its directions
    for (const int p : {2, 16, 64}) {
      Potential law(set.shell(), p, 64, kDirections, set.size());
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
