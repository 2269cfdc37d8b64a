// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "firmware/config.hpp"

namespace capstan {

enum class ParameterType : std::uint8_t { kReal, kInteger };

/// When a parameter may be changed.
enum class ParameterChange : std::uint8_t {
  kAnyTime,
  kDisarmed,
  kMaintenance,  ///< a safety limit: only without torque, and over the shell only while maintenance is open
};

/// One parameter of a joint. The table feeds shell, storage and documentation; there is no second list.
struct ParameterInfo {
  const char* group;
  const char* name;
  const char* unit;  ///< "1" for pure numbers
  const char* doc;
  ParameterType type;
  ParameterChange change;
  std::uint16_t offset;  ///< into AxisConfig
  std::int32_t minimum;  ///< raw, in the parameter's own type
  std::int32_t maximum;
};

/// There are never more.
inline constexpr std::size_t kMostParameters = 256;

/// Every parameter of a joint, grouped; the law's come from the catalogue.
auto parameters() -> std::span<const ParameterInfo>;

/// The parameter called `group.name`, or nullptr.
auto find_parameter(std::string_view group_dot_name) -> const ParameterInfo*;

auto raw_value(const AxisConfig& config, const ParameterInfo& parameter) -> std::int32_t;
void set_raw_value(AxisConfig& config, const ParameterInfo& parameter, std::int32_t raw);

/// True if the two sets differ in what may change only without torque: model, motor, limits.
auto needs_rest(const AxisConfig& now, const AxisConfig& next) -> bool;

/// The first safety limit in which the two sets differ, or nullptr.
auto changed_safety_limit(const AxisConfig& now, const AxisConfig& next) -> const ParameterInfo*;

/// What no single range can say: nullptr if the set is sound, else a sentence with the cure.
auto check(const AxisConfig& config) -> const char*;
/// What `check` says of the Preisach grid, and where; ok if nothing.
auto check_grid(const AxisConfig& config) -> TableCheck;

}  // namespace capstan
