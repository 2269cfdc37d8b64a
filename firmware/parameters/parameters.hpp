// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

enum class ParameterType : std::uint8_t {
  kReal,
  kWhole,    ///< a Q24 that holds a whole number, for it is a law's
  kInteger,  ///< not a Q24
};

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

/// There are never more: those of a Preisach grid of so many levels, and 307 others. A multiple of 32.
inline constexpr std::size_t kMostParameters =
    (307 + ForceConfig::kLevels * (ForceConfig::kLevels + 3) / 2 + 31) / 32 * 32;

/// Every parameter of a joint, grouped; the law's come from the catalogue.
auto parameters() -> std::span<const ParameterInfo>;

/// The parameter called `group.name`, or nullptr.
auto find_parameter(std::string_view group_dot_name) -> const ParameterInfo*;

/// What a law reads of a parameter that is kWhole, and in its range.
constexpr auto nearest_whole(Q24 value) -> Q24 {
  return Q24::from_int(low_word_rounded<Q24::kFrac>(value.raw()));
}

auto raw_value(const AxisConfig& config, const ParameterInfo& parameter) -> std::int32_t;
void set_raw_value(AxisConfig& config, const ParameterInfo& parameter, std::int32_t raw);

/// True if the two sets differ in what may change only without torque: model, motor, limits.
auto needs_rest(const AxisConfig& now, const AxisConfig& next) -> bool;

/// The first safety limit in which the two sets differ, or nullptr.
auto changed_safety_limit(const AxisConfig& now, const AxisConfig& next) -> const ParameterInfo*;

/// The first parameter that names a joint, and names this one itself or one that a board of so many has not; nullptr if
/// there is none.
auto impossible_joint(const AxisConfig& config, std::size_t axis, std::size_t axes) -> const ParameterInfo*;

/// What a set may change.
enum class Rights : std::uint8_t {
  kOperator,     ///< everything but the safety limits
  kMaintenance,  ///< those too: maintenance is open, or the set comes from the joint's own storage
};

/// Why a set of parameters was not taken, or that it was.
struct SetAnswer {
  enum class Refusal : std::uint8_t {
    kNone,          ///< it was taken
    kNeedsRest,     ///< model, motor and limits change only without torque
    kSafetyLimit,   ///< `limit` differs, and the rights do not reach so far
    kNoSuchJoint,   ///< `limit` names the joint itself, or one that the board has not
    kInconsistent,  ///< the numbers contradict each other: `reason`, of the Preisach grid at `grid`
    kBusy,          ///< the cycle has not taken the last set yet
  };
  Refusal refusal = Refusal::kNone;
  std::size_t axis = 0;  ///< the first joint that it is refused for
  const ParameterInfo* limit = nullptr;
  const char* reason = nullptr;  ///< a sentence that ends in its own cure
  TableCheck grid{};
  [[nodiscard]] auto taken() const -> bool { return refusal == Refusal::kNone; }
};

/// Whether one joint may change from one set to the other. @param live  torque is on
auto judge_change(const AxisConfig& now, const AxisConfig& next, Rights rights, bool live) -> SetAnswer;

/// What no single range can say: nullptr if the set is sound, else a sentence with the cure.
auto check(const AxisConfig& config) -> const char*;
/// What `check` says of the Preisach grid, and where; ok if nothing.
auto check_grid(const AxisConfig& config) -> TableCheck;

}  // namespace capstan
