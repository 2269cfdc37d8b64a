// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/parameters/parameters.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <string>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

auto full_name(const ParameterInfo& parameter) -> std::string {
  return std::string(parameter.group) + "." + parameter.name;
}

auto named(const std::string& name) -> const ParameterInfo& {
  const ParameterInfo* parameter = find_parameter(name);
  EXPECT_NE(parameter, nullptr) << name;
  return *parameter;
}

TEST(Parameters, NamesAreUniqueWordsOfSmallLettersDigitsAndUnderscores) {
  std::set<std::string> names;
  for (const ParameterInfo& parameter : parameters()) {
    const std::string name = full_name(parameter);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_."), std::string::npos) << name;
  }
}

TEST(Parameters, DefaultsAreInsideTheirRanges) {
  const AxisConfig defaults;
  for (const ParameterInfo& parameter : parameters()) {
    EXPECT_LE(parameter.minimum, raw_value(defaults, parameter)) << full_name(parameter);
    EXPECT_GE(parameter.maximum, raw_value(defaults, parameter)) << full_name(parameter);
    EXPECT_LT(parameter.minimum, parameter.maximum) << full_name(parameter);
  }
}

TEST(Parameters, EveryOneHasAUnitAndAMeaning) {
  for (const ParameterInfo& parameter : parameters()) {
    EXPECT_FALSE(std::string(parameter.unit).empty()) << full_name(parameter);
    EXPECT_FALSE(std::string(parameter.doc).empty()) << full_name(parameter);
  }
}

TEST(Parameters, EveryOneIsFoundByItsNameAndNothingElseIs) {
  for (const ParameterInfo& parameter : parameters()) {
    EXPECT_EQ(find_parameter(full_name(parameter)), &parameter);
  }
  for (const char* name :
       {"", ".", "control", "control.", ".kp", "control.kp ", "control.kp.x", "Control.kp", "control.k"}) {
    EXPECT_EQ(find_parameter(name), nullptr) << name;
  }
}

TEST(Parameters, EveryWordOfTheConfigurationHasExactlyOneRow) {
  std::set<std::size_t> offsets;
  for (const ParameterInfo& parameter : parameters()) {
    EXPECT_EQ(parameter.offset % sizeof(std::int32_t), 0U) << full_name(parameter);
    EXPECT_TRUE(offsets.insert(parameter.offset).second) << full_name(parameter);
  }
  EXPECT_EQ(offsets.size() * sizeof(std::int32_t), sizeof(AxisConfig));
}

TEST(Parameters, SettingOneTouchesOnlyItsOwnBytes) {
  for (const ParameterInfo& parameter : parameters()) {
    AxisConfig config;
    const AxisConfig before;
    const std::int32_t raw = raw_value(before, parameter) ^ 0x5A5A5A5A;
    set_raw_value(config, parameter, raw);
    EXPECT_EQ(raw_value(config, parameter), raw);
    std::array<unsigned char, sizeof(AxisConfig)> a{};
    std::array<unsigned char, sizeof(AxisConfig)> b{};
    std::memcpy(a.data(), &before, sizeof before);
    std::memcpy(b.data(), &config, sizeof config);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool own = i >= parameter.offset && i < parameter.offset + sizeof raw;
      EXPECT_EQ(a[i] != b[i], own) << full_name(parameter) << " byte " << i;
    }
  }
}

TEST(Parameters, NamesMeanTheFieldsTheySay) {
  AxisConfig config;
  const auto expect_field = [&config](const char* name, const Q24& field) {
    const std::int32_t raw = named(name).minimum + 7;
    set_raw_value(config, named(name), raw);
    EXPECT_EQ(field.raw(), raw) << name;
  };
  const LimitConfig& limits = config.limits;
  const ControlConfig& control = config.control;
  expect_field("motor.torque_per_current", config.motor.torque_per_current_nm_per_a);
  expect_field("motor.speed_limit", config.motor.speed_limit_rad_s);
  expect_field("control.kp", control.kp);
  expect_field("control.ki", control.ki_per_s);
  expect_field("control.kd", control.kd_s);
  expect_field("control.integral_limit", control.integral_limit_rad);
  expect_field("control.stiffness", control.stiffness_nm_per_rad);
  expect_field("control.damping", control.damping_nms_per_rad);
  expect_field("control.torque_forward", control.torque_forward_nm);
  expect_field("control.torque_backward", control.torque_backward_nm);
  expect_field("control.rate_time_constant", control.rate_time_constant_s);
  expect_field("control.reversal_time", control.reversal_time_s);
  expect_field("control.reversal_angle", control.reversal_angle_rad);
  expect_field("limits.current", limits.current_a);
  expect_field("limits.continuous_current", limits.continuous_current_a);
  expect_field("limits.thermal_time", limits.thermal_time_s);
  expect_field("limits.current_rate", limits.current_rate_a_per_cycle);
  expect_field("limits.motor_min", limits.motor_min_rad);
  expect_field("limits.motor_max", limits.motor_max_rad);
  expect_field("limits.joint_min", limits.joint_min_rad);
  expect_field("limits.joint_max", limits.joint_max_rad);
  expect_field("limits.joint_speed", limits.joint_speed_rad_s);
  expect_field("limits.joint_acceleration", limits.joint_acceleration_rad_s2);
  expect_field("limits.following_error", limits.following_error_rad);
  expect_field("limits.following_time", limits.following_time_s);
  expect_field("conditioner.direction_threshold", config.law.conditioner.direction_threshold_rad);
  expect_field("conditioner.rate_time_constant", config.law.conditioner.rate_time_constant_s);
}

