// SPDX-License-Identifier: Apache-2.0
// Parameters whose values are numbers of joints.
#include "capstan/firmware/parameters/parameters.hpp"

namespace capstan {
namespace {

constexpr auto kNoJoint = static_cast<std::size_t>(std::int32_t{-1});
constexpr std::size_t kCoupledTo = offsetof(AxisConfig, coupled_to);
constexpr std::size_t kPitch = offsetof(AxisConfig, tip) + offsetof(TipConfig, pitch);

auto names_joint(const ParameterInfo& parameter) -> bool {
  return (parameter.offset >= kCoupledTo && parameter.offset < kCoupledTo + kMostOthers * sizeof(std::int32_t)) ||
         parameter.offset == kPitch;
}

}  // namespace

auto impossible_joint(const AxisConfig& config, std::size_t axis, std::size_t axes) -> const ParameterInfo* {
  for (const ParameterInfo& parameter : parameters()) {
    const auto joint = static_cast<std::size_t>(names_joint(parameter) ? raw_value(config, parameter) : -1);
    if (joint == axis || (joint >= axes && joint != kNoJoint)) {
      return &parameter;
    }
  }
  return nullptr;
}

}  // namespace capstan
