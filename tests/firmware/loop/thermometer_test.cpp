// SPDX-License-Identifier: Apache-2.0
// A thermometer feeds thermal_drift; without one, or when it falls silent, nothing stops.
#include <gtest/gtest.h>

#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan {
namespace {

constexpr double kPerKelvin = 0.002;

auto warm_config() -> Config<1> {
  Config<1> config;
  set_raw_value(config[0], *find_parameter("thermal_drift.temperature"), Q24::from_double(kPerKelvin).raw());
  return config;
}
auto at(double celsius, Quality quality = Quality::kOk) {
  return [celsius, quality](Sensed<1>& sensed) {
    sensed.temperature_c = Q24::from_double(celsius);
    sensed.temperature = quality;
  };
}

TEST(Thermometer, EstimateFollowsTheTemperature) {
  test::CycleRig<1> rig(warm_config());
  for (const double celsius : {25.0, 40.0, 10.0}) {
    rig.disturb = at(celsius);
    rig.ticks(2);
    EXPECT_NEAR(rig.joint().q2_rad.to_double(), kPerKelvin * (celsius - 25.0), 1e-5) << celsius;
  }
  EXPECT_EQ(rig.state.telemetry.warnings, 0);
}

TEST(Thermometer, SilenceFreezesTheLastValueAndIsAWarningNotAFault) {
  test::CycleRig<1> rig(warm_config());
  rig.disturb = at(40.0);
  rig.ticks(2);
  for (const Quality quality : {Quality::kMissing, Quality::kInvalid}) {
    rig.disturb = at(99.0, quality);
    rig.ticks(100);
    EXPECT_NEAR(rig.joint().q2_rad.to_double(), kPerKelvin * 15.0, 1e-5);
    EXPECT_EQ(rig.state.telemetry.warnings, bit(Warning::kThermometerLost));
    EXPECT_EQ(rig.state.telemetry.conditions, 0U) << "nothing that would stop or block";
  }
  rig.disturb = at(30.0);
  rig.ticks(2);
  EXPECT_EQ(rig.state.telemetry.warnings, 0);
  EXPECT_NEAR(rig.joint().q2_rad.to_double(), kPerKelvin * 5.0, 1e-5);
}

TEST(Thermometer, BoardWithoutOneHasNoDriftNoWarningAndSaysSo) {
  test::CycleRig<1> rig(warm_config());
  rig.ticks(100);
  EXPECT_EQ(rig.joint().q2_rad, Q24{});
  EXPECT_EQ(rig.state.telemetry.warnings, 0);
  test::Bench<1> bench;
  EXPECT_TRUE(test::has_line(bench.say("status"), "thermometer none"));
}

}  // namespace
}  // namespace capstan
