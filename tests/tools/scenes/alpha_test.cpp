#include "shapes/alpha.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/stored_motions.hpp"
#include "session/session.hpp"
#include "shapes/shapes.hpp"
#include "tools/scenes/mesh_distance.hpp"

namespace tact {
namespace {

/// The scene as users get it: stored files, real triangles.
struct AlphaScene {
  SceneSpec scene = load_scene(std::filesystem::path(TACT_SCENES_DIR) / "alpha.toml");
  Mesh mesh = make_shape(scene.obstacle.shape, scene.obstacle.shape_params);
  PlacedMesh obstacle{mesh, scene.X_WO};
  shapes::Alpha alpha = shapes::alpha_from(scene.obstacle.shape_params);
  double voxel_m = 0;

  AlphaScene() {
    Eigen::AlignedBox3f box;
    for (const auto& v : mesh.vertices) box.extend(v);
    voxel_m = static_cast<double>(box.sizes().maxCoeff()) / scene.field_resolution;
  }
  HandMotion script(const std::string& name) const { return load_hand_motion(scene.scripts.at(name).hand_csv); }
};

constexpr double kTranslationStep_m = 0.0005;

/// Deepest points of the tool's surface inside the obstacle, in voxels: by the strand above and by the one below.
struct Overlap {
  double upper = 0, lower = 0;
};

Overlap overlap(const AlphaScene& s, const Pose& X_WM) {
  const auto line = s.alpha.centre_line();
  const auto outside = [&](const Vec3& p) {  // surely: farther from the centre line than the tube reaches at a mitre
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Vec3 v = line[i] - line[i - 1], w = p - line[i - 1];
      if ((w - std::clamp(w.dot(v) / v.squaredNorm(), 0.0, 1.0) * v).norm() < 0.55 * s.alpha.diameter_m) return false;
    }
    return true;
  };
  Overlap found;
  for (const auto& t : PlacedMesh(s.mesh, X_WM).triangles) {
    if (t.centre.norm() > 0.05) continue;  // only the passage at the crossing is narrow
    constexpr int kSteps = 8;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3 p =
            t.corner[0] + (t.corner[1] - t.corner[0]) * i / kSteps + (t.corner[2] - t.corner[0]) * j / kSteps;
        if (outside(p) || winding_number(p, s.obstacle) < 0.5) continue;
        double& side = p.z() > 0 ? found.upper : found.lower;
        side = std::max(side, distance(p, s.obstacle) / s.voxel_m);
      }
    }
  }
  return found;
}

TEST(Alpha, Has1008TrianglesAndTheTubeOfItsParameters) {
  const AlphaScene s;
  EXPECT_EQ(s.mesh.triangles.size(), 1008u);
  EXPECT_EQ(make_shape(s.scene.tool.shape, s.scene.tool.shape_params).triangles.size(), 1008u);
  EXPECT_NEAR(s.voxel_m * 512, 0.25, 0.005);
  EXPECT_GT(s.alpha.diameter_m / s.voxel_m, 24);
  EXPECT_LT(s.alpha.diameter_m / s.voxel_m, 30);
  // Mitred prisms: area of the polygon times length of the centre line.
  double length = 0, six_volumes = 0;
  const auto line = s.alpha.centre_line();
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  for (const auto& t : s.obstacle.triangles) six_volumes += t.corner[0].dot(t.corner[1].cross(t.corner[2]));
  const double radius = s.alpha.diameter_m / 2;
  EXPECT_NEAR(six_volumes / 6, 6 * radius * radius * std::sin(2 * std::numbers::pi / 12) * length,
              1e-3 * six_volumes / 6);
}

TEST(Alpha, GapBetweenTheStrandsIsTheParameter) {
  const AlphaScene s;
  const auto line = s.alpha.centre_line();
  double lowest = 1;  // of the upper strand near the crossing
  for (const auto& p : line) {
    if (p.head<2>().norm() < 0.03) lowest = std::min(lowest, std::abs(p.z()));
  }
  EXPECT_NEAR(2 * lowest - s.alpha.diameter_m, s.alpha.gap_m, 1e-12);
}

