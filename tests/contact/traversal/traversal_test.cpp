#include "contact/traversal/traversal.hpp"

#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <map>

#include "contact/hierarchy.hpp"
#include "field/field_builder.hpp"
#include "math/exp_log.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::contact {
namespace {

constexpr double kVoxel = 0.002;
const Vec3 kBox = Vec3::Constant(0.05);

double box_distance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}
DistanceField sphere_field() {
  return build_field(-kBox, kBox, kVoxel, [](const Vec3& p) { return p.norm() - 0.04; });
}
DistanceField box_field() {
  return build_field(-kBox, kBox, kVoxel, [](const Vec3& p) { return box_distance(p, Vec3(0.03, 0.04, 0.02)); });
}
/// Half a voxel thick.
DistanceField plate_field() {
  return build_field(-kBox, kBox, kVoxel, [](const Vec3& p) { return box_distance(p, Vec3(0.04, 0.04, 0.001)); });
}

Pose random_pose(std::mt19937& rng, double reach) {
  return {reach * std::pow(test::uniform(rng, 0, 1), 0.5) * test::random_unit(rng),
          exp_so3(3 * test::random_unit(rng))};
}

std::map<std::uint32_t, double> brute_force(const DistanceField& field, const Pointshell& shell, const Pose& X_OT) {
  std::map<std::uint32_t, double> out;
  const Mat3 R = X_OT.q.normalized().toRotationMatrix();
  for (std::uint32_t i = 0; i < shell.size(); ++i) {
    const double value = field.sample(test::placed(R, X_OT.p, shell.position_T[i])).value_m;
    if (value < 0) out[i] = -value;
  }
  return out;
}

TEST(Traversal, FindsExactlyWhatBruteForceFinds) {
  std::mt19937 rng(31);
  std::size_t touching = 0, visited = 0, all = 0;
  for (const DistanceField& field : {sphere_field(), box_field(), plate_field()}) {
    for (const bool round : {true, false}) {
      const auto shell = std::make_shared<const Pointshell>(round ? test::sphere_shell(rng, 2000, 0.02)
                                                                  : test::cube_shell(rng, 2000, 0.02));
      Traversal traversal(field, shell);
      ContactBuffer contacts(shell->size());
      for (int trial = 0; trial < 300; ++trial) {
        const Pose X_OT = random_pose(rng, 0.12);
        const Findings found = traversal.find(X_OT, contacts);
        const auto expected = brute_force(field, *shell, X_OT);
        ASSERT_EQ(contacts.size, expected.size());
        std::size_t k = 0;
        double deepest = 0;
        for (const auto& [id, depth] : expected) {
          ASSERT_EQ(contacts.point_id[k], id);
          ASSERT_EQ(contacts.depth_m[k], depth);
          deepest = std::max(deepest, depth);
          ++k;
        }
        ASSERT_EQ(found.max_depth_m, deepest);
        touching += !expected.empty();
        visited += found.nodes_visited;
        all += shell->size();
      }
    }
  }
  EXPECT_GT(touching, 200u);
  EXPECT_LT(visited, all / 2);  // it does skip
}

TEST(Traversal, EveryInstructionSetFindsTheSameContactsBitForBit) {
  std::mt19937 rng(40);
  const auto shell = std::make_shared<const Pointshell>(test::cube_shell(rng, 2000, 0.02));
  for (const DistanceField& field : {sphere_field(), box_field(), plate_field()}) {
    Traversal traversal(field, shell);
    ContactBuffer first(shell->size()), contacts(shell->size());
    for (int trial = 0; trial < 40; ++trial) {
      const Pose X_OT = random_pose(rng, 0.06);
      bool is_first = true;
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        traversal.find(X_OT, is_first ? first : contacts);
        if (std::exchange(is_first, false)) continue;
        ASSERT_EQ(contacts.size, first.size) << hwy::TargetName(target);
        for (std::size_t k = 0; k < first.size; ++k) {
          ASSERT_EQ(contacts.point_id[k], first.point_id[k]);
          ASSERT_EQ(contacts.depth_m[k], first.depth_m[k]);
          ASSERT_EQ(contacts.r[k], first.r[k]);
          ASSERT_EQ(contacts.N[k], first.N[k]);
          ASSERT_EQ(contacts.g[k], first.g[k]);
          ASSERT_EQ(contacts.flags[k], first.flags[k]);
        }
      }
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      ASSERT_EQ(first.size, brute_force(field, *shell, X_OT).size());
    }
  }
}

