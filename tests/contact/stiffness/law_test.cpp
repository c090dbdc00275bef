#include "contact/stiffness/law.hpp"

#include <gtest/gtest.h>

#include "contact/contact_set.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

using test::ContactSet;

/// Net stiffness over k along z, of the sums at fixed weights.
double net_z(const std::string& name, const LawParams& params, const ContactSet& set) {
  const auto law = make_law(name, params, set.shell(), set.size());
  ContactBuffer b = set.buffer();
  law->weigh(b);
  double net = 0;
  for (std::size_t i = 0; i < b.size; ++i) net += b.weight[i] * b.N[i].z() * b.N[i].z();
  return net;
}

TEST(Law, ALonelyContactKeepsItsWholeStiffnessUnderEveryLaw) {
  std::mt19937 rng(1);
  for (const std::string_view name : law_names()) {
    for (int trial = 0; trial < 20; ++trial) {
      const ContactSet set = test::random_contacts(rng, 1);
      ContactBuffer b = set.buffer();
      make_law(name, {}, set.shell(), 1)->weigh(b);
      EXPECT_NEAR(b.weight[0], 1.0, 1e-12) << name;
    }
  }
}

TEST(Law, AFlatFaceOfAThousandPointsNetsWhatTheTableSays) {
  // A tilted lattice would change nothing: only the equality of normals matters, and for 6-DoF the spread of torques.
  const ContactSet face = test::flat_face(40, 25, 0.1, 1e-4);
  ASSERT_EQ(face.size(), 1000u);
  LawParams p8, p16;
  p8.p = 8;
  p16.p = 16;
  EXPECT_NEAR(net_z("none", {}, face), 1000, 1e-9);
  EXPECT_NEAR(net_z("global", {}, face), 10, 1e-9);
  EXPECT_NEAR(net_z("adaptive-3dof", {}, face), 1, 1e-9);
  EXPECT_NEAR(net_z("adaptive-6dof", {}, face), 2, 0.05);
  EXPECT_NEAR(net_z("potential", p8, face), std::pow(1000, 2.0 / 8), 1e-9);
  EXPECT_NEAR(net_z("potential", p16, face), std::pow(1000, 2.0 / 16), 1e-9);
}

TEST(Law, GlobalScalesOnlyFromN0ContactsOnAndCountsDroppedOnes) {
  EXPECT_DOUBLE_EQ(net_z("global", {}, test::flat_face(3, 3, 0.1, 1e-4)), 9);
  EXPECT_DOUBLE_EQ(net_z("global", {}, test::flat_face(5, 4, 0.1, 1e-4)), 10);
  const ContactSet face = test::flat_face(5, 4, 0.1, 1e-4);
  ContactBuffer b = face.buffer();
  b.dropped = 20;
  make_law("global", {}, face.shell(), b.size)->weigh(b);
  EXPECT_DOUBLE_EQ(b.weight[0], 0.25);
}

TEST(Law, WeightsStayBetweenZeroAndOneUnderEveryLaw) {
  std::mt19937 rng(2);
  for (const std::string_view name : law_names()) {
    const ContactSet set = test::random_contacts(rng, 300, 7, 0.02);
    ContactBuffer b = set.buffer();
    make_law(name, {}, set.shell(), set.size())->weigh(b);
    for (std::size_t i = 0; i < b.size; ++i) {
      EXPECT_GE(b.weight[i], 0) << name;
      EXPECT_LE(b.weight[i], 1 + 1e-12) << name;
    }
  }
}

TEST(Law, NoContactsAreWeighedWithoutHarm) {
  const ContactSet face = test::flat_face(5, 4, 0.1, 1e-4);
  for (const std::string_view name : law_names()) {
    ContactBuffer b(4);
    const auto law = make_law(name, {}, face.shell(), 4);
    law->weigh(b);
    Mat6 ss = Mat6::Zero(), sh = Mat6::Zero();
    law->include_weight_derivative(ss, sh);
    EXPECT_EQ(ss.norm() + sh.norm(), 0) << name;
  }
}

