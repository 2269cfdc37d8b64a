// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/width_limit.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {
namespace {

auto joint_of_width(double half_width_rad) -> JointFile {
  JointFile joint;
  joint.terms = {"motor_angle", "joint_offset", "play"};
  joint.parameters.coefficients[catalogue_term("motor_angle").first_coefficient] = 0.01;
  joint.parameters.shapes[catalogue_term("play").first_shape] = half_width_rad;
  return joint;
}

TEST(WidthLimit, AWidthIsAtItWhereTheNextOneThatWouldBeTriedIsBeyond60) {
  EXPECT_TRUE(widths_at_limit(joint_of_width(0.02)).empty());
  EXPECT_TRUE(widths_at_limit(joint_of_width(45.0)).empty());
  EXPECT_EQ(widths_at_limit(joint_of_width(48.0)), std::vector<std::string>{"play.half_width"});
  EXPECT_EQ(widths_at_limit(joint_of_width(60.0)), std::vector<std::string>{"play.half_width"});
}

TEST(WidthLimit, WhatIsNotInTheLawOrNoWidthIsNotAtIt) {
  JointFile joint = joint_of_width(60.0);
  joint.terms = {"motor_angle", "joint_offset"};
  EXPECT_TRUE(widths_at_limit(joint).empty());
  EXPECT_FALSE(is_at_limit({"order", "1", 1.0, 60.0, 1.0, "of a period"}, 60.0));
}

TEST(WidthLimit, TheFileSaysIt) {
  EXPECT_NE(
      joint_file_text(joint_of_width(60.0)).find("# at the limit of a board's numbers, wider ones were not searched"),
      std::string::npos);
  EXPECT_EQ(joint_file_text(joint_of_width(6.0)).find("at the limit"), std::string::npos);
}

}  // namespace
}  // namespace capstan::tools
