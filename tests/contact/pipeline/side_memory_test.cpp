#include "contact/pipeline/side_memory.hpp"

#include <gtest/gtest.h>

#include "contact/hierarchy.hpp"
#include "contact/pipeline/contact_pipeline.hpp"
#include "field/field_builder.hpp"
#include "math/exp_log.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::contact {
namespace {

constexpr double kVoxel = 1e-3;

/// Lies askew in its grid, so that nothing is due to the lattice.
const Quat kAskew = exp_so3(Vec3(0.3, 0.2, 0.5));

DistanceField askew(const std::function<double(const Vec3&)>& distance_m) {
  const Vec3 box = Vec3::Constant(0.02);
  return build_field(-box, box, kVoxel, [&](const Vec3& p) { return distance_m(kAskew.conjugate() * p); });
}
DistanceField plate(double thickness_m) {
  return askew([=](const Vec3& p) { return std::fabs(p.z()) - 0.5 * thickness_m; });
}
DistanceField wire(double thickness_m) {
  return askew([=](const Vec3& p) { return std::hypot(p.x(), p.z()) - 0.5 * thickness_m; });
}

/// A square of 8 mm, facing down.
std::shared_ptr<const Pointshell> face() {
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 144; ++i) {
    points.emplace_back(7e-4 * (i % 12) - 3.9e-3, 7e-4 * (i / 12) - 3.8e-3, 0);
    normals.push_back(Vec3::UnitZ());
  }
  return std::make_shared<const Pointshell>(test::make_hierarchy(points, normals, 4, 4));
}

ContactPipeline pipeline(const DistanceField& field, const std::string& force_along,
                         const std::string& law = "potential") {
  ContactSpec spec;
  spec.law = law;
  spec.stiffness_n_per_m = 1e4;
  spec.force_along = force_along;
  return {field, face(), 1000, pipeline_params(spec, kVoxel, 0.2, 1)};
}

/// Shifted and turned in the plate's frame.
ToolQuery at(const Vec3& p, const Vec3& turn = Vec3::Zero()) {
  ToolQuery query;
  query.X_WT = {kAskew * p, kAskew * exp_so3(turn)};
  return query;
}

double force_up(const ContactResult& result) { return (kAskew.conjugate() * result.response_W.F.force).z(); }

/// The largest force up on the way down from above to below, in k voxels, and the height it is met at.
std::pair<double, double> strongest_hold(ContactPipeline& pipeline) {
  std::pair<double, double> best{0, 0};
  for (double z = 3e-3; z > -3e-3; z -= 1e-5) {
    const double force = force_up(pipeline.step(at(Vec3(1e-4, 2e-4, z)))) / (1e4 * kVoxel);
    if (force > best.first) best = {force, z};
  }
  return best;
}

TEST(SideMemory, AWallTwoVoxelsThickHoldsToItsFarSideAndBearsTwiceTheLoad) {
  for (const char* law : {"potential", "adaptive-6dof", "none"}) {
    ContactPipeline plain = pipeline(plate(2 * kVoxel), "gradient", law);
    ContactPipeline held = pipeline(plate(2 * kVoxel), "held", law);
    const auto [plain_force, plain_z] = strongest_hold(plain);
    const auto [held_force, held_z] = strongest_hold(held);
    EXPECT_GT(held_force, 1.9 * plain_force) << law;
    EXPECT_LT(held_z, -0.8 * kVoxel) << law;
    EXPECT_GT(plain_z, -0.2 * kVoxel) << law;
  }
}

TEST(SideMemory, AWireTwoVoxelsThickHoldsLonger) {
  ContactPipeline plain = pipeline(wire(2 * kVoxel), "gradient"), held = pipeline(wire(2 * kVoxel), "held");
  const auto [plain_force, plain_z] = strongest_hold(plain);
  const auto [held_force, held_z] = strongest_hold(held);
  EXPECT_GT(held_force, 1.5 * plain_force);
  EXPECT_LT(held_z, plain_z);
}