TEST(Law, UnknownNamesAndImpossibleNumbersAreRefusedWithTheFieldNamed) {
  const Pointshell shell = test::flat_face(2, 2, 0.1, 1e-4).shell();
  const auto message = [&](std::string_view name, const LawParams& params) -> std::string {
    try {
      make_law(name, params, shell, 4);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("gravity", {}).find("contact.law: found \"gravity\""), std::string::npos);
  LawParams bad;
  bad.epsilon = 0;
  bad.p = 1;
  bad.n0 = 0;
  EXPECT_NE(message("adaptive-3dof", bad).find("contact.epsilon"), std::string::npos);
  EXPECT_NE(message("potential", bad).find("contact.p"), std::string::npos);
  EXPECT_NE(message("global", bad).find("contact.n0"), std::string::npos);
  EXPECT_EQ(message("none", bad), "");
  bad.p = 16;
  bad.q = 0;
  EXPECT_NE(message("potential", bad).find("contact.q"), std::string::npos);
  bad.epsilon = std::nan("");
  EXPECT_NE(message("adaptive-6dof", bad).find("contact.epsilon"), std::string::npos);
}

/// Two parallel walls, 1000 and 14 contacts, as [P] fig. 7: total weight of each.
std::pair<double, double> wall_weights(const std::string& name, const LawParams& params, double depth_many,
                                       double depth_few) {
  ContactSet set;
  for (int i = 0; i < 1000; ++i) set.add(Vec3(-0.1, -0.05 + 1e-4 * i, 0), Vec3::UnitZ(), depth_many);
  for (int i = 0; i < 14; ++i) set.add(Vec3(0.1, -0.05 + 0.1 / 13 * i, 0), Vec3::UnitZ(), depth_few);
  ContactBuffer b = set.buffer();
  make_law(name, params, set.shell(), set.size())->weigh(b);
  double many = 0, few = 0;
  for (std::size_t i = 0; i < b.size; ++i) (i < 1000 ? many : few) += b.weight[i];
  return {many, few};
}

TEST(Law, ThePapersLawsDoNotBalanceTwoWallsOfUnequalSampling) {
  const auto [many3, few3] = wall_weights("adaptive-3dof", {}, 1e-4, 1e-4);
  EXPECT_NEAR(many3 / few3, 1000.0 / 14, 1e-6);
  const auto [many6, few6] = wall_weights("adaptive-6dof", {}, 1e-4, 1e-4);
  EXPECT_GT(many6 / few6, 60);
  EXPECT_LT(many6 / few6, 75);
}

TEST(Law, PotentialCarriesEqualLoadOnTwoWallsAtNearlyEqualDepth) {
  // Equal load needs n_1 depth_1^(p-1) = n_2 depth_2^(p-1): 1000:14 contacts are 1.84 : 1 in depth at p = 8, 1.33
  // at 16.
  for (const auto& [p, expected] : {std::pair{8, 1.84}, std::pair{16, 1.33}}) {
    LawParams params;
    params.p = p;
    const double ratio = std::pow(1000.0 / 14, 1.0 / (p - 1));
    EXPECT_NEAR(ratio, expected, 0.01);
    const double depth = 1e-4;
    const auto [many, few] = wall_weights("potential", params, depth, depth * ratio);
    EXPECT_NEAR(many * depth / (few * depth * ratio), 1, 1e-9);
  }
}

TEST(Law, ARoundPegKeepsMostOfItsRadialStiffnessUnderTheHatOfThePaper) {
  // 64 directions x 20 points: eps = 0.01 separates the directions, so 32 k remain; potential nets 9.9 k and 4.4 k.
  ContactSet set;
  for (int a = 0; a < 64; ++a) {
    const double angle = 2 * std::numbers::pi * a / 64;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    for (int z = 0; z < 20; ++z) set.add(0.02 * out + Vec3(0, 0, 0.004 * (z - 9.5)), -out, 1e-4);
  }
  const auto net_x = [&](const std::string& name, int p) {
    LawParams params;
    params.p = p;
    ContactBuffer b = set.buffer();
    make_law(name, params, set.shell(), set.size())->weigh(b);
    double net = 0;
    for (std::size_t i = 0; i < b.size; ++i) net += b.weight[i] * b.N[i].x() * b.N[i].x();
    return net;
  };
  EXPECT_NEAR(net_x("none", 8), 640, 1e-3);
  EXPECT_NEAR(net_x("adaptive-3dof", 8), 32, 0.1);
  EXPECT_NEAR(net_x("potential", 8), 9.9, 0.2);
  EXPECT_NEAR(net_x("potential", 16), 4.4, 0.1);
}

}  // namespace
}  // namespace tact::contact
