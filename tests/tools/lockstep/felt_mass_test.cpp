#include "lockstep/felt_mass.hpp"

#include <gtest/gtest.h>

namespace tact::lockstep {
namespace {

/// The arm, plus the handle body in pseudo-admittance, plus the tool where it has mass.
TEST(FeltMass, IsThatOfTheArmAndTheBodiesBehindItInEveryCoupling) {
  AnalyticScene scene = flat_face(25);
  Experiment setup;
  setup.session.scene = std::move(scene.spec);
  setup.bodies = std::move(scene.bodies);
  const double body_kg = setup.session.scene.coupling.mass_kg;
  const double body_kg_m2 = body_kg * 0.025 * 0.025;
  const coupling::SimulatedArm::Params arm;
  for (const char* mode : {"impedance", "pseudo-admittance"}) {
    for (const char* kind : {"direct", "static", "dynamic"}) {
      setup.session.machine.mode = mode;
      setup.session.scene.coupling.kind = kind;
      const int bodies = (std::string(mode) == "impedance" ? 0 : 1) + (std::string(kind) == "dynamic" ? 1 : 0);
      const FeltMass felt = felt_mass(setup);
      EXPECT_NEAR(felt.mass_kg, arm.mass_kg + bodies * body_kg, 0.05 * felt.mass_kg) << mode << ", " << kind;
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(felt.inertia_kg_m2[i], arm.inertia_kg_m2 + bodies * body_kg_m2, 0.05 * felt.inertia_kg_m2[i])
            << mode << ", " << kind << ", axis " << i;
      }
    }
  }
}

}  // namespace
}  // namespace tact::lockstep
