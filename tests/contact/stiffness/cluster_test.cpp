#include "contact/stiffness/cluster.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <set>

#include "contact/contact_set.hpp"
#include "contact/frozen_contacts.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

using test::ContactSet;
constexpr double kRadius = 2e-3;

LawParams params(const std::string& weigher) {
  LawParams p;
  p.cluster_radius_m = kRadius;
  p.cluster_law = weigher;
  p.epsilon = 0.2;  // so that the adaptive laws have something to weigh
  return p;
}

std::vector<std::string> weighers() {
  std::vector<std::string> out;
  for (const std::string_view name : law_names()) {
    if (name != "cluster") out.emplace_back(name);
  }
  return out;
}

/// Points on a slab of 2 cm, so that groups of one to some ten form.
ContactSet crowd(std::mt19937& rng, int n) {
  ContactSet set;
  for (int i = 0; i < n; ++i) {
    const Vec3 p(test::uniform(rng, -0.01, 0.01), test::uniform(rng, -0.01, 0.01), test::uniform(rng, 0.02, 0.021));
    const Vec3 N = Vec3::UnitZ() + 0.5 * test::random_unit(rng);
    set.add(p, N, test::uniform(rng, 1e-5, 1e-3), N.normalized() + 0.2 * test::random_unit(rng));
  }
  return set;
}

/// Groups as the header defines them, by comparing every point with every other until nothing changes.
std::vector<std::set<std::size_t>> groups_by_definition(const ContactSet& set) {
  std::vector<std::set<std::size_t>> groups;
  for (std::size_t i = 0; i < set.size(); ++i) groups.push_back({i});
  const auto touch = [&](const auto& a, const auto& b) {
    for (const std::size_t i : a) {
      for (const std::size_t j : b) {
        if ((set.r[i] - set.r[j]).norm() < kRadius) return true;
      }
    }
    return false;
  };
  for (std::size_t a = 0; a < groups.size(); ++a) {
    for (std::size_t b = a + 1; b < groups.size();) {
      if (touch(groups[a], groups[b])) {
        groups[a].insert(groups[b].begin(), groups[b].end());
        groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(b));
        b = a + 1;  // what was passed over may be near now
      } else {
        ++b;
      }
    }
  }
  return groups;
}

TEST(Cluster, EqualsItsDefinition) {
  std::mt19937 rng(71);
  for (const int n : {1, 2, 20, 60, 150}) {
    const ContactSet set = crowd(rng, n);
    const auto groups = groups_by_definition(set);
    for (const std::string& weigher : weighers()) {
      const auto law = make_law("cluster", params(weigher), set.shell(), set.size());
      ContactBuffer expected(set.size());
      for (const auto& group : groups) {
        double sum = 0;
        for (const std::size_t i : group) sum += set.depth_m[i];
        const std::size_t c = expected.size++;
        expected.point_id[c] = static_cast<std::uint32_t>(*group.begin());
        expected.r[c] = expected.N[c] = expected.g[c] = Vec3::Zero();
        for (const std::size_t i : group) {
          const double share = set.depth_m[i] / sum;
          expected.r[c] += share * set.r[i];
          expected.N[c] += share * set.N[i];
          expected.g[c] += share * set.g[i];
          expected.depth_m[c] += share * set.depth_m[i];
        }
      }
      make_law(weigher, params(weigher), set.shell(), set.size())->weigh(expected);
      for (int again = 0; again < 2; ++again) {  // nothing of one query leaks into the next
        ContactBuffer b = set.buffer();
        law->weigh(b);
        ASSERT_EQ(b.size, groups.size()) << weigher;
        for (std::size_t c = 0; c < b.size; ++c) {
          ASSERT_EQ(b.point_id[c], expected.point_id[c]);
          EXPECT_LT((b.r[c] - expected.r[c]).norm(), 1e-15);
          EXPECT_LT((b.N[c] - expected.N[c]).norm(), 1e-14);
          EXPECT_LT((b.g[c] - expected.g[c]).norm(), 1e-14);
          EXPECT_NEAR(b.depth_m[c], expected.depth_m[c], 1e-17);
          EXPECT_NEAR(b.weight[c], expected.weight[c], 1e-12) << weigher;
        }
      }
    }
    if (n == 60) {  // neither all alone nor all one
      EXPECT_GT(groups.size(), 5u);
      EXPECT_LT(groups.size(), 55u);
    }
  }
}

TEST(Cluster, LeavesContactsFarFromEachOtherAsTheyAre) {
  std::mt19937 rng(72);
  const ContactSet set = test::random_contacts(rng, 40);
  ASSERT_EQ(groups_by_definition(set).size(), set.size());
  ContactBuffer b = set.buffer(), plain = set.buffer();
  make_law("cluster", params("potential"), set.shell(), set.size())->weigh(b);
  make_law("potential", params("potential"), set.shell(), set.size())->weigh(plain);
  ASSERT_EQ(b.size, set.size());
  for (std::size_t i = 0; i < b.size; ++i) {
    EXPECT_EQ(b.r[i], plain.r[i]);
    EXPECT_EQ(b.N[i], plain.N[i]);
    EXPECT_EQ(b.g[i], plain.g[i]);
    EXPECT_EQ(b.depth_m[i], plain.depth_m[i]);
    EXPECT_EQ(b.weight[i], plain.weight[i]);
  }
}

