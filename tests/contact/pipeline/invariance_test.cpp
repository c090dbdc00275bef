#include <gtest/gtest.h>

#include "contact/hierarchy.hpp"
#include "contact/pipeline/contact_pipeline.hpp"
#include "field/field_builder.hpp"
#include "math/exp_log.hpp"

namespace tact::contact {
namespace {

/// A box of 6 x 6 x 4 cm and a tool of about 4 cm, both `scale` times as large, as is the voxel of 2 mm.
struct Rig {
  double scale;
  std::shared_ptr<Pointshell> shell;
  DistanceField field;

  explicit Rig(double s, bool round = false) : scale(s) {
    std::mt19937 rng(101);
    shell =
        std::make_shared<Pointshell>(round ? test::sphere_shell(rng, 1200, 0.02) : test::cube_shell(rng, 1200, 0.02));
    for (std::size_t i = 0; i < shell->size(); ++i) {
      shell->position_T[i] *= static_cast<float>(s);
      shell->radius_m[i] *= static_cast<float>(s) * 1.000001f;
    }
    shell->bounding_radius_m *= s;
    const Vec3 grid = Vec3::Constant(0.05 * s);
    field = build_field(-grid, grid, 0.002 * s, [s](const Vec3& p_O) {
      const Vec3 q = (p_O / s).cwiseAbs() - Vec3(0.03, 0.03, 0.02);
      return s * (q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0));
    });
  }
  PipelineParams params(std::string_view law, const std::string& along, double damping_ratio = 0) const {
    ContactSpec spec;
    spec.law = law;
    spec.force_along = along;
    spec.stiffness_n_per_m = 1e4;
    spec.damping_ratio = damping_ratio;
    spec.cluster_voxels = 1;
    return pipeline_params(spec, field.voxel_m(), 0.2, 1);
  }
  ContactPipeline pipeline(std::string_view law, const std::string& along, double damping_ratio = 0) const {
    return {field, shell, 4096, params(law, along, damping_ratio)};
  }
};

/// Of the rig of scale 1: turned at random, moved in from a random side until the deepest point is 1.5 mm deep.
Pose touching_X_OT(std::mt19937& rng) {
  static const Rig rig(1);
  const Vec3 u = test::random_unit(rng);
  const Quat q = exp_so3(3 * test::random_unit(rng));
  double in = 0, out = 0.1;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (in + out);
    double least = 1;
    for (const auto& p : rig.shell->position_T) {
      const Vec3 from_face = (middle * u + q * p.cast<double>()).cwiseAbs() - Vec3(0.03, 0.03, 0.02);
      least = std::min(least, from_face.cwiseMax(0).norm() + std::min(from_face.maxCoeff(), 0.0));
    }
    (least < -1.5e-3 ? in : out) = middle;
  }
  return {out * u, q};
}

Response response(ContactPipeline& pipeline, const Pose& X_WT, const Pose& X_WO = {}, const Twist& V_WT = {}) {
  ToolQuery query;
  query.X_WT = X_WT;
  query.X_WO = X_WO;
  query.V_WT = V_WT;
  return pipeline.step(query).response_W;
}

template <class F>
void for_every_law(const std::vector<const char*>& directions, F&& f) {
  for (const std::string_view law : law_names()) {
    for (const char* along : directions) f(law, along);
  }
}
const std::vector<const char*> kWithoutMemory{"gradient", "normal"}, kAll{"gradient", "held", "normal"};