TEST(Traversal, NoPointIsNearerThanTheClearance) {
  std::mt19937 rng(32);
  const DistanceField field = sphere_field();
  const auto shell = std::make_shared<const Pointshell>(test::cube_shell(rng, 1500, 0.02));
  Traversal traversal(field, shell);
  ContactBuffer contacts(shell->size());
  std::size_t useful = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Pose X_OT = random_pose(rng, 0.3);
    const Findings found = traversal.find(X_OT, contacts);
    if (contacts.size > 0) {
      ASSERT_EQ(found.clearance_m, 0);
      continue;
    }
    double nearest = 1e9;
    for (const auto& p : shell->position_T) nearest = std::min(nearest, (X_OT * p.cast<double>()).norm() - 0.04);
    // Of the interpolated surface, which may lie a little outside the true one.
    ASSERT_LE(found.clearance_m, nearest + 0.01 * kVoxel);
    useful += found.clearance_m > 0.25 * nearest;

    // Moving by less than the clearance, any way, touches nothing.
    Pose moved = X_OT;
    moved.p += 0.999 * found.clearance_m * test::random_unit(rng);
    ASSERT_EQ(traversal.find(moved, contacts).max_depth_m, 0);
  }
  EXPECT_GT(useful, 100u);
}

/// Having been in contact saves the search for the clearance, and nothing else.
TEST(Traversal, WhatIsFoundDoesNotDependOnWhatWasFoundBefore) {
  std::mt19937 rng(39);
  const DistanceField field = sphere_field();
  const auto shell = std::make_shared<const Pointshell>(test::cube_shell(rng, 1500, 0.02));
  Traversal traversal(field, shell);
  ContactBuffer contacts(shell->size()), fresh_contacts(shell->size());
  std::size_t touching = 0, lost = 0;
  bool touched = false;
  for (int trial = 0; trial < 200; ++trial) {
    const Pose X_OT = random_pose(rng, 0.12);
    const Findings found = traversal.find(X_OT, contacts);
    const Findings fresh = Traversal(field, shell).find(X_OT, fresh_contacts);
    ASSERT_EQ(found.clearance_m, fresh.clearance_m);
    ASSERT_EQ(found.max_depth_m, fresh.max_depth_m);
    ASSERT_EQ(contacts.size, fresh_contacts.size);
    touching += contacts.size > 0;
    lost += touched && contacts.size == 0;
    touched = contacts.size > 0;
  }
  EXPECT_GT(touching, 20u);
  EXPECT_GT(lost, 10u);
}

TEST(Traversal, ReportsLeverNormalAndGradientInTheFieldsFrame) {
  std::mt19937 rng(33);
  const DistanceField field = sphere_field();
  const auto shell = std::make_shared<const Pointshell>(test::sphere_shell(rng, 500, 0.02));
  Traversal traversal(field, shell);
  ContactBuffer contacts(shell->size());
  const Pose X_OT{Vec3(0.035, 0.03, 0.025), exp_so3(Vec3(1, -2, 0.5))};
  traversal.find(X_OT, contacts);
  ASSERT_GT(contacts.size, 0u);
  for (std::size_t k = 0; k < contacts.size; ++k) {
    const auto i = contacts.point_id[k];
    EXPECT_LT((contacts.r[k] - X_OT.q * shell->position_T[i].cast<double>()).norm(), 1e-12);
    EXPECT_LT((contacts.N[k] - X_OT.q * shell->normal_T[i].cast<double>()).norm(), 1e-12);
    EXPECT_LT((contacts.g[k] - (X_OT.p + contacts.r[k]).normalized()).norm(), 0.1);
    EXPECT_EQ(contacts.flags[k], 0u);
  }
}

TEST(Traversal, BeyondCapacityTheDeepestAreKeptAndTheOthersCounted) {
  std::mt19937 rng(34);
  const DistanceField field = box_field();
  const auto shell = std::make_shared<const Pointshell>(test::cube_shell(rng, 3000, 0.02));
  Traversal traversal(field, shell);
  ContactBuffer whole(shell->size()), few(40);
  const Pose X_OT{Vec3(0.045, 0.01, 0), exp_so3(Vec3(0.1, 0.2, 0.3))};
  const Findings all = traversal.find(X_OT, whole);
  const Findings some = traversal.find(X_OT, few);
  ASSERT_GT(whole.size, 100u);
  EXPECT_EQ(all.status & bit(Status::overflow), 0u);
  EXPECT_NE(some.status & bit(Status::overflow), 0u);
  EXPECT_EQ(few.size, 40u);
  EXPECT_EQ(few.dropped, whole.size - 40);
  EXPECT_EQ(some.max_depth_m, all.max_depth_m);
  std::vector<double> depths(whole.depth_m.begin(), whole.depth_m.begin() + static_cast<std::ptrdiff_t>(whole.size));
  std::sort(depths.rbegin(), depths.rend());
  for (std::size_t k = 0; k < few.size; ++k) {
    EXPECT_GE(few.depth_m[k], depths[39]);
    if (k > 0) {
      EXPECT_LT(few.point_id[k - 1], few.point_id[k]);
    }
  }
  const auto first = few.point_id;
  traversal.find(X_OT, few);
  EXPECT_EQ(first, few.point_id);
}