TEST(Alpha, HalfATurnAboutXChangesNothing) {
  const auto line = shapes::alpha_from({}).centre_line();
  for (std::size_t i = 0; i < line.size(); ++i) {
    EXPECT_LT((line[line.size() - 1 - i] - Vec3(line[i].x(), -line[i].y(), -line[i].z())).norm(), 1e-12);
  }
}

TEST(Alpha, SolutionKeepsMoreThanOneAndAHalfVoxelsOfClearanceEverywhere) {
  const AlphaScene s;
  const HandMotion solve = s.script("solve");
  double least = 1e9;  // in voxels
  for (std::size_t i = 0; i < solve.X_WM.size(); i += 2) {
    least = std::min(least, distance(s.obstacle, PlacedMesh(s.mesh, solve.X_WM[i]), 0.003) / s.voxel_m);
  }
  RecordProperty("clearance_voxels", std::to_string(least));
  EXPECT_GT(least, 1.5);  // measured: 1.92
  EXPECT_GE(solve.time_s.back(), 12);
  EXPECT_LE(solve.time_s.back(), 18);
}

TEST(Alpha, StraightPullOverlapsTwoToSixVoxelsOnBothSides) {
  const AlphaScene s;
  const HandMotion cheat = s.script("cheat");
  Overlap most;
  for (std::size_t i = 0; i < cheat.X_WM.size(); i += 2) {
    // The straight way without turning, from the start to the goal.
    EXPECT_LT(cheat.X_WM[i].q.angularDistance(s.scene.start_X_WM.q), 1e-6);
    const Vec3 way = s.scene.goal_X_WM->p - s.scene.start_X_WM.p;
    EXPECT_LT((cheat.X_WM[i].p - s.scene.start_X_WM.p).cross(way.normalized()).norm(), 3e-6);
    const Overlap now = overlap(s, cheat.X_WM[i]);
    most.upper = std::max(most.upper, now.upper);
    most.lower = std::max(most.lower, now.lower);
  }
  EXPECT_GT(most.upper, 2);  // measured: 2.67
  EXPECT_LT(most.upper, 6);
  EXPECT_GT(most.lower, 2);  // measured: 3.44
  EXPECT_LT(most.lower, 6);
  EXPECT_EQ(s.scene.scripts.at("cheat").hand_force_max_n, 20);
}

std::vector<Vec3> resampled(const std::vector<Vec3>& line, double step_m) {
  std::vector<Vec3> points;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const int n = std::max(1, static_cast<int>((line[i] - line[i - 1]).norm() / step_m));
    for (int k = 0; k < n; ++k) points.push_back(line[i - 1] + (line[i] - line[i - 1]) * k / n);
  }
  points.push_back(line.back());
  return points;
}

/// The largest clearance of round tubes (negative: they overlap), turned as q_WM, with the tool's virtual tip anywhere
/// in the plane across S through the crossing and S inside the loop. Every way out at this orientation passes there.
/// Tips more than 40 mm below S are left out: with both strands inside the loop it would not hold the obstacle.
double best_clearance_at_crossing(const AlphaScene& s, const Quat& q_WM) {
  const auto line = resampled(s.alpha.centre_line(), 0.002);
  const Vec3 along = s.alpha.strand_direction(), across = Vec3::UnitZ().cross(along);
  const Vec3 tip_M = s.alpha.virtual_tip(), p_S(0, 0, s.alpha.h());
  std::vector<Vec3> obstacle, tool;  // the tool's from its virtual tip, in W
  for (const auto& p : line) {
    if (p.norm() < 0.08) obstacle.push_back(p);
    const Vec3 from_tip = q_WM * (p - tip_M);
    if (from_tip.norm() < 0.1) tool.push_back(from_tip);
  }
  const Mat3 R = q_WM.toRotationMatrix();
  double best = -1;
  for (double down = 0; down <= 0.040; down += kTranslationStep_m) {
    for (double aside = -0.04; aside <= 0.04; aside += kTranslationStep_m) {
      const Vec3 tip = p_S - down * Vec3::UnitZ() + aside * across;
      // S meets the plane of the loop at m, seen from the tip, in M.
      const Vec3 m = R.transpose() * (p_S - tip + along * ((tip - p_S).dot(R.col(2)) / along.dot(R.col(2))));
      if (std::abs(m.y()) >= -m.x() * std::tan(s.alpha.tip_half_rad)) continue;
      double nearest = 1;
      for (const auto& p : obstacle) {
        for (const auto& t : tool) nearest = std::min(nearest, (tip + t - p).squaredNorm());
      }
      best = std::max(best, std::sqrt(nearest) - s.alpha.diameter_m);
    }
  }
  return best;
}