TEST(Invariance, MovingBothBodiesTurnsTheWrenchAndNothingElse) {
  const Rig rig(1);
  for_every_law(kAll, [&](std::string_view law, const char* along) {
    ContactPipeline pipeline = rig.pipeline(law, along, 0.1);
    std::mt19937 rng(102);
    for (const double away_m : {1.0, 1e3, 1e6}) {
      for (int trial = 0; trial < 5; ++trial) {
        const Pose X_OT = touching_X_OT(rng), Y{away_m * test::random_unit(rng), exp_so3(3 * test::random_unit(rng))};
        const Twist V{0.01 * test::random_unit(rng), 0.1 * test::random_unit(rng)};
        const Response here = response(pipeline, X_OT, {}, V);
        ASSERT_GT(pipeline.contacts().size, 0u);
        const Response there = response(pipeline, Y * X_OT, Y, {Y.q * V.linear, Y.q * V.angular});
        const Response turned = rotated(here, Y.R());
        // A coordinate of a million metres is known to 1e-10 m: of a depth of a millimetre a ten-millionth.
        const double slack = 1e-9 + 1e-11 * away_m;
        EXPECT_LT((there.F.vector() - turned.F.vector()).norm(), slack * turned.F.vector().norm()) << law << along;
        EXPECT_LT((there.G - turned.G).norm(), 100 * slack * turned.G.norm()) << law << along;
        EXPECT_LT((there.K - turned.K).norm(), 100 * slack * turned.K.norm()) << law << along;
        EXPECT_LT((there.B - turned.B).norm(), 100 * slack * turned.B.norm()) << law << along;
      }
    }
  });
}

/// The box and its grid are as before after a quarter turn about z.
TEST(Invariance, TurningTheToolByASymmetryOfTheBodyTurnsTheWrench) {
  const Rig rig(1);
  const Pose quarter{Vec3::Zero(), exp_so3(Vec3(0, 0, std::numbers::pi / 2))};
  for_every_law(kWithoutMemory, [&](std::string_view law, const char* along) {
    ContactPipeline pipeline = rig.pipeline(law, along);
    std::mt19937 rng(103);
    for (int trial = 0; trial < 10; ++trial) {
      const Pose X_OT = touching_X_OT(rng);
      const Response here = response(pipeline, X_OT), there = response(pipeline, quarter * X_OT);
      const Response turned = rotated(here, quarter.R());
      ASSERT_GT(here.F.force.norm(), 0);
      EXPECT_LT((there.F.vector() - turned.F.vector()).norm(), 1e-6 * turned.F.vector().norm()) << law << along;
      EXPECT_LT((there.G - turned.G).norm(), 1e-6 * turned.G.norm()) << law << along;
    }
  });
}

/// All points on two mirrored faces of a wedge: nothing points sideways. The potential's directions are not symmetric.
TEST(Invariance, AMirroredToolOnAMirroredBodyIsPushedInTheMirror) {
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 200; ++i) {
    for (const double side : {-1.0, 1.0}) {
      points.emplace_back(side * (0.0005 + 0.0003 * (i % 20)), 0.001 * (i / 20) - 0.0045, -0.01 + 0.0002 * (i % 20));
      normals.emplace_back(-side * 0.6, 0, 0.8);
    }
  }
  Rig rig(1);
  const auto shell = std::make_shared<const Pointshell>(test::make_hierarchy(points, normals, 4, 4));
  for_every_law(kWithoutMemory, [&](std::string_view law, const char* along) {
    ContactPipeline pipeline(rig.field, shell, 1000, rig.params(law, along));
    const Wrench F = response(pipeline, {Vec3(0, 0, 0.0285), Quat::Identity()}).F;
    ASSERT_GT(F.force.z(), 0);
    const double slack = law == "potential" ? 0.03 : 1e-6;
    EXPECT_LT(std::fabs(F.force.x()), slack * F.force.z()) << law << along;
    EXPECT_LT(std::fabs(F.torque.y()), slack * 0.01 * F.force.z()) << law << along;
    EXPECT_LT(std::fabs(F.torque.z()), slack * 0.01 * F.force.z()) << law << along;
  });
}

