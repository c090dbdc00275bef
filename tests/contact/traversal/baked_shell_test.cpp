#include <gtest/gtest.h>

#include <random>

#include "contact/bake/test_meshes.hpp"
#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/shell_bake.hpp"
#include "contact/contact_set.hpp"
#include "contact/traversal/traversal.hpp"
#include "math/exp_log.hpp"

namespace tact::contact {
namespace {

DistanceField field(const Mesh& mesh, int resolution) {
  FieldOptions options;
  options.resolution = resolution;
  FieldReport report;
  return make_field(bake_field(clean_soup(mesh), options, {}, report));
}

std::shared_ptr<const Pointshell> shell(const Mesh& mesh, int points) {
  ShellReport report;
  return std::make_shared<const Pointshell>(bake_shell(clean_soup(mesh), {points, 7, 0}, {}, report));
}

/// The promise that counts, on what is really baked, from sound meshes and from spoiled ones.
TEST(Traversal, EqualsBruteForceOnBakedFieldsAndShells) {
  const Mesh torus = tact::test::torus_mesh(0.04, 0.012, 40, 24);
  const Mesh block = tact::test::box_mesh(Vec3(-0.03, -0.02, -0.01), Vec3(0.03, 0.02, 0.01));
  const std::vector<DistanceField> fields = {field(torus, 48),
                                             field(tact::test::unwelded(tact::test::doubly_faced(torus)), 48),
                                             field(tact::test::flipped(block, 3), 40)};
  const std::vector<std::shared_ptr<const Pointshell>> shells = {shell(torus, 3000), shell(block, 3000)};
  std::mt19937 rng(51);
  std::uniform_real_distribution<double> place(-0.05, 0.05), turn(-3, 3);
  std::size_t touching = 0, contact_count = 0;
  for (const auto& f : fields) {
    for (const auto& s : shells) {
      Traversal traversal(f, s);
      ContactBuffer contacts(s->size());
      for (int trial = 0; trial < 150; ++trial) {
        const Pose X_OT{Vec3(place(rng), place(rng), place(rng)), exp_so3(Vec3(turn(rng), turn(rng), turn(rng)))};
        const Findings found = traversal.find(X_OT, contacts);
        const Mat3 R = X_OT.q.normalized().toRotationMatrix();
        std::size_t k = 0;
        for (std::uint32_t i = 0; i < s->size(); ++i) {
          const double value = f.sample(test::placed(R, X_OT.p, s->position_T[i])).value_m;
          if (value >= 0) continue;
          ASSERT_LT(k, contacts.size);
          ASSERT_EQ(contacts.point_id[k], i);
          ASSERT_EQ(contacts.depth_m[k], -value);
          ++k;
        }
        ASSERT_EQ(k, contacts.size);
        ASSERT_EQ(found.clearance_m == 0 || k == 0, true);
        touching += k > 0;
        contact_count += k;
      }
    }
  }
  EXPECT_GT(touching, 300u);
  EXPECT_GT(contact_count, 10000u);
}

}  // namespace
}  // namespace tact::contact