/// Compares the rows with what a term says about itself.
struct TermRows {
  std::size_t coefficients = 0;
  std::size_t shapes = 0;

  template <typename Term>
  void operator()() {
    AxisConfig config;
    for (const CoefficientInfo& info : Term::kInfo.coefficients) {
      const ParameterInfo& row = named(std::string(Term::kInfo.name) + "." + info.name);
      EXPECT_STREQ(row.unit, info.unit);
      EXPECT_EQ(row.minimum == 0, info.sign == Sign::kNonNegative) << full_name(row);
      EXPECT_EQ(row.maximum == 0, info.sign == Sign::kNonPositive) << full_name(row);
      set_raw_value(config, row, 4711);
      EXPECT_EQ(config.law.coefficients[coefficients++].raw(), 4711) << full_name(row);
    }
    for (const ShapeInfo& info : Term::kInfo.shapes) {
      const ParameterInfo& row = named(std::string(Term::kInfo.name) + "." + info.name);
      EXPECT_STREQ(row.unit, info.unit);
      EXPECT_EQ(row.maximum, Q24::from_double(info.maximum).raw()) << full_name(row);
      set_raw_value(config, row, 4712);
      EXPECT_EQ(config.law.shapes[shapes++].raw(), 4712) << full_name(row);
    }
  }
};

TEST(Parameters, EveryCoefficientAndShapeOfTheCatalogueHasARow) {
  TermRows rows;
  InputTerms::for_each<Q24>(rows);
  SumTerms::for_each<Q24>(rows);
  OutputTerms::for_each<Q24>(rows);
  EXPECT_EQ(rows.coefficients, kCoefficientCount);
  EXPECT_EQ(rows.shapes, kShapeCount);
}

TEST(Parameters, OnlyGainsMayChangeUnderTorque) {
  for (const ParameterInfo& parameter : parameters()) {
    const std::string name = full_name(parameter);
    const bool gain = std::string(parameter.group) == "control" || name == "force.rate" ||
                      name == "force.reversal_time" || name == "force.threshold";
    EXPECT_EQ(parameter.change == ParameterChange::kAnyTime, gain) << full_name(parameter);
    AxisConfig changed;
    set_raw_value(changed, parameter, raw_value(changed, parameter) + 1);
    EXPECT_EQ(needs_rest(AxisConfig{}, changed), !gain) << full_name(parameter);
  }
  EXPECT_FALSE(needs_rest(AxisConfig{}, AxisConfig{}));
}

TEST(Parameters, TheDefaultsAreConsistent) {
  EXPECT_EQ(check(AxisConfig{}), nullptr);
}

TEST(Parameters, EveryInconsistencyIsNamedWithItsParameterAndCure) {
  const auto complaint = [](auto&& spoil) -> std::string {
    AxisConfig config;
    spoil(config);
    const char* sentence = check(config);
    return sentence == nullptr ? "" : sentence;
  };
  const std::vector<std::pair<std::string, std::string>> complaints = {
      {"motor_angle.beta", complaint([](AxisConfig& c) { c.law.coefficients[0] = Q24{}; })},
      {"motor_angle.beta", complaint([](AxisConfig& c) { c.law.coefficients[0] = Q24::from_double(-0.009); })},
      {"coefficients", complaint([](AxisConfig& c) { c.law.coefficients.fill(Q24::from_int(10)); })},
      {"motor.encoder_sign", complaint([](AxisConfig& c) { c.motor.encoder_sign = 0; })},
      {"limits.motor_min", complaint([](AxisConfig& c) { c.limits.motor_min_rad = c.limits.motor_max_rad; })},
      {"limits.joint_min", complaint([](AxisConfig& c) { c.limits.joint_min_rad = Q24::from_int(3); })},
      {"limits.continuous_current",
       complaint([](AxisConfig& c) { c.limits.continuous_current_a = Q24::from_double(3.1); })},
  };
  for (const auto& [name, sentence] : complaints) {
    EXPECT_NE(sentence.find(name), std::string::npos) << name << ": " << sentence;
    EXPECT_NE(sentence.find("; "), std::string::npos) << sentence;
  }
}

TEST(Parameters, ACrossedTransmissionIsConsistent) {
  AxisConfig config;
  config.law.coefficients[0] = Q24::from_int(-1);
  EXPECT_EQ(check(config), nullptr);
}

}  // namespace
}  // namespace capstan
