// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_change.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

TEST(LoopChange, WidthAndTorqueTogetherSayWhatItIs) {
  EXPECT_EQ(name_of_change(1.3, 1.3), "pretension_offset");
  EXPECT_EQ(name_of_change(0.7, 0.7), "pretension_offset");
  EXPECT_EQ(name_of_change(1.3, 1.0), "play");
  EXPECT_EQ(name_of_change(0.8, 1.0), "stiffness_hardening");
  EXPECT_EQ(name_of_change(1.0, 1.3), "");  // the torque alone
  EXPECT_EQ(name_of_change(1.3, 0.7), "");
  EXPECT_EQ(name_of_change(1.0, 1.0), "");
}

TEST(LoopChange, AGapIsToldInRadiansALatenessInMillisecondsAndTheRestInPerCent) {
  EXPECT_EQ(change_sentence("play", {0.01, "rad", Interval{0.009, 0.011}}),
            "the gap is 0.01 [0.009, 0.011] rad to either side, at the joint");
  EXPECT_EQ(change_sentence("pretension_offset", {1.2, "1", Interval{1.1, 1.3}}),
            "pretension, if the tendons' friction number is unchanged, is 120 [110, 130] % of the healthy joint's");
  EXPECT_EQ(change_sentence("transport_delay", {0.008, "s", Interval{0.0079, 0.0081}}),
            "the joint is seen 8 [7.9, 8.1] ms later than at the healthy joint");
}

TEST(LoopChange, OnlyTheNumberThatHasTheNameChanges) {
  LawForm tendons;
  tendons.terms = terms_of_model(kTendonModel);
  tendons.tied_compliance = -2.0;
  const LawForm tighter = changed_tendons(tendons, "pretension_offset", 1.5);
  const std::size_t pretension = tendons.catalogue->term(kTendonModel).first_shape + 2;
  EXPECT_DOUBLE_EQ(tighter.shapes[pretension], 1.5 * tendons.shapes[pretension]);
  EXPECT_DOUBLE_EQ(*tighter.tied_compliance, -2.0);
  EXPECT_DOUBLE_EQ(*changed_tendons(tendons, "stiffness_hardening", 0.5).tied_compliance, -1.0);
  EXPECT_EQ(changed_tendons(tendons, "play", 1.5).shapes, tendons.shapes);
}

}  // namespace
}  // namespace capstan::tools