/// Everything s times as large at the same k: forces s times, torques s^2 times.
TEST(Invariance, LengthsScaleTheWrenchWhateverTheSize) {
  const Rig one(1);
  // By powers of two nothing is rounded otherwise; by others coordinates are, in single precision.
  for (const auto& [s, slack] :
       {std::pair{1.0 / 1024, 1e-11}, {1024.0, 1e-11}, {1e-3, 2e-4}, {0.1, 2e-4}, {1e3, 2e-4}}) {
    const Rig rig(s);
    for_every_law(kAll, [&, s = s, slack = slack](std::string_view law, const char* along) {
      ContactPipeline small = one.pipeline(law, along), large = rig.pipeline(law, along);
      std::mt19937 rng(104);
      Vec6 unit;
      unit << 1, 1, 1, s, s, s;
      for (int trial = 0; trial < 5; ++trial) {
        const Pose X_OT = touching_X_OT(rng);
        const Response a = response(small, X_OT), b = response(large, {s * X_OT.p, X_OT.q});
        const Vec6 F = s * unit.asDiagonal() * a.F.vector();
        const Mat6 G = unit.asDiagonal() * a.G * unit.asDiagonal(), K = unit.asDiagonal() * a.K * unit.asDiagonal();
        const Vec6 back = unit.cwiseInverse();
        const auto off = [&](const Mat6& x, const Mat6& y) {
          return (back.asDiagonal() * (x - y) * back.asDiagonal()).norm() /
                 (back.asDiagonal() * y * back.asDiagonal()).norm();
        };
        ASSERT_GT(F.norm(), 0);
        const Vec6 force_off = back.cwiseProduct(b.F.vector() - F), force = back.cwiseProduct(F);
        EXPECT_LT(force_off.norm(), slack * force.norm()) << law << along << s;
        EXPECT_LT(off(b.G, G), 10 * slack) << law << along << s;
        EXPECT_LT(off(b.K, K), 10 * slack) << law << along << s;
      }
    });
  }
}

TEST(Invariance, NoCoordinateHoweverLargeIsAnsweredWithAnythingButAFiniteWrench) {
  const Rig rig(1);
  for_every_law(kAll, [&](std::string_view law, const char* along) {
    ContactPipeline pipeline = rig.pipeline(law, along, 0.5);
    for (const double far : {1e3, 1e9, 1e20, 1e150, 1e300, 1.7e308}) {
      for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 1, -1), Vec3(0, 0.5, 1)}) {
        for (const bool both : {true, false}) {
          ToolQuery query;
          query.X_WT.p = far * side;
          query.X_WT.q = exp_so3(Vec3(0.3, 0.4, 0.5));
          if (both) query.X_WO.p = query.X_WT.p;
          query.V_WT.linear = far * side;
          query.V_WO.angular = Vec3(0, far, 0);
          const ContactResult& r = pipeline.step(query);
          EXPECT_TRUE(r.response_W.F.vector().allFinite()) << law << far;
          EXPECT_TRUE(r.response_W.G.allFinite() && r.response_W.K.allFinite() && r.response_W.B.allFinite()) << law;
          EXPECT_TRUE(std::isfinite(r.clearance_m)) << far;
          EXPECT_GE(r.clearance_m, 0);
        }
      }
    }
  });
}

TEST(Invariance, BeyondCapacityEveryLawWeighsTheDeepestAndSaysHowManyAreMissing) {
  const Rig rig(1);
  std::mt19937 rng(105);
  for_every_law(kWithoutMemory, [&](std::string_view law, const char* along) {
    ContactPipeline whole = rig.pipeline(law, along), few(rig.field, rig.shell, 4, rig.params(law, along));
    int overflows = 0;
    for (int trial = 0; trial < 20; ++trial) {
      ToolQuery query;
      query.X_WT = touching_X_OT(rng);
      const ContactResult all = whole.step(query);
      const ContactResult some = few.step(query);
      EXPECT_EQ(some.max_depth_m, all.max_depth_m);
      EXPECT_LE(some.contact_count, 4u);
      EXPECT_TRUE(some.response_W.F.vector().allFinite());
      EXPECT_EQ((some.status & bit(Status::overflow)) != 0, some.dropped > 0);
      EXPECT_TRUE(law == "cluster" || some.contact_count + some.dropped == all.contact_count) << law;
      overflows += some.dropped > 0;
    }
    EXPECT_GT(overflows, 5);
  });
}

}  // namespace
}  // namespace tact::contact
