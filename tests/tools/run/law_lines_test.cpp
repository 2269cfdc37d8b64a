// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/law_lines.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

TEST(LawLines, AreForAJointThatTheBoardHas) {
  const std::vector<std::string> board = {"capstan 0.1.0 board sim joints 2 parameters 330"};
  EXPECT_NO_THROW(expect_joints({"begin", "set joint1.motor_angle.beta 1", "commit"}, board));
  EXPECT_NO_THROW(expect_joints({"set joint3.motor_angle.beta 1"}, {}));  // an older board does not say
  try {
    expect_joints({"begin", "set joint3.motor_angle.beta 1", "commit"}, board);
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("the board has 2 joints, numbered from 0, and joint 3 was asked for"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace capstan::tools
