// SPDX-License-Identifier: Apache-2.0
// A joint is the same joint whether it is logged in rad, degrees of a motor before or behind a gear, N m or A.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {
namespace {

using test::Truth;

/// Units of a log: what its numbers are multiplied by, and from where its angles are counted.
struct Units {
  double motor = 1.0, joint = 1.0, torque = 1.0, time = 1.0;
  double motor_zero = 0.0, joint_zero = 0.0;
};

auto in_units(AxisLog log, const Units& units) -> AxisLog {
  log.q1_rad = (units.motor * log.q1_rad.array() + units.motor_zero).matrix();
  log.q2_rad = (units.joint * log.q2_rad.array() + units.joint_zero).matrix();
  log.tau_nm *= units.torque;
  log.time_s *= units.time;
  log.period_s *= units.time;
  return log;
}

/// Far and near, one at a time.
auto all_units() -> std::vector<std::pair<std::string, Units>> {
  std::vector<std::pair<std::string, Units>> all;
  for (const double factor : {1e-3, 1e3}) {
    const std::string by = " times " + std::to_string(factor);
    all.emplace_back("motor" + by, Units{.motor = factor});
    all.emplace_back("joint" + by, Units{.joint = factor});
    all.emplace_back("torque" + by, Units{.torque = factor});
  }
  all.emplace_back("motor times 0.03", Units{.motor = 0.03});
  all.emplace_back("motor counted from elsewhere", Units{.motor_zero = -20.0});
  all.emplace_back("joint counted from elsewhere", Units{.joint_zero = 7.0});
  for (const double factor : {0.1, 10.0}) {
    all.emplace_back("time times " + std::to_string(factor), Units{.time = factor});
  }
  return all;
}

auto names_of(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& effect : d.effects) {
    names.push_back(effect.name);
  }
  return names;
}

auto coefficient_of(const Diagnosis& d, const std::string& term) -> double {
  return d.law.parameters.coefficients[d.law.catalogue->term(term).first_coefficient];
}

auto warns_of(const Diagnosis& d, const char* words) -> bool {
  return std::any_of(d.warnings.begin(), d.warnings.end(),
                     [words](const auto& warning) { return warning.find(words) != std::string::npos; });
}
constexpr const char* kTooFar = "beyond the range of a board's numbers";
constexpr const char* kTooFine = "tell directions from 1e-6 on";

class ScaleOfMadeUpJoint : public testing::TestWithParam<Truth> {};

TEST_P(ScaleOfMadeUpJoint, ChangesNoVerdictAndScalesTheLaw) {
  test::SyntheticRequest request;
  request.truth = GetParam();
  request.rate_hz = 50.0;
  request.cycle_s = 25.0;
  const AxisLog log = test::synthetic_log(request);
  const Diagnosis plain = diagnose({log}, {});
  EXPECT_FALSE(warns_of(plain, kTooFar) || warns_of(plain, kTooFine));
  for (const auto& [name, units] : all_units()) {
    SCOPED_TRACE(name);
    const Diagnosis d = diagnose({in_units(log, units)}, {});
    EXPECT_STREQ(verdict_word(d.verdict), verdict_word(plain.verdict)) << d.reason;
    EXPECT_EQ(names_of(d), names_of(plain)) << d.reason;
    // Where fixed point can not tell the encoder's counts apart, the running law is late, and a sentence says so.
    const bool too_fine = units.motor < 0.01;
    EXPECT_EQ(warns_of(d, kTooFine), too_fine);
    if (!too_fine) {
      EXPECT_NEAR(d.before.rmse / units.joint, plain.before.rmse, 0.02 * plain.before.rmse);
      EXPECT_NEAR(d.after.rmse / units.joint, plain.after.rmse, 0.05 * plain.after.rmse);
    }
    const double ratio = units.joint / units.motor;
    EXPECT_NEAR(coefficient_of(d, "motor_angle") / ratio, coefficient_of(plain, "motor_angle"), 2e-3);
    const double elongation = units.joint / units.torque;
    EXPECT_NEAR(coefficient_of(d, "tendon_elongation") / elongation, coefficient_of(plain, "tendon_elongation"), 0.02);
    const AxisLog here = in_units(log, units);
    const bool too_far = here.q1_rad.cwiseAbs().maxCoeff() >= 128.0 || here.q2_rad.cwiseAbs().maxCoeff() >= 128.0 ||
                         here.tau_nm.cwiseAbs().maxCoeff() >= 128.0;
    EXPECT_EQ(warns_of(d, kTooFar), too_far);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, ScaleOfMadeUpJoint, testing::Values(Truth::kNone, Truth::kPlay, Truth::kPretension));

// At a motor before a gear: a gap is a share of the motion, and no number of rad.
TEST(ScaleOfPlay, AGapOfMoreThanHalfARadIsNamedWithItsWidth) {
  test::SyntheticRequest request;
  request.truth = Truth::kPlay;
  request.rate_hz = 100.0;
  request.cycle_s = 25.0;
  const Diagnosis d = diagnose({in_units(test::synthetic_log(request), {.motor = 100.0})}, {});
  EXPECT_EQ(names_of(d), std::vector<std::string>{"play"}) << d.reason;
  EXPECT_NEAR(d.law.parameters.shapes[d.law.catalogue->term("play").first_shape], 0.8, 0.1);
}

class ScaleOfMachine : public testing::TestWithParam<const char*> {};

TEST_P(ScaleOfMachine, ChangesNoVerdictAndNoError) {
  const char* set = std::getenv("CAPSTAN_DATA");
  const auto data = set != nullptr ? std::filesystem::path(set)
                                   : std::filesystem::path(CAPSTAN_SOURCE_DIR).parent_path() / "shared" / "data";
  const auto file = data / "machines" / GetParam();
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << file << " is not there; set CAPSTAN_DATA to the folder of measured logs";
  }
  const AxisLog log = read_axis(CsvLog::read(file.string()), {});
  const Diagnosis plain = diagnose({log}, {});
  for (const Units& units : {Units{.motor = 1e-3}, Units{.motor = 30.0}, Units{.joint = 1e3}, Units{.torque = 1e-3},
                             Units{.motor_zero = 20.0, .joint_zero = -7.0}}) {
    SCOPED_TRACE(units.motor);
    const Diagnosis d = diagnose({in_units(log, units)}, {});
    EXPECT_STREQ(verdict_word(d.verdict), verdict_word(plain.verdict)) << d.reason;
    EXPECT_EQ(names_of(d), names_of(plain)) << d.reason;
    EXPECT_NEAR(d.after.rmse / units.joint, plain.after.rmse, 0.05 * plain.after.rmse);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, ScaleOfMachine, testing::Values("tool_conf0_50.csv", "sheath_060.csv"));

}  // namespace
}  // namespace capstan::tools
