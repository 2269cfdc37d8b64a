// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/diagnose/preparation.hpp"

namespace capstan::tools {

/// A joint that is another one from some row on: no one law holds over all of its log.
struct ChangedJoint {
  LawForm law;              ///< tells the two parts apart best; its numbers are each part's own
  Eigen::Index row = 0;     ///< of all samples: the first that the second law fits better
  double one_leaves = 0.0;  ///< rms that one law leaves of rows that it has not seen, in the target's unit
  double two_leave = 0.0;   ///< the same of a law for each part
  std::vector<MovedParameter> moved = {};  ///< from the first part to the second, most spreads first
};

/// Whether one law holds over all of the log (after Chow 1960 and Andrews 1993). Each of the laws, and the usual one
/// with a gap, is fitted once to all of the log and once to each part before and after a split, on half of its slices;
/// these choose law and split, and the other half says what is left. Nothing where two laws do not leave far less there
/// for certain (kTwoLawsLeave). An effect that goes by the time and explains the change is in one of the laws.
auto joint_that_changed(const Preparation& p, const std::vector<LawForm>& laws) -> std::optional<ChangedJoint>;

/// Takes back whatever was said of a joint as if one law held, and says that the joint has changed, when, by what, and
/// the cure. What one law leaves then is no noise: the floor is what two leave, if that is less.
void say_changed(const Preparation& p, const ChangedJoint& changed, Diagnosis& d);

/// The longer part of a log in which the joint has changed, and of about equal ones the later: the joint as it is now.
auto longer_part(const AxisLog& log, Eigen::Index changes_at) -> AxisLog;

/// Puts what the longer part gives by itself in the place of what was found for all of the log: law, errors and floor.
/// The verdict stays. Nothing where that part alone is not fit for a diagnosis.
void take_law_of_part(Diagnosis part, const AxisLog& log, Diagnosis& d);

}  // namespace capstan::tools