TEST(Traversal, DepthBeyondTheBandIsFlagged) {
  std::mt19937 rng(35);
  const DistanceField field = sphere_field();
  const auto shell = std::make_shared<const Pointshell>(test::sphere_shell(rng, 200, 0.005));
  Traversal traversal(field, shell);
  ContactBuffer contacts(shell->size());
  const Findings found = traversal.find({}, contacts);  // in the middle of the body
  EXPECT_EQ(contacts.size, 200u);
  EXPECT_NE(found.status & bit(Status::beyond_band), 0u);
  EXPECT_DOUBLE_EQ(found.max_depth_m, field.band_m());
  for (std::size_t k = 0; k < contacts.size; ++k) EXPECT_EQ(contacts.g[k].norm(), 0);
}

TEST(Traversal, PointsThatTheFieldPushesTheWrongWayAreFlagged) {
  // A flat face pushed through a plate beyond its middle: the plate now pushes the points out on the far side.
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 100; ++i) {
    points.emplace_back(0.001 * (i % 10), 0.001 * (i / 10), 0);
    normals.push_back(Vec3::UnitZ());
  }
  const auto shell = std::make_shared<const Pointshell>(test::make_hierarchy(points, normals, 4, 4));
  Traversal traversal(plate_field(), shell);
  ContactBuffer contacts(shell->size());
  const Findings before = traversal.find({Vec3(0.0003, 0.0003, 0.0006), Quat::Identity()}, contacts);
  EXPECT_EQ(contacts.size, 100u);
  EXPECT_EQ(before.status & bit(Status::past_mid_surface), 0u);
  const Findings after = traversal.find({Vec3(0.0003, 0.0003, -0.0006), Quat::Identity()}, contacts);
  EXPECT_EQ(contacts.size, 100u);
  EXPECT_NE(after.status & bit(Status::past_mid_surface), 0u);
}

TEST(Traversal, APoseThatIsNotRigidYieldsNoContacts) {
  std::mt19937 rng(36);
  const auto shell = std::make_shared<const Pointshell>(test::sphere_shell(rng, 100, 0.005));
  Traversal traversal(sphere_field(), shell);
  ContactBuffer contacts(shell->size());
  const double nan = std::nan(""), infinity = HUGE_VAL;
  for (const Pose& X : {Pose{Vec3(nan, 0, 0), Quat::Identity()}, Pose{Vec3(0, infinity, 0), Quat::Identity()},
                        Pose{Vec3::Zero(), Quat(0, 0, 0, 0)}, Pose{Vec3::Zero(), Quat(2, 0, 0, 0)},
                        Pose{Vec3::Zero(), Quat(nan, 0, 0, 0)}}) {
    const Findings found = traversal.find(X, contacts);
    EXPECT_EQ(contacts.size, 0u);
    EXPECT_EQ(found.clearance_m, 0);
    EXPECT_EQ(found.status, bit(Status::pose_invalid));
  }
  EXPECT_GT(traversal.find({}, contacts).max_depth_m, 0);  // and goes on
}

TEST(Traversal, FarAwayPosesAreAnsweredFromAFewNodes) {
  std::mt19937 rng(37);
  const auto shell = std::make_shared<const Pointshell>(test::sphere_shell(rng, 2000, 0.02));
  Traversal traversal(sphere_field(), shell);
  ContactBuffer contacts(shell->size());
  for (const double away : {0.5, 1e3, 1e9}) {
    const Findings found = traversal.find({Vec3(away, 0, 0), Quat::Identity()}, contacts);
    EXPECT_LE(found.nodes_visited, 70u);
    EXPECT_GT(found.clearance_m, 0.8 * away - 0.1);
    EXPECT_LE(found.clearance_m, away - 0.06 + 1e-6 * away);
  }
}

TEST(Traversal, NeverAllocates) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "allocation hooks are off in sanitizer builds";
  std::mt19937 rng(38);
  const auto shell = std::make_shared<const Pointshell>(test::cube_shell(rng, 2000, 0.02));
  Traversal traversal(sphere_field(), shell);
  ContactBuffer contacts(50);
  const auto before = rt::rt_allocations();
  for (int trial = 0; trial < 100; ++trial) {
    const Pose X_OT = random_pose(rng, 0.08);
    const rt::RtSection section;
    traversal.find(X_OT, contacts);
  }
  EXPECT_EQ(rt::rt_allocations(), before);
}

}  // namespace
}  // namespace tact::contact
