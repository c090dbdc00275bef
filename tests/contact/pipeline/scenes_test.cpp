#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/shell_bake.hpp"
#include "contact/contact_set.hpp"
#include "contact/frozen_contacts.hpp"
#include "contact/pipeline/params.hpp"
#include "contact/traversal/traversal.hpp"
#include "shapes/shapes.hpp"

namespace tact::contact {
namespace {

/// A scene of the product, baked coarsely: what is tested holds at every resolution, and all of it takes seconds.
struct CoarseScene {
  SceneSpec spec;
  DistanceField field;
  std::shared_ptr<const Pointshell> shell;
};

CoarseScene bake_coarsely(const std::filesystem::path& file) {
  CoarseScene scene;
  scene.spec = load_scene(file);
  FieldReport field_report;
  ShellReport shell_report;
  const auto soup = [](const BodySpec& body) { return clean_soup(make_shape(body.shape, body.shape_params)); };
  scene.field = make_field(bake_field(soup(scene.spec.obstacle), {.resolution = 128}, {}, field_report));
  const ShellOptions options{std::min(scene.spec.points, 5000), scene.spec.levels, 0};
  scene.shell = std::make_shared<const Pointshell>(bake_shell(soup(scene.spec.tool), options, {}, shell_report));
  return scene;
}

/// Poses of the tool near the scene's scripts: up to `shift_m` and `turn_rad` away.
class Poses {
 public:
  Poses(const CoarseScene& scene, double shift_m, double turn_rad)
      : scene_(scene), shift_m_(shift_m), turn_rad_(turn_rad) {
    for (const auto& [name, script] : scene.spec.scripts) {
      const HandMotion motion = load_hand_motion(script.hand_csv);
      rows_.insert(rows_.end(), motion.X_WM.begin(), motion.X_WM.end());
    }
  }

  Pose next_X_OT() {
    const Pose X_WT = rows_[rng_() % rows_.size()] * scene_.shell->X_TM.inverse();
    Vec6 by;
    by << shift_m_ * test::uniform(rng_, 0, 1) * test::random_unit(rng_),
        turn_rad_ * test::uniform(rng_, 0, 1) * test::random_unit(rng_);
    return scene_.spec.X_WO.inverse() * displaced(X_WT, by);
  }

 private:
  const CoarseScene& scene_;
  double shift_m_, turn_rad_;
  std::vector<Pose> rows_;
  std::mt19937 rng_{81};
};

/// The contacts are those of all points tried one by one, bit for bit.
void expect_brute_force(const CoarseScene& scene, Traversal& traversal) {
  ContactBuffer contacts(scene.shell->size());
  std::size_t touching = 0, apart = 0;
  for (const double far_voxels : {2.0, 30.0}) {
    Poses poses(scene, far_voxels * scene.field.voxel_m(), 0.02 * far_voxels);
    for (int trial = 0; trial < 150; ++trial) {
      const Pose X_OT = poses.next_X_OT();
      traversal.find(X_OT, contacts);
      const Mat3 R = X_OT.q.normalized().toRotationMatrix();
      std::size_t k = 0;
      for (std::uint32_t i = 0; i < scene.shell->size(); ++i) {
        const double value = scene.field.sample(test::placed(R, X_OT.p, scene.shell->position_T[i])).value_m;
        if (value >= 0) continue;
        ASSERT_LT(k, contacts.size);
        ASSERT_EQ(contacts.point_id[k], i);
        ASSERT_EQ(contacts.depth_m[k], -value);
        ++k;
      }
      ASSERT_EQ(k, contacts.size);
      ++(k > 0 ? touching : apart);
    }
  }
  EXPECT_GT(touching, 50u);
  EXPECT_GT(apart, 5u);
}

bool crosses_a_face(const DistanceField& field, const Vec3& p_O, double reach_m) {
  const Vec3 u = (p_O - field.min_O()) / field.voxel_m(), reach = Vec3::Constant(reach_m / field.voxel_m());
  return (u - reach).array().floor().matrix() != (u + reach).array().floor().matrix();
}

/// At poses in contact, under every law and with forces along both directions: G against central differences, with the
/// contacts' set and the field's gradients held, no point crossing a cell face; K symmetric positive semidefinite.
void expect_derivatives(const CoarseScene& scene, Traversal& traversal) {
  const double voxel = scene.field.voxel_m(), step = 1e-5 * voxel, lever = scene.shell->gyration_radius_m;
  const auto depth = [&](const Vec3& p_O) { return -scene.field.sample(p_O).value_m; };
  ContactSpec spec = scene.spec.contact;
  spec.cluster_voxels = 2;  // so that there are clusters: the shell is as coarse as the field
  const PipelineParams params = pipeline_params(spec, voxel, 0.2, 1);
  std::vector<std::unique_ptr<Law>> laws;
  for (const std::string_view name : law_names()) {
    laws.push_back(make_law(name, params.law_params, *scene.shell, scene.shell->size()));
  }
  ContactBuffer contacts(scene.shell->size());
  Poses poses(scene, voxel, 0.02);
  int checked = 0, largest_set = 0;
  for (int trial = 0; trial < 3000 && checked < 10; ++trial) {
    const Pose X_OT = poses.next_X_OT();
    const Findings found = traversal.find(X_OT, contacts);
    if (contacts.size == 0 || found.max_depth_m > 3 * voxel) continue;
    bool smooth = true;
    for (std::size_t i = 0; i < contacts.size; ++i) {
      const double far = contacts.r[i].norm() / lever;
      smooth = smooth && !crosses_a_face(scene.field, X_OT.p + contacts.r[i], step * (1 + 10 * far));
    }
    if (!smooth) continue;
    ++checked;
    largest_set = std::max(largest_set, static_cast<int>(contacts.size));
    for (std::size_t l = 0; l < laws.size(); ++l) {
      for (const ForceDirection along : {ForceDirection::gradient, ForceDirection::normal}) {
        contacts.force_along = along;
        const double k = params.stiffness_n_per_m;
        const Mat6 numeric = test::derivative_of_wrench(*laws[l], contacts, X_OT.p, k, step, depth);
        ContactBuffer weighed = contacts;
        laws[l]->weigh(weighed);
        const Response response = assemble(weighed, *laws[l], k, 0, {});
        EXPECT_LT(test::difference(response.G, numeric, lever), 1e-4) << law_names()[l] << ", " << contacts.size;
        EXPECT_EQ((response.K - response.K.transpose()).norm(), 0) << law_names()[l];
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat6>(response.K).eigenvalues().minCoeff(), -1e-11 * response.K.norm())
            << law_names()[l];
      }
    }
  }
  EXPECT_EQ(checked, 10);
  EXPECT_GT(largest_set, 3);
}

class Scene : public ::testing::TestWithParam<std::string> {};

TEST_P(Scene, ContactsEqualBruteForceGIsTheDerivativeAndKIsPositiveSemidefinite) {
  const CoarseScene scene = bake_coarsely(std::filesystem::path(TACT_SCENES_DIR) / (GetParam() + ".toml"));
  Traversal traversal(scene.field, scene.shell);
  expect_brute_force(scene, traversal);
  expect_derivatives(scene, traversal);
}

std::vector<std::string> all_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(TACT_SCENES_DIR)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Every, Scene, ::testing::ValuesIn(all_scenes()), [](const auto& scene) {
  std::string name = scene.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace tact::contact
