// SPDX-License-Identifier: Apache-2.0
// What `capstan identify` says of logs that no law of the joint is in, or one that is counted the other way.
#include <random>

#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

class IdentifyCommand : public Command {
 protected:
  /// What identify makes of such a log, into law.toml.
  auto identified(const AxisLog& log, const std::string& options = "") const -> Outcome {
    write_text_file(path("log.csv"), test::log_text(log));
    return run("identify \"" + path("log.csv") + "\" -o \"" + path("law.toml") + "\" " + options);
  }
  auto law() const -> std::string { return read_text_file(path("law.toml")); }
  auto law_has(const std::string& text) const -> bool { return law().find(text) != std::string::npos; }
};

auto says(const Outcome& outcome, const std::string& text) -> bool {
  return outcome.output.find(text) != std::string::npos;
}

TEST_F(IdentifyCommand, ALawOfNoiseIsProvisionalAndSaid) {
  AxisLog log = test::synthetic_log(short_log(200.0));
  EXPECT_FALSE(says(identified(log), "provisional"));
  EXPECT_TRUE(law_has("status = \"confirmed\"")) << law();
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  for (double& value : log.q2_rad) {
    value = noise(random);
  }
  const Outcome outcome = identified(log);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "does not show that the joint follows its motor")) << outcome.output;
  EXPECT_TRUE(law_has("status = \"provisional\"")) << law();
}

TEST_F(IdentifyCommand, ALawThatExplainsNothingIsProvisionalAndHasNoGoodnessOfFit) {
  AxisLog log = test::synthetic_log(short_log(200.0));
  for (Eigen::Index i = 0; i < log.samples(); ++i) {  // of no motion at all: inertia is held at 0
    log.tau_nm[i] = 0.05 * std::copysign(1.0, std::sin(0.37 * static_cast<double>(i)));
  }
  const Outcome outcome = identified(log, "--model inertia");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "leaves more than it explains")) << outcome.output;
  EXPECT_FALSE(says(outcome, "inf")) << outcome.output;
  EXPECT_TRUE(law_has("status = \"provisional\"")) << law();
  EXPECT_FALSE(law_has("inf ") || law_has("inf\n")) << law();
}

TEST_F(IdentifyCommand, TheMotorsAngleIsNoTarget) {
  const Outcome outcome = identified(test::synthetic_log(short_log(200.0)), "--target axis0/q1_rad");
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_TRUE(says(outcome, "name the joint's, axis0/q2_rad")) << outcome.output;
}

TEST_F(IdentifyCommand, ACrossedTransmissionIsNotToldToTurnItsTorque) {
  AxisLog log = test::synthetic_log(short_log(200.0));
  log.q2_rad *= -1.0;
  const Outcome crossed = identified(log);
  EXPECT_TRUE(says(crossed, "is held at 0: the joint is counted against its motor")) << crossed.output;
  EXPECT_TRUE(says(crossed, "(--map \"axis0/q2_rad=COLUMN*-1\")")) << crossed.output;
  EXPECT_FALSE(says(crossed, "check the sign of tau_Nm")) << crossed.output;
  const Outcome turned = identified(log, "--map axis0/q2_rad=axis0/q2_rad*-1");
  EXPECT_FALSE(says(turned, "is held at 0")) << turned.output;
}

}  // namespace
}  // namespace capstan::tools
