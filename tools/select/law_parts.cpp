// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/law_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/identify/shape_range.hpp"
#include "capstan/tools/select/arm_terms.hpp"
#include "capstan/tools/support/geometric_grid.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// `count` values in equal steps.
auto in_steps(double from, double to, int count) -> std::vector<double> {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(from + (to - from) * static_cast<double>(i) / (count - 1));
  }
  return values;
}

const std::vector<Shapes> kNoShape = {Shapes{}};

/// More than three turns are motion of a motor before a gear: the weight does not turn with that.
constexpr double kOfALink = 3.0 * 2.0 * std::numbers::pi;

/// Friction by speed and by the way since a reversal.
void add_friction(const MotionRanges& ranges, std::vector<LawPart>& parts) {
  std::vector<Shapes> powers;
  for (const double exponent : {0.05, 0.1, 0.2, 0.33, 0.5, 0.7, 1.5, 2.0, 3.0}) {
    powers.push_back({exponent, ranges.speed});
  }
  std::vector<Shapes> speeds;
  for (const double share : {0.01, 0.02, 0.05, 0.1, 0.2}) {
    speeds.push_back({share * ranges.speed});
  }
  // From the finest that an encoder shows to a fifth of the range, beyond which it is a spring.
  const auto widths = one_by_one(geometric_grid(ranges.half() / 500.0, 0.4 * ranges.half(), 20));
  parts.push_back({"friction_asymmetry", {0, 1}, kNoShape});
  parts.push_back({"friction_asymmetry", {0}, kNoShape});
  parts.push_back({"power_law_friction", {0}, powers});
  parts.push_back({"stribeck_friction", {0}, speeds});
  parts.push_back({"play_friction", {0, 1, 2}, widths});
  parts.push_back({"play_friction", {0}, widths});
  parts.push_back({"play_friction", {2}, widths});
}

/// Orders with two periods within the motion or more, as fewer are no period but a curve that leads astray outside;
/// none where a few places would tell them.
auto periodic_orders(const MotionRanges& ranges) -> std::vector<Shapes> {
  if (!ranges.many_places) {
    return {};
  }
  constexpr double kFewest = 2.0;
  constexpr double kMost = 60.0;
  const double once = std::numbers::pi / ranges.half();
  return one_by_one(geometric_grid(kFewest * once, kMost * once, 60));
}

/// Weight and springs, with the friction that they bring.
void add_loads(const MotionRanges& ranges, AxisKind axis, std::vector<LawPart>& parts) {
  const double span = ranges.half();
  parts.push_back({"spring", {0}, {{ranges.centre(), span}}});
  parts.push_back({"spring", {0, 1}, {{ranges.centre(), span}}});
  std::vector<Shapes> rests;
  for (const double share : in_steps(-1.2, 1.2, 13)) {
    rests.push_back({ranges.centre() + share * span, span});
  }
  std::vector<Shapes> poses;
  for (const double angle : in_steps(0.0, std::numbers::pi * 11.0 / 12.0, 12)) {
    poses.push_back({angle, span});
  }
  const bool link = axis == AxisKind::kRotary && 2.0 * span < kOfALink;
  for (const char* place : {"load_friction", "load_friction_2"}) {
    parts.push_back({place, {2}, rests, "spring"});
    parts.push_back({place, {2, 3}, rests, "spring"});
    if (link) {
      parts.push_back({place, {0}, poses, "gravity"});
      parts.push_back({place, {0, 1}, poses, "gravity"});
    }
  }
  if (link) {
    parts.push_back({"gravity", {0, 1}, kNoShape});
  }
}

/// What another axis's motion brings: alike in all postures, and by posture.
void add_coupling(const MotionRanges& ranges, const KnownAxis& other, AxisKind axis, std::vector<LawPart>& parts) {
  const std::string number = "_axis" + std::to_string(other.axis);
  for (std::size_t coefficient = 0; coefficient < 4; ++coefficient) {
    parts.push_back({"axis_coupling" + number, {coefficient}, kNoShape});
  }
  const bool linear = axis == AxisKind::kLinear;
  const bool both_are_links = (linear || 2.0 * ranges.half() < kOfALink) && (other.linear || other.range < kOfALink);
  if (!both_are_links || (linear && other.linear)) {
    return;
  }
  for (auto& together : other.linear ? reach_parts() : posture_parts(linear)) {
    parts.push_back({(other.linear ? "reach_coupling" : "posture_coupling") + number, together, kNoShape});
  }
}

}  // namespace

auto motion_ranges(const EffortDesign& design) -> MotionRanges {
  std::vector<double> angles;
  std::vector<double> speeds;
  std::vector<double> torques;
  for (const auto& samples : design.samples()) {
    for (const auto& sample : samples) {
      angles.push_back(sample.q1);
      speeds.push_back(std::abs(sample.dq1));
      torques.push_back(std::abs(sample.tau));
    }
  }
  const auto high = [](const std::vector<double>& values) {
    return quantile(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())), 0.99);
  };
  const auto ends = std::minmax_element(angles.begin(), angles.end());
  const Eigen::Map<const Eigen::VectorXd> q1(angles.data(), static_cast<Eigen::Index>(angles.size()));
  return {*ends.first, *ends.second, high(speeds), high(torques), at_many_places(q1)};
}

auto effort_parts(const MotionRanges& ranges, const std::vector<KnownAxis>& others, AxisKind axis)
    -> std::vector<LawPart> {
  std::vector<LawPart> parts = {{"inertia", {0}, kNoShape},
                                {"viscous_friction", {0}, kNoShape},
                                {"coulomb_friction", {0}, kNoShape},
                                {"offset", {0}, kNoShape}};
  add_friction(ranges, parts);
  const auto widths = one_by_one(geometric_grid(ranges.half() / 500.0, 0.4 * ranges.half(), 20));
  parts.push_back({"play_friction_2", {0}, widths});
  parts.push_back({"play_friction_2", {2}, widths});
  add_loads(ranges, axis, parts);
  const auto orders = periodic_orders(ranges);
  for (const char* place : {"angle_periodic", "angle_periodic_2", "angle_periodic_3"}) {
    parts.push_back({place, {0, 1}, orders});
  }
  for (const auto& other : others) {
    add_coupling(ranges, other, axis, parts);
  }
  return parts;
}

auto gear_parts(const MotionRanges& ranges) -> std::vector<LawPart> {
  std::vector<LawPart> parts = {{"gear_torque", {0}, kNoShape},      {"offset", {0}, kNoShape},
                                {"coulomb_friction", {0}, kNoShape}, {"viscous_friction", {0}, kNoShape},
                                {"inertia", {0}, kNoShape},          {"load_friction", {0}, kNoShape},
                                {"load_friction", {1}, kNoShape},    {"torque_saturation", {0}, {{ranges.torque}}}};
  add_friction(ranges, parts);
  parts.push_back({"gravity", {0, 1}, kNoShape});
  parts.push_back({"spring", {0}, {{ranges.centre(), ranges.half()}}});
  parts.push_back({"angle_periodic", {0, 1}, periodic_orders(ranges)});
  return parts;
}

}  // namespace capstan::tools
