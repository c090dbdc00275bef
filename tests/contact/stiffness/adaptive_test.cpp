#include "contact/stiffness/adaptive.hpp"

#include <gtest/gtest.h>

#include <hwy/targets.h>

#include "contact/contact_set.hpp"
#include "contact/response/assemble.hpp"

namespace tact::contact {
namespace {

using test::ContactSet;

double hat(const Vec3& a, const Vec3& b, double epsilon) {
  return std::max(1 - (a - b).squaredNorm() / (epsilon * epsilon), 0.0);
}

/// The double sums of eq. 7 and 12, as written.
std::vector<double> brute_force(const ContactSet& set, double epsilon, double lever_floor, bool torques,
                                double lever_unit = 0) {
  std::vector<Vec3> T;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Vec3 lever = set.r[i].cross(set.N[i]);
    T.push_back(lever / (lever_unit > 0 ? lever_unit : std::max(lever.norm(), lever_floor)));
  }
  std::vector<double> w;
  for (std::size_t i = 0; i < set.size(); ++i) {
    double phi = 0;
    for (std::size_t j = 0; j < set.size(); ++j) {
      phi += hat(set.N[i], set.N[j], epsilon) + (torques ? hat(T[i], T[j], epsilon) : 0);
    }
    w.push_back((torques ? 2 : 1) / phi);
  }
  return w;
}

void expect_equal_to_brute_force(const ContactSet& set, double epsilon) {
  const Pointshell shell = set.shell();
  ContactBuffer b = set.buffer();
  Adaptive3Dof three(shell, epsilon);
  Adaptive6Dof six(shell, epsilon, 1e-3);
  const auto w3 = brute_force(set, epsilon, 1e-3, false), w6 = brute_force(set, epsilon, 1e-3, true);
  for (int again = 0; again < 2; ++again) {  // nothing of one query leaks into the next
    three.weigh(b);
    for (std::size_t i = 0; i < set.size(); ++i) ASSERT_NEAR(b.weight[i], w3[i], 1e-12 + 1e-10 * w3[i]) << i;
    six.weigh(b);
    for (std::size_t i = 0; i < set.size(); ++i) ASSERT_NEAR(b.weight[i], w6[i], 1e-12 + 1e-10 * w6[i]) << i;
  }
}

TEST(Adaptive, EqualsTheDoubleSumForScatteredNormals) {
  std::mt19937 rng(3);
  for (const double epsilon : {1e-4, 0.01, 0.3, 2.0})
    expect_equal_to_brute_force(test::random_contacts(rng, 400), epsilon);
}

TEST(Adaptive, EveryInstructionSetEqualsTheDoubleSum) {
  std::mt19937 rng(14);
  const ContactSet set = test::random_contacts(rng, 400, 5, 0.01);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    expect_equal_to_brute_force(set, 0.01);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(Adaptive, EqualsTheDoubleSumForClustersOfEverySpread) {
  std::mt19937 rng(4);
  for (const double spread : {0.0, 1e-9, 1e-4, 3e-3, 0.01, 0.05}) {
    expect_equal_to_brute_force(test::random_contacts(rng, 400, 5, spread), 0.01);
  }
}

TEST(Adaptive, EqualsTheDoubleSumOnAFlatFaceAndWithZeroTorque) {
  ContactSet set = test::flat_face(20, 20, 0.1, 1e-4);
  set.add(Vec3::Zero(), Vec3::UnitZ(), 1e-4);
  set.add(Vec3(0, 0, 0.02), Vec3::UnitZ(), 1e-4);
  set.add(Vec3(0, 0, -0.02), Vec3::UnitZ(), 1e-4);
  expect_equal_to_brute_force(set, 0.01);
}

TEST(Adaptive, EqualsTheDoubleSumWhereverTheLastBlockEnds) {
  std::mt19937 rng(15);
  for (const int n : {1, 2, 7, 8, 9, 63, 64, 65, 511, 512, 513, 4097}) {
    SCOPED_TRACE(n);
    expect_equal_to_brute_force(test::random_contacts(rng, n, 3, 0.02), 0.01);
  }
}

TEST(Adaptive, EqualsTheDoubleSumWhereSomeTorquesFadeOut) {
  std::mt19937 rng(16);
  for (const double lever_floor : {0.03, 0.2, 10.0}) {
    for (const ContactSet& set : {test::random_contacts(rng, 600), test::random_contacts(rng, 600, 4, 0.01)}) {
      Adaptive6Dof law(set.shell(), 0.1, lever_floor);
      ContactBuffer b = set.buffer();
      law.weigh(b);
      const auto expected = brute_force(set, 0.1, lever_floor, true);
      for (std::size_t i = 0; i < b.size; ++i) ASSERT_NEAR(b.weight[i], expected[i], 1e-10) << lever_floor;
    }
  }
}

TEST(Adaptive, ASubsetOfTheShellIsWeighedAsIfItWereTheShell) {
  std::mt19937 rng(5);
  const ContactSet all = test::random_contacts(rng, 500, 4, 0.004);
  Adaptive6Dof law(all.shell(), 0.01, 1e-3);
  for (int trial = 0; trial < 5; ++trial) {
    ContactSet part;
    ContactBuffer b(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (test::uniform(rng, 0, 1) < 0.8) continue;
      b.point_id[b.size++] = static_cast<std::uint32_t>(i);
      part.r.push_back(all.r[i]);
      part.N.push_back(all.N[i]);  // not add(): normalising again would round again
    }
    law.weigh(b);
    const auto expected = brute_force(part, 0.01, 1e-3, true);
    for (std::size_t i = 0; i < b.size; ++i) EXPECT_NEAR(b.weight[i], expected[i], 1e-10);
  }
}

TEST(Adaptive, TorqueDirectionsFadeOutContinuouslyAsTheLeverVanishes) {
  // Two contacts of equal normal whose levers shrink through zero in opposite directions: no jump anywhere.
  double before = -1;
  for (double lever = 4e-5; lever >= 0; lever -= 2e-7) {
    ContactSet set;
    set.add(Vec3(lever, 0, 0), Vec3::UnitZ(), 1e-4);
    set.add(Vec3(-lever, 0, 0), Vec3::UnitZ(), 1e-4);
    Adaptive6Dof law(set.shell(), 0.01, 1e-3);
    ContactBuffer b = set.buffer();
    law.weigh(b);
    EXPECT_GE(b.weight[0], 0.5 - 1e-12);
    EXPECT_LE(b.weight[0], 2.0 / 3 + 1e-12);
    if (before >= 0) {
      EXPECT_NEAR(b.weight[0], before, 0.02);
    }
    before = b.weight[0];
  }
  EXPECT_NEAR(before, 0.5, 1e-3);  // no torque at all: alike in both maps
}

/// With unit torque directions the two outer contacts would change weights, 0.4 and 0.5, as the lever of the one in the
/// middle changes sign. A lever that moves by d turns T by d / floor at most, hat is 2 / eps steep, and w = 2 / phi,
/// phi >= 2, changes by half of what phi does.
TEST(Adaptive, TheWrenchIsContinuousAsALeverPassesThroughZero) {
  const double epsilon = 0.5, floor_m = 1e-3, step_m = 1e-7, k = 1000, depth = 1e-3;
  Vec6 before = Vec6::Zero();
  for (int i = -20000; i <= 20000; ++i) {
    ContactSet set;
    for (const double lever : {i * step_m, 5e-3, -5e-3}) set.add(Vec3(lever, 0, 0.02), Vec3::UnitZ(), depth);
    Adaptive6Dof law(set.shell(), epsilon, floor_m);
    ContactBuffer b = set.buffer();
    law.weigh(b);
    for (std::size_t c = 0; c < b.size; ++c) ASSERT_TRUE(b.weight[c] > 0 && b.weight[c] <= 1);
    const Vec6 wrench = assemble(b, law, k, 0, {}).F.vector();
    const double turned = 1.01 * step_m / floor_m, weights = 0.5 * (2 / epsilon) * turned * 4;
    if (i > -20000) {
      ASSERT_LT((wrench - before).norm(), k * depth * (weights + step_m)) << i;
    }
    before = wrench;
  }
}

TEST(Adaptive, EqualsTheDoubleSumWithTorquesThatKeepTheirLevers) {
  std::mt19937 rng(6);
  for (const double lever_unit : {1e-3, 0.05, 1.0, 1e3}) {
    for (const ContactSet& set : {test::random_contacts(rng, 300), test::random_contacts(rng, 300, 3, 0.004)}) {
      Adaptive6Dof law(set.shell(), 0.1, 1e-3, lever_unit);
      ContactBuffer b = set.buffer();
      law.weigh(b);
      const auto expected = brute_force(set, 0.1, 1e-3, true, lever_unit);
      for (std::size_t i = 0; i < b.size; ++i) ASSERT_NEAR(b.weight[i], expected[i], 1e-10) << lever_unit;
    }
  }
}

/// [P] on eq. 13: with a short unit levers overshadow normals, so contacts of one face along a line stand alone on the
/// torque sphere; with a long one all torques are alike.
TEST(Adaptive, TheLeverUnitDecidesHowMuchTorquesTellApart) {
  ContactSet row;
  for (int i = 0; i < 100; ++i) row.add(Vec3(0.01 + 1e-3 * i, 0, 0), Vec3::UnitZ(), 1e-4);
  const auto total = [&](double lever_unit) {
    Adaptive6Dof law(row.shell(), 0.01, 1e-3, lever_unit);
    ContactBuffer b = row.buffer();
    law.weigh(b);
    double sum = 0;
    for (std::size_t i = 0; i < b.size; ++i) sum += b.weight[i];
    return sum;
  };
  EXPECT_NEAR(total(1e-3), 100 * 2.0 / 101, 1e-9);  // torques all apart, normals all alike
  EXPECT_NEAR(total(1e3), 1, 1e-4);                 // all alike in both
  EXPECT_NEAR(total(0), 1, 1e-9);                   // eq. 10: one direction of torque
}

TEST(Adaptive, EqualsTheDoubleSumForManyContacts) {
  std::mt19937 rng(7);
  expect_equal_to_brute_force(test::random_contacts(rng, 200), 0.01);
  expect_equal_to_brute_force(test::random_contacts(rng, 2000, 40, 0.01), 0.01);
  expect_equal_to_brute_force(test::random_contacts(rng, 10000), 0.01);
  ContactSet equal;
  for (int i = 0; i < 10000; ++i) equal.add(Vec3(1e-5 * i - 0.05, 0.01, 1e-6 * (i % 97)), Vec3(0.6, 0, 0.8), 1e-4);
  expect_equal_to_brute_force(equal, 0.01);
}

TEST(Adaptive, TenThousandEqualNormalsShareOneStiffness) {
  ContactSet set;
  for (int i = 0; i < 10000; ++i) set.add(Vec3(1e-5 * i, 0.01, 0), Vec3(0.6, 0, 0.8), 1e-4);
  Adaptive3Dof law(set.shell(), 0.01);
  ContactBuffer b = set.buffer();
  law.weigh(b);
  for (std::size_t i = 0; i < b.size; ++i) ASSERT_NEAR(b.weight[i], 1e-4, 1e-12);
}

}  // namespace
}  // namespace tact::contact
