// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/law_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "capstan/tools/apply/board_number.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

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

/// The number behind the name in one of these lines, in the board's steps.
auto steps_of(const std::vector<std::string>& lines, const std::string& name) -> long {
  for (const std::string& line : lines) {
    if (const auto at = line.find(" " + name + " "); at != std::string::npos) {
      return std::lround(std::strtod(line.c_str() + at + name.size() + 2, nullptr) * 0x1p24);
    }
  }
  ADD_FAILURE() << "no " << name;
  return 0;
}

// Eight decimals first, it lay on the other side of half a step.
TEST(LawLines, BoardAndReplayHaveTheSameNumbers) {
  constexpr double kClose = -0.11551538311519653;  // 1938026.534 steps
  const long step = Q24::from_double(kClose).raw();
  JointFile joint;
  joint.terms = {"tendon_elongation"};
  const CatalogueTerm& term = catalogue_term("tendon_elongation");
  joint.parameters.coefficients[term.first_coefficient + 1] = kClose;
  EXPECT_EQ(steps_of(model_lines(joint, 0), "joint0.tendon_elongation.bottom"), step);
  const std::string file = "[force]\nmodel = \"preisach\"\ninputs = [-0.2, 0.2]\nforces = [[" + exact(kClose) + "], [" +
                           exact(kClose) + ", 0.1]]\n";
  EXPECT_EQ(steps_of(force_lines(file, "law.toml", 0), "joint0.preisach.force_0_0"), step);
  EXPECT_EQ(board_number(1234.5), "1234.50000000") << "for the board to refuse";
}

}  // namespace
}  // namespace capstan::tools
