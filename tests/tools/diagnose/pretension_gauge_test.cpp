// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/pretension_gauge.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

/// Tendons with friction numbers of 1.2 and a pretension of 50 mNm: 60 mNm of 75, 10 of them the motor's own. Half of
/// its loop is 0.1 rad wide.
auto healthy(bool held = true) -> JointFile {
  JointFile joint;
  joint.terms = {"motor_angle", "joint_offset", kTendonModel};
  const std::size_t first = joint.catalogue->term(kTendonModel).first_shape;
  const double shapes[] = {1.2, 1.2, 0.05, 0.5, 0.01};
  std::copy(std::begin(shapes), std::end(shapes), joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(first));
  joint.parameters.coefficients[joint.catalogue->term("motor_angle").first_coefficient] = 0.5;
  joint.steady_torque = SteadyTorque{0.075, -0.075};
  joint.fit.emplace();
  joint.fit->loop_half_width = 0.1;
  joint.fit->loop_torque = 0.075;
  joint.fit->pretension = pretension_of(joint, held);
  return joint;
}

/// A diagnosis beside that joint's law, with the effects found.
auto gauged(const JointFile& law, const std::optional<Loop>& now, std::vector<AddedEffect> effects = {}) -> Diagnosis {
  const Preparation p = test::preparation_of(20, {});
  Diagnosis d;
  d.effects = std::move(effects);
  DiagnoseOptions options;
  options.base_law = law;
  gauge_pretension(p, options, now, d);
  return d;
}

auto effect_named(const std::string& name, double size) -> AddedEffect {
  AddedEffect effect;
  effect.name = name;
  effect.size = EffectSize{size, "1", Interval{0.9 * size, 1.1 * size}};
  return effect;
}

auto only_sentence(const Diagnosis& d) -> std::string {
  EXPECT_EQ(d.sizes.size(), 1U);
  return d.sizes.empty() ? "" : d.sizes.front();
}

/// With 1.7 times the tendons' friction, and so 1.6 times the loop.
constexpr Loop kTighter = {0.1 * (0.06 * 1.7 + 0.01) / 0.07, 0.075 + 0.06 * 0.7};

TEST(PretensionGauge, SaysOneFigureOfAPretensionThatWasNamed) {
  const Diagnosis d = gauged(healthy(), kTighter, {effect_named(kPretensionTerm, 1.76)});
  EXPECT_NE(only_sentence(d).find("more than the healthy joint's"), std::string::npos);
  ASSERT_TRUE(d.pretension);
  EXPECT_NEAR(d.effects[0].size->value, 1.7, 1e-9);
  EXPECT_NEAR(d.effects[0].size->value, d.pretension->times.value, 1e-12);
}

TEST(PretensionGauge, SaysAFrictionNumberInPlaceOfAPretension) {
  const double stretch = std::tanh(1.02) / 2.04 / (std::tanh(0.6) / 1.2);
  const Diagnosis d = gauged(healthy(), Loop{stretch * kTighter.half_width_rad, kTighter.torque_nm});
  EXPECT_NE(only_sentence(d).find("friction number is 2.04 ["), std::string::npos) << only_sentence(d);
  EXPECT_FALSE(d.pretension);
}

TEST(PretensionGauge, DoesNotSayThatAFigureIsNotToldBesideOne) {
  // A free tip knows no friction number, and the width does not go as with the pretension alone.
  const Loop now{1.4 * 0.1, kTighter.torque_nm};
  const Diagnosis named = gauged(healthy(false), now, {effect_named(kPretensionTerm, 2.6)});
  EXPECT_NE(only_sentence(named).find("260 ["), std::string::npos) << only_sentence(named);
  const Diagnosis other = gauged(healthy(false), now, {effect_named("play", 0.01)});
  EXPECT_NE(only_sentence(other).find("have not changed alike"), std::string::npos);
}

TEST(PretensionGauge, DoesNotCallALoopThatIsTheHealthyOneAnother) {
  EXPECT_NE(only_sentence(gauged(healthy(), Loop{0.1, 0.075})).find("pretension"), std::string::npos);
  EXPECT_EQ(only_sentence(gauged(healthy(), Loop{0.1, 0.075})).find("not told"), std::string::npos);
  JointFile stiff = healthy();  // whose tendons hardly rub
  stiff.fit->pretension->values[PretensionNumbers::kFriction] = 0.001;
  const std::string sentence = only_sentence(gauged(stiff, Loop{0.1, 0.0735}));
  EXPECT_NE(sentence.find("neither torque nor width"), std::string::npos) << sentence;
}

TEST(PretensionGauge, SaysNothingWhereNoLoopWasCompared) {
  EXPECT_TRUE(gauged(healthy(), std::nullopt).sizes.empty());
}

TEST(PretensionGauge, OfAnOlderFileSaysWhatTheSearchFound) {
  JointFile law = healthy();
  law.fit->pretension.reset();
  const Diagnosis d = gauged(law, kTighter, {effect_named(kPretensionTerm, 1.76)});
  EXPECT_NE(only_sentence(d).find("176 ["), std::string::npos) << only_sentence(d);
  EXPECT_TRUE(gauged(law, kTighter).sizes.empty());
}

}  // namespace
}  // namespace capstan::tools