/// Nothing is gained on the way there and back, also beyond the middle, aside and turning, and when points leave on the
/// far side.
TEST(SideMemory, NoEnergyIsGainedRoundAnyClosedPath) {
  for (const DistanceField& field : {plate(2 * kVoxel), wire(2 * kVoxel), plate(5 * kVoxel)}) {
    ContactPipeline held = pipeline(field, "held");
    for (int path = 0; path < 12; ++path) {
      const double deep = 5e-4 + 2e-4 * path, aside = 1e-3 * (path % 3), turn = 0.03 * (path % 4);
      double work = 0, absolute = 0;
      const int steps = 3000;
      Pose last;
      for (int i = 0; i <= steps; ++i) {
        const double a = 2 * std::numbers::pi * i / steps;
        const Vec3 p(aside * std::sin(a), 1e-4 + aside * std::sin(2 * a),
                     3e-3 - (2e-3 + deep) * 0.5 * (1 - std::cos(a)));
        const Pose here = at(p, Vec3(turn * std::sin(a), turn * std::sin(3 * a), 0)).X_WT;
        if (i > 0) {
          const Vec6 dx = displacement(last, here);
          ToolQuery middle;
          middle.X_WT = displaced(last, 0.5 * dx);
          const double done = held.step(middle).response_W.F.vector().dot(dx);
          work += done;
          absolute += std::fabs(done);
        }
        last = here;
      }
      EXPECT_LE(work, 2e-3 * absolute) << path;
    }
  }
}

TEST(SideMemory, AThickBodyIsNoDifferentFromTheGradient) {
  const DistanceField ball =
      build_field(Vec3::Constant(-0.02), Vec3::Constant(0.02), kVoxel, [](const Vec3& p) { return p.norm() - 0.018; });
  ContactPipeline plain = pipeline(ball, "gradient"), held = pipeline(ball, "held");
  std::mt19937 rng(111);
  Pose X{Vec3(0, 0, 0.0172), Quat::Identity()};
  std::size_t contacts = 0;
  for (int step = 0; step < 3000; ++step) {
    Vec6 by;
    by << 1e-4 * test::random_unit(rng), 0.01 * test::random_unit(rng);
    const Pose next = displaced(X, by);
    if (next.p.norm() < 0.0165 || next.p.norm() > 0.0185 || log_so3(next.q).norm() > 0.3 || next.p.z() < 0.016)
      continue;
    X = next;
    ToolQuery query;
    query.X_WT = X;
    const Wrench F = plain.step(query).response_W.F, H = held.step(query).response_W.F;
    ASSERT_EQ(F.force, H.force) << step;
    contacts += plain.contacts().size;
  }
  EXPECT_GT(contacts, 1000u);
}

TEST(SideMemory, WhatHasLeftIsForgotten) {
  ContactPipeline held = pipeline(plate(2 * kVoxel), "held");
  for (double z = 3e-3; z > -0.5e-3; z -= 1e-5) held.step(at(Vec3(1e-4, 2e-4, z)));
  EXPECT_GT(force_up(held.step(at(Vec3(1e-4, 2e-4, -0.5e-3)))), 0);
  EXPECT_GT(held.step(at(Vec3(1e-4, 2e-4, -0.5e-3))).max_depth_m, 1.3e-3);  // the depth that is held
  held.step(at(Vec3(0, 0, 0.01)));
  EXPECT_LT(force_up(held.step(at(Vec3(1e-4, 2e-4, -0.5e-3)))), 0);  // came from nowhere: the near side is below
}

TEST(SideMemory, NeverAllocates) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "allocation hooks are off in sanitizer builds";
  ContactPipeline held = pipeline(plate(2 * kVoxel), "held");
  const auto before = rt::rt_allocations();
  for (double z = 3e-3; z > -3e-3; z -= 1e-4) {
    const rt::RtSection section;
    held.step(at(Vec3(1e-4, 2e-4, z)));
  }
  EXPECT_EQ(rt::rt_allocations(), before);
}

}  // namespace
}  // namespace tact::contact
