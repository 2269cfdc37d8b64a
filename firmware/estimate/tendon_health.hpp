// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/firmware/safety/code_info.hpp"
#include "capstan/firmware/safety/warnings.hpp"

namespace capstan {

/// What became of a joint's tendons. Numbers are append-only.
enum class TendonHealth : std::uint8_t {
  kNothing = 0,  ///< nothing is wrong, or nothing is known
  kLoose = 1,
  kSlack = 2,
  kWorn = 3,
  kFrayed = 4,
  kPlay = 5,
  kZeroMoved = 6,
  kSlips = 7,
  kBroken = 8,
};

using TendonHealthInfo = CodeInfo<TendonHealth>;

/// One table for shell and documentation.
inline constexpr std::array<TendonHealthInfo, 9> kTendonHealthTable = {{
    {TendonHealth::kNothing, "nothing", "nothing has changed, or the expected errors are not set",
     "set monitor.joint_rms and monitor.torque_rms"},
    {TendonHealth::kLoose, "loose", "the tendons rub less and the joint follows as before: pretension is lost",
     "tension them again and identify the law again"},
    {TendonHealth::kSlack, "slack", "less than a third of the tendons' friction is left: they hang, or one broke",
     "do not use the joint; look at both tendons"},
    {TendonHealth::kWorn, "worn", "the tendons rub more: wear, dirt, too much pretension, or a tip that touches",
     "clean or replace them, and identify the law again"},
    {TendonHealth::kFrayed, "frayed",
     "the tendons rub less, and the joint's zero or stiffness has changed: strands of one are torn, or its clamp slid",
     "look at tendons and clamps, and replace what is worn before it breaks"},
    {TendonHealth::kPlay, "play", "the joint reverses later than before, at the same friction: a gap",
     "look for loose clamps, pins and pulleys"},
    {TendonHealth::kZeroMoved, "zero_moved",
     "motor and joint stand differently to each other by a constant angle: a pulley slipped once, or a zero was set",
     "tighten the pulley's clamp, and set the zero again"},
    {TendonHealth::kSlips, "slips", "the zero goes on moving: a pulley slips on its shaft, or one side warms up",
     "tighten the pulley's clamp, and identify the joint with a thermometer"},
    {TendonHealth::kBroken, "broken", "the tendons hardly rub any more and the joint no longer follows the motor",
     "replace the tendon"},
}};
static_assert(in_order(kTendonHealthTable));

constexpr auto info(TendonHealth health) -> const TendonHealthInfo& {
  return kTendonHealthTable[static_cast<std::size_t>(health)];
}

/// Names what changed in a joint's loop between motor and joint, a stretch of motion at a time.
///
/// Under a free tip both tendons slide, so friction is proportional to their tension, I tanh(eta / 2) of capstan
/// friction, and the law, which is driven by the measured torque, follows what the tension does to the joint. What the
/// tension can not do is seen in the joint's own sensor: a loop that is wider than the law says (something gives), a
/// zero that moved. So friction and sensor together tell the causes apart; friction alone tells `loose`, `slack` and
/// `worn`.
class TendonJudge {
 public:
  /// Means over a stretch, to and fro.
  struct Stretch {
    Q24 friction_nm{};       ///< half of the torque to less that fro
    Q24 healthy_nm{};        ///< of the joint as it was identified; 0: not known
    Q24 motors_nm{};         ///< of that the motor's own
    Q24 loop_rad{};          ///< half width of the loop between motor and joint, at the joint, by the law
    bool has_joint = false;  ///< the joint's sensor gave both that follow
    Q24 wider_rad{};         ///< how much the loop is wider than that
    Q24 shifted_rad{};       ///< where the joint's zero is against the law's
  };
  /// @param warnings  of the monitor of the law: what they say has changed is what has a cause
  void rt_judge(const MonitorConfig& config, const Stretch& stretch, WarningSet warnings);

  /// Named by two stretches in a row; the last that was, until they agree upon another.
  [[nodiscard]] auto health() const -> TendonHealth { return health_; }
  /// The tendons' friction over that of the healthy joint: while eta is the same, their tension over what it was. 0
  /// until the first stretch.
  [[nodiscard]] auto tension() const -> Q24 { return tension_; }
  /// The same in N, and half of its 95 % interval; 0 where the healthy joint's is not known.
  [[nodiscard]] auto pretension_n() const -> Q24 { return pretension_n_; }
  [[nodiscard]] auto pretension_95_n() const -> Q24 { return pretension_95_n_; }

 private:
  [[nodiscard]] auto rt_cause(const MonitorConfig& config, const Stretch& stretch, WarningSet warnings) const
      -> TendonHealth;

  TendonHealth health_ = TendonHealth::kNothing;
  TendonHealth last_ = TendonHealth::kNothing;
  Q24 tension_;
  Q24 pretension_n_;
  Q24 pretension_95_n_;
  Q24 loop_rad_;   // before anything was wrong
  Q24 moved_rad_;  // where the zero was when it had moved
};

}  // namespace capstan