TEST(Alpha, TipDownNoTranslationPassesTheCrossingAndLevelOneDoes) {
  const AlphaScene s;
  // Between the grid's points the clearance is larger by less than the way to the nearest of them.
  const double slack = kTranslationStep_m * std::sqrt(0.5);
  const Quat down = s.scene.start_X_WM.q;
  const Vec3 along = s.alpha.strand_direction(), across = Vec3::UnitZ().cross(along);
  const auto turned = [&](double degrees, const Vec3& axis) {
    return best_clearance_at_crossing(s, Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis)) * down);
  };
  EXPECT_LT(turned(0, along) + slack, -s.voxel_m);
  for (const double pitch : {-20, 20}) EXPECT_LT(turned(pitch, across) + slack, -s.voxel_m);
  for (const double roll : {-30, 30}) EXPECT_LT(turned(roll, along) + slack, -s.voxel_m);
  EXPECT_GT(turned(-67.5, along), 0);
  EXPECT_GT(turned(60, across), 0);
}

/// Where the obstacle's line, closed far away, passes through the tool's loop, closed by the straight line between its
/// strands at their crossing: +1 or -1 for each passage. The loop is spanned by triangles from its middle.
int passages(const std::vector<Vec3>& line, const std::vector<Vec3>& loop) {
  Vec3 middle = Vec3::Zero();
  for (const auto& p : loop) middle += p / static_cast<double>(loop.size());
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).dot((c - a).cross(d - a));
  };
  int sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    for (std::size_t j = 0; j < loop.size(); ++j) {
      const Vec3 &p = line[i - 1], &q = line[i], &a = loop[j], &b = loop[(j + 1) % loop.size()];
      const double u = volume(p, q, middle, a), v = volume(p, q, a, b), w = volume(p, q, b, middle);
      const bool through = (u > 0) == (v > 0) && (v > 0) == (w > 0);
      const double side_p = volume(middle, a, b, p), side_q = volume(middle, a, b, q);
      if (through && (side_p > 0) != (side_q > 0)) sum += side_q > 0 ? 1 : -1;
    }
  }
  return sum;
}

TEST(Alpha, LoopsHoldEachOtherAtTheStartAndNothingAtTheGoal) {
  const AlphaScene s;
  const auto line = s.alpha.centre_line();
  // The closed loop of an alpha: from crossing to crossing.
  std::vector<Vec3> loop;
  for (const auto& p : line) {
    if (p.x() >= -1e-9) loop.push_back(p);
  }
  const auto placed = [](std::vector<Vec3> points, const Pose& X) {
    for (auto& p : points) p = X * p;
    return points;
  };
  const Pose start = s.scene.start_X_WM, goal = *s.scene.goal_X_WM;
  std::vector<Vec3> closed = loop;
  closed.push_back(loop.front());
  EXPECT_EQ(std::abs(passages(closed, placed(loop, start))), 1);  // linked like two links of a chain
  EXPECT_EQ(passages(closed, placed(loop, goal)), 0);
  EXPECT_EQ(passages(line, placed(loop, goal)), 0);
  EXPECT_EQ(passages(placed(line, goal), loop), 0);
}

}  // namespace
}  // namespace tact
