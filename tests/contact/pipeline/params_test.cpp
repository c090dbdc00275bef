#include "contact/pipeline/params.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fault/fault.hpp"

namespace tact::contact {
namespace {

TEST(PipelineParams, StiffnessFollowsFromTheForceLimitUnlessItIsGiven) {
  ContactSpec spec;
  spec.f_max_n = 10;
  spec.x_max_voxels = 0.5;
  const PipelineParams a = pipeline_params(spec, 0.001, 0.2, 7);
  EXPECT_DOUBLE_EQ(a.x_max_m, 0.0005);
  EXPECT_DOUBLE_EQ(a.stiffness_n_per_m, 20000);
  EXPECT_DOUBLE_EQ(a.stiffness_n_per_m * a.x_max_m, spec.f_max_n);
  EXPECT_EQ(a.damping_n_s_per_m, 0);
  EXPECT_EQ(a.version, 7u);
  EXPECT_DOUBLE_EQ(a.law_params.lever_floor_m, 0.001);

  spec.stiffness_n_per_m = 500;
  spec.damping_ratio = 0.5;
  const PipelineParams b = pipeline_params(spec, 0.001, 0.2, 8);
  EXPECT_DOUBLE_EQ(b.stiffness_n_per_m, 500);
  EXPECT_DOUBLE_EQ(b.damping_n_s_per_m, std::sqrt(500 * 0.2));
}

TEST(PipelineParams, ImpossibleValuesAreRefusedWithTheirKey) {
  const auto message = [](auto change) -> std::string {
    ContactSpec spec;
    change(spec);
    try {
      pipeline_params(spec, 0.001, 0.2, 1);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message([](ContactSpec&) {}), "");
  EXPECT_NE(message([](ContactSpec& s) { s.p = 16.5; }).find("contact.p: found 16.5"), std::string::npos);
  EXPECT_NE(message([](ContactSpec& s) { s.q = std::nan(""); }).find("contact.q"), std::string::npos);
  EXPECT_NE(message([](ContactSpec& s) { s.f_max_n = 0; }).find("contact.f_max_n"), std::string::npos);
  EXPECT_NE(message([](ContactSpec& s) { s.x_max_voxels = -1; }).find("contact.x_max_voxels"), std::string::npos);
  EXPECT_NE(message([](ContactSpec& s) { s.stiffness_n_per_m = HUGE_VAL; }).find("contact.stiffness_n_per_m"),
            std::string::npos);
  EXPECT_NE(message([](ContactSpec& s) { s.damping_ratio = -0.1; }).find("contact.damping_ratio"), std::string::npos);
}

}  // namespace
}  // namespace tact::contact
