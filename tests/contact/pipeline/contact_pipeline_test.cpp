#include "contact/pipeline/contact_pipeline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <thread>

#include "contact/hierarchy.hpp"
#include "fault/fault.hpp"
#include "field/field_builder.hpp"
#include "math/exp_log.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::contact {
namespace {

constexpr double kVoxel = 0.002;
const Vec3 kBox = Vec3::Constant(0.05);

DistanceField sphere_field() {
  return build_field(-kBox, kBox, kVoxel, [](const Vec3& p) { return p.norm() - 0.04; });
}
std::shared_ptr<const Pointshell> shell(std::size_t n = 800) {
  std::mt19937 rng(41);
  return std::make_shared<const Pointshell>(test::sphere_shell(rng, n, 0.02));
}
PipelineParams params(const std::string& law, std::uint64_t version = 1, const std::string& force_along = "gradient") {
  ContactSpec spec;
  spec.law = law;
  spec.force_along = force_along;
  return pipeline_params(spec, kVoxel, 0.2, version);
}
/// The tool 1 mm deep in the field body, both anywhere in the world.
ToolQuery touching(std::mt19937& rng) {
  ToolQuery q;
  q.X_WO = {0.3 * test::random_unit(rng), exp_so3(3 * test::random_unit(rng))};
  q.X_WT = q.X_WO * Pose{0.059 * test::random_unit(rng), exp_so3(3 * test::random_unit(rng))};
  return q;
}

TEST(ContactPipeline, PushesTheToolAwayFromTheBodyUnderEveryLaw) {
  std::mt19937 rng(42);
  for (const std::string_view law : law_names()) {
    ContactPipeline pipeline(sphere_field(), shell(), 4096, params(std::string(law), 1, "normal"));
    for (int trial = 0; trial < 10; ++trial) {
      const ToolQuery q = touching(rng);
      const ContactResult& r = pipeline.step(q);
      ASSERT_GT(r.contact_count, 0u);
      EXPECT_EQ(r.contact_count, pipeline.contacts().size);
      EXPECT_GT(r.response_W.F.force.dot((q.X_WT.p - q.X_WO.p).normalized()), 0.9 * r.response_W.F.force.norm());
      EXPECT_LT(r.response_W.F.torque.norm(), 0.02 * 0.02 * r.response_W.F.force.norm());  // normals through To
      EXPECT_EQ(r.clearance_m, 0);
      EXPECT_GT(r.max_depth_m, 0.0005);
      EXPECT_LT(r.max_depth_m, 0.0012);
      EXPECT_EQ(r.status, 0u);
    }
  }
}

TEST(ContactPipeline, AlongTheGradientItPushesTheSameWayToTheGridsError) {
  std::mt19937 rng(42);
  ContactPipeline along_g(sphere_field(), shell(), 4096, params("potential"));
  ContactPipeline along_N(sphere_field(), shell(), 4096, params("potential", 1, "normal"));
  for (int trial = 0; trial < 10; ++trial) {
    const ToolQuery q = touching(rng);
    const Wrench a = along_g.step(q).response_W.F, b = along_N.step(q).response_W.F;
    EXPECT_LT((a.force - b.force).norm(), 0.15 * b.force.norm());
    EXPECT_LT(a.torque.norm(), 0.2 * 0.02 * a.force.norm());
  }
}

/// On the real interpolated field, at poses where no point changes its cell or its contact within the step.
/// Along the gradient G leaves out how the interpolated gradient turns within a cell.
class DerivativeInTheWorld : public ::testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(DerivativeInTheWorld, IsG) {
  const auto& [force_along, tolerance] = GetParam();
  std::mt19937 rng(43);
  for (const std::string_view law : law_names()) {
    ContactPipeline pipeline(sphere_field(), shell(300), 4096, params(std::string(law), 1, force_along));
    int checked = 0;
    for (int trial = 0; trial < 200 && checked < 10; ++trial) {
      const ToolQuery q = touching(rng);
      const ContactResult base = pipeline.step(q);
      const std::vector<Vec3> gradient = pipeline.contacts().g;
      const double step = 1e-8;
      bool smooth = base.contact_count > 0;
      Mat6 numeric;
      for (int c = 0; c < 6 && smooth; ++c) {
        Vec6 side[2];
        for (const int s : {0, 1}) {
          ToolQuery moved = q;
          moved.X_WT = displaced(q.X_WT, (s == 0 ? step : -step) * Vec6::Unit(c));
          const ContactResult& r = pipeline.step(moved);
          smooth = smooth && r.contact_count == base.contact_count;
          for (std::size_t i = 0; i < r.contact_count && smooth; ++i) {
            smooth = (pipeline.contacts().g[i] - gradient[i]).norm() < 1e-4;  // a cell face is a jump of g
          }
          side[s] = r.response_W.F.vector();
        }
        numeric.col(c) = (side[0] - side[1]) / (2 * step);
      }
      if (!smooth) continue;
      ++checked;
      EXPECT_LT((base.response_W.G - numeric).norm(), tolerance * base.response_W.G.norm()) << law;
    }
    EXPECT_EQ(checked, 10) << law;
  }
}

INSTANTIATE_TEST_SUITE_P(ContactPipeline, DerivativeInTheWorld,
                         ::testing::Values(std::pair{"normal", 1e-4}, std::pair{"gradient", 0.04}),
                         [](const auto& each) { return std::string(each.param.first); });

TEST(ContactPipeline, KAndBArePositiveSemidefinite) {
  std::mt19937 rng(44);
  PipelineParams p = params("potential");
  p.damping_n_s_per_m = 20;
  ContactPipeline pipeline(sphere_field(), shell(), 4096, p);
  for (int trial = 0; trial < 20; ++trial) {
    ToolQuery q = touching(rng);
    q.V_WT = Twist::from(0.01 * Vec6::Random());
    const Response& r = pipeline.step(q).response_W;
    for (const Mat6& M : {r.K, r.B}) {
      EXPECT_EQ((M - M.transpose()).norm(), 0);
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(M).eigenvalues().minCoeff(), -1e-10 * M.norm());
    }
  }
}