TEST(Cluster, OnlyPointsInContactJoinAGroup) {
  ContactSet row;  // the middle one is the link between the outer ones
  for (int i = 0; i < 3; ++i) row.add(Vec3(0.8 * kRadius * i, 0, 0.02), Vec3::UnitZ(), 1e-4);
  const auto law = make_law("cluster", params("none"), row.shell(), 3);
  ContactBuffer all = row.buffer();
  all.flags[2] = bit(Status::sign_doubtful);
  law->weigh(all);
  ASSERT_EQ(all.size, 1u);
  EXPECT_EQ(all.flags[0], bit(Status::sign_doubtful));
  ContactBuffer outer = row.buffer();
  outer.size = 2;
  outer.point_id[1] = 2;
  outer.r[1] = row.r[2];
  law->weigh(outer);
  EXPECT_EQ(outer.size, 2u);
}

/// Contacts that come in touch have no depth, and a share in proportion to it: nothing jumps when they join a group.
TEST(Cluster, AContactJoinsAGroupWithoutAStep) {
  std::mt19937 rng(73);
  const ContactSet set = crowd(rng, 30);
  for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
    const auto law = make_law("cluster", params("none"), set.shell(), set.size());
    const auto wrench = [&](bool with_first, double depth) {
      ContactBuffer b = set.buffer();
      b.force_along = along;
      b.depth_m[0] = depth;
      if (!with_first) {
        for (std::size_t i = 1; i < set.size(); ++i) {
          b.point_id[i - 1] = b.point_id[i];
          b.r[i - 1] = b.r[i], b.N[i - 1] = b.N[i], b.g[i - 1] = b.g[i], b.depth_m[i - 1] = b.depth_m[i];
        }
        --b.size;
      }
      law->weigh(b);
      return assemble(b, *law, 1000, 0, {}).F.vector();
    };
    const Vec6 without = wrench(false, 0);
    EXPECT_LT((wrench(true, 1e-12) - without).norm(), 1e-6 * without.norm());
  }
}

/// Shares follow the depths: G says so, K stays positive semidefinite.
TEST(Cluster, GIsTheDerivativeOfTheWrenchAndKPositiveSemidefinite) {
  std::mt19937 rng(74);
  const ContactSet set = crowd(rng, 120);
  const Vec3 p_To(0.01, 0.02, 0.03);
  // Linear about every point, the value there its depth: a field of which only gradients are known.
  for (const std::string& weigher : weighers()) {
    const auto law = make_law("cluster", params(weigher), set.shell(), set.size());
    for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
      ContactBuffer base = set.buffer();
      base.force_along = along;
      std::size_t next = 0;
      const auto depth = [&](const Vec3& p) {
        const std::size_t i = next++ % set.size();
        return set.depth_m[i] - set.g[i].dot(p - p_To - set.r[i]);
      };
      const Mat6 numeric = test::derivative_of_wrench(*law, base, p_To, 1000, 1e-9, depth);
      ContactBuffer here = base;
      law->weigh(here);
      ASSERT_LT(here.size, set.size() / 2);
      const Response response = assemble(here, *law, 1000, 0, {});
      const double off = test::difference(response.G, numeric, 0.02);
      // How the potential's weights follow the depths of groups, and those the shares, is not multiplied out.
      EXPECT_LT(off, weigher == "potential" ? 0.3 : 1e-5) << weigher;
      EXPECT_EQ((response.K - response.K.transpose()).norm(), 0);
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(response.K).eigenvalues().minCoeff(), -1e-11 * response.K.norm());
    }
  }
}

TEST(Cluster, WhatCannotWeighOrIsNoDistanceIsRefusedWithTheKeyNamed) {
  const ContactSet face = test::flat_face(5, 4, 0.1, 1e-4);
  const auto message = [&](auto change) -> std::string {
    LawParams p = params("none");
    change(p);
    try {
      make_law("cluster", p, face.shell(), 20);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message([](LawParams&) {}), "");
  EXPECT_NE(message([](LawParams& p) { p.cluster_law = "cluster"; }).find("contact.cluster_law"), std::string::npos);
  EXPECT_NE(message([](LawParams& p) { p.cluster_law = "magic"; }).find("magic"), std::string::npos);
  EXPECT_NE(message([](LawParams& p) { p.cluster_radius_m = 0; }).find("contact.cluster_voxels"), std::string::npos);
}

}  // namespace
}  // namespace tact::contact
