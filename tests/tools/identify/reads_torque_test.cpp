// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/reads_torque.hpp"

#include <gtest/gtest.h>

#include "capstan/model/terms/table.hpp"

namespace capstan::tools {
namespace {

auto law_of(std::vector<std::string> terms) -> LawForm {
  LawForm form;
  form.terms = std::move(terms);
  return form;
}

TEST(ReadsTorque, IsSoOfElongationTendonsAndWhatComesWithLoad) {
  for (const char* term : {"tendon_elongation", "tendon", "stiffness_hardening", "viscoelastic_creep"}) {
    EXPECT_TRUE(reads_torque(law_of({"motor_angle", term}))) << term;
  }
}

TEST(ReadsTorque, IsNotSoOfWhatTheMotionGives) {
  EXPECT_FALSE(reads_torque(
      law_of({"hysteresis", "motor_angle", "joint_offset", "play", "transmission_viscous", "pretension_offset",
              "gravity", "load_inertia", "angle_periodic", "transport_delay", "axis_coupling"})))
      << "another axis's torque is not this one's";
}

TEST(ReadsTorque, OfATableDependsOnWhatItIsOver) {
  LawForm form = law_of({"table"});
  const CatalogueTerm& table = catalogue_term("table");
  Shapes shapes = form.shapes_of(table);
  shapes[1] = 5.0;
  shapes[2] = -0.5;
  shapes[3] = 0.5;
  shapes[0] = static_cast<double>(TableSignal::kMotorAngle);
  form.set_shapes(table, shapes);
  EXPECT_FALSE(reads_torque(form));
  shapes[0] = static_cast<double>(TableSignal::kTorque);
  form.set_shapes(table, shapes);
  EXPECT_TRUE(reads_torque(form));
}

}  // namespace
}  // namespace capstan::tools
