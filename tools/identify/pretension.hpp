// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// Numbers of a joint's drawing, one of which puts its pretension into newtons.
struct TendonDrawing {
  std::optional<double> radius_m = {};           ///< of the motor's pulley, r1
  std::optional<double> stiffness_n_per_m = {};  ///< E A / L of one tendon; the mean of both where they differ
};

/// Logs in which the joint hardly followed its motor: the tip was held. Their friction is no free motion's.
/// @param beta  joint angle per motor angle
auto is_held(const AxisLog& log, double beta) -> bool;

/// What a law with tendons, fitted to logs, tells of their pretension. Nothing of another law.
/// @param held  a log with the tip held was among them, without which eta and pretension are not told apart
auto pretension_of(const JointFile& joint, bool held) -> std::optional<PretensionNumbers>;

/// Puts the pretension into newtons where the drawing has a number for it, by the radius before the stiffness; else as
/// it was.
void put_into_newtons(const TendonDrawing& drawing, JointFile& joint);

/// The pretension with its interval, or what is told of it and which number is lacking, in one sentence.
auto pretension_sentence(const PretensionNumbers& numbers) -> std::string;

/// A number with half the width of its 95 % interval.
struct Gauged {
  double value = 0.0;
  double half = 0.0;
};

/// Pretension at another time of a joint, from a free motion's loop alone.
struct PretensionDrift {
  Gauged times;  ///< of the healthy joint's: the tendons' friction, and so their tension while eta is the same
  PretensionNumbers now;
  std::string unit;  ///< of the two below: N, or Nm where the radius is lacking, or 1 where eta is, too
  Gauged pretension;
  Gauged change;
};

/// Compares the loops of two times. Nothing where a law has no tendons or a motion no loop, or where torque and width
/// have not changed alike, as they do with the pretension alone.
/// @param now  the loop of the later time, @param parts what its torque is made of, if known
auto pretension_drift(const JointFile& healthy, const Loop& now, const std::optional<TorqueParts>& parts)
    -> std::optional<PretensionDrift>;

/// The tendons' friction number over the healthy joint's, where that is known and width and torque have changed as they
/// do with it alone. Nothing where they have changed as with the pretension alone.
auto friction_number_drift(const JointFile& healthy, const Loop& now) -> std::optional<Gauged>;
auto friction_number_sentence(const PretensionNumbers& healthy, const Gauged& times) -> std::string;

/// "pretension is 22.1 [21.3, 22.9] N, 5.6 [4.8, 6.4] N less than the healthy joint's"
auto drift_sentence(const PretensionDrift& drift) -> std::string;

}  // namespace capstan::tools