TEST(ContactPipeline, OnlyTheMotionRelativeToTheBodyIsDamped) {
  std::mt19937 rng(45);
  PipelineParams p = params("none");
  p.damping_n_s_per_m = 1;
  ContactPipeline pipeline(sphere_field(), shell(), 4096, p);
  ToolQuery q = touching(rng);
  const Vec6 still = pipeline.step(q).response_W.F.vector();
  q.V_WO = {Vec3(0.1, -0.2, 0.3), Vec3(1, 2, -3)};  // both carried along as one rigid body
  q.V_WT = {q.V_WO.linear + q.V_WO.angular.cross(q.X_WT.p - q.X_WO.p), q.V_WO.angular};
  EXPECT_LT((pipeline.step(q).response_W.F.vector() - still).norm(), 1e-9 * still.norm());
  q.V_WT.linear += 1e-3 * still.head<3>().normalized();  // leaving
  const Vec6 leaving = pipeline.step(q).response_W.F.vector();
  EXPECT_LT(leaving.head<3>().norm(), still.head<3>().norm());
}

TEST(ContactPipeline, NothingButPosesAndTwistsThatAreRealIsAnswered) {
  std::mt19937 rng(46);
  ContactPipeline pipeline(sphere_field(), shell(), 4096, params("potential"));
  const ToolQuery good = touching(rng);
  const double nan = std::nan("");
  std::vector<ToolQuery> bad(5, good);
  bad[0].X_WT.p.x() = nan;
  bad[1].X_WO.q = Quat(0, 0, 0, 0);
  bad[2].V_WT.linear.x() = HUGE_VAL;
  bad[3].V_WO.angular.z() = nan;
  bad[4].X_WO.p.z() = -HUGE_VAL;
  for (const ToolQuery& q : bad) {
    pipeline.step(good);
    const ContactResult& r = pipeline.step(q);
    EXPECT_EQ(r.status, bit(Status::pose_invalid));
    EXPECT_EQ(r.contact_count + pipeline.contacts().size, 0u);
    EXPECT_EQ(r.response_W.F.vector().norm() + r.response_W.G.norm() + r.response_W.K.norm(), 0);
    EXPECT_EQ(r.clearance_m, 0);
  }
  EXPECT_GT(pipeline.step(good).contact_count, 0u);
}

TEST(ContactPipeline, ParametersChangeBetweenStepsAndAreEchoed) {
  std::mt19937 rng(47);
  ContactPipeline pipeline(sphere_field(), shell(), 4096, params("none", 1));
  const ToolQuery q = touching(rng);
  const double force = pipeline.step(q).response_W.F.force.norm();
  EXPECT_EQ(pipeline.step(q).params_version, 1u);

  PipelineParams stiffer = params("none", 2);
  stiffer.stiffness_n_per_m *= 3;
  pipeline.set_params(stiffer);
  const ContactResult& r = pipeline.step(q);
  EXPECT_EQ(r.params_version, 2u);
  EXPECT_NEAR(r.response_W.F.force.norm(), 3 * force, 1e-9 * force);
  EXPECT_EQ(r.stiffness_n_per_m, stiffer.stiffness_n_per_m);
  EXPECT_EQ(r.x_max_m, stiffer.x_max_m);

  PipelineParams unknown = params("none", 3);
  unknown.law = "gravity";
  EXPECT_THROW(pipeline.set_params(unknown), SetupError);
  EXPECT_EQ(pipeline.step(q).params_version, 2u);  // the old ones stay in force

  pipeline.set_params(params("global", 4));
  EXPECT_EQ(pipeline.step(q).params_version, 4u);
  EXPECT_LT(pipeline.step(q).response_W.F.force.norm(), force);
}

TEST(ContactPipeline, LawsAreSwitchedWhileAnotherThreadSteps) {
  std::mt19937 rng(48);
  ContactPipeline pipeline(sphere_field(), shell(200), 4096, params("none", 1));
  const ToolQuery q = touching(rng);
  std::atomic<bool> done{false};
  std::thread stepping([&] {
    std::uint64_t last = 0;
    while (!done) {
      const ContactResult& r = pipeline.step(q);
      EXPECT_GE(r.params_version, last);
      EXPECT_TRUE(r.response_W.F.vector().allFinite());
      last = r.params_version;
    }
  });
  for (std::uint64_t version = 2; version < 60; ++version) {
    pipeline.set_params(params(std::string(law_names()[version % law_names().size()]), version));
  }
  done = true;
  stepping.join();
}

TEST(ContactPipeline, StepNeverAllocatesNotEvenWhenTheLawChanges) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "allocation hooks are off in sanitizer builds";
  std::mt19937 rng(49);
  ContactPipeline pipeline(sphere_field(), shell(), 64, params("none", 1));
  std::uint64_t version = 1;
  for (const std::string_view law : law_names()) {
    pipeline.set_params(params(std::string(law), ++version));
    const auto before = rt::rt_allocations();
    for (int trial = 0; trial < 20; ++trial) {
      ToolQuery q = touching(rng);
      if (trial == 7) q.X_WT.p.x() = std::nan("");
      const rt::RtSection section;
      pipeline.step(q);
    }
    EXPECT_EQ(rt::rt_allocations(), before) << law;
  }
}

}  // namespace
}  // namespace tact::contact
