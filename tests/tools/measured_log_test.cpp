// SPDX-License-Identifier: Apache-2.0
// Logs of a real robot, when they are there: a KUKA KR300 with encoders on motors and joints (Weigand 2021).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "tools/diagnose/diagnosis.hpp"
#include "tools/identify/term_catalogue.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

auto data_folder() -> std::filesystem::path {
  if (const char* folder = std::getenv("CAPSTAN_DATA")) {
    return folder;
  }
  return std::filesystem::path(CAPSTAN_SOURCE_DIR).parent_path() / "shared" / "data";
}

class KukaAxis : public testing::TestWithParam<int> {};

TEST_P(KukaAxis, TheJointSensorIsLateAndNothingIsTakenForPlay) {
  const auto file = data_folder() / "kuka_kr300" / "kuka_A.csv";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << file << " is not there; set CAPSTAN_DATA to the folder of measured logs";
  }
  const std::string n = std::to_string(GetParam());
  const auto maps = parse_mappings({"time_s=t_s", "axis0/q1_rad=q" + n + "_motor_rad",
                                    "axis0/q2_rad=q" + n + "_joint_rad", "axis0/tau_Nm=tau" + n + "_motor_Nm"});
  const Diagnosis d = diagnose({read_axis(CsvLog::read(file.string(), maps), {})}, {});
  ASSERT_FALSE(d.effects.empty()) << d.reason;
  EXPECT_EQ(d.effects[0].name, "transport_delay");
  for (const auto& effect : d.effects) {
    EXPECT_NE(effect.name, "play");
  }
  const double delay_s = d.law.parameters.shapes[catalogue_term("transport_delay").first_shape];
  EXPECT_GE(delay_s, 0.0027);
  EXPECT_LE(delay_s, 0.0033);
  EXPECT_GT(d.before.rmse, 0.015 * kDegree);
  EXPECT_LE(d.after.rmse, 0.009 * kDegree);
  EXPECT_LT(d.ratio_ci95[1], 0.5);
}

INSTANTIATE_TEST_SUITE_P(AllThree, KukaAxis, testing::Values(1, 2, 3));

}  // namespace
}  // namespace capstan::tools
