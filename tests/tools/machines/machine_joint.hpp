// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools::machines {

/// What of a log is to be explained.
enum class Kind : std::uint8_t { kAngle, kEffort, kGear };

/// A measured joint or axis.
struct Joint {
  std::string name, machine;  ///< machine: logs of one are left out together
  Kind kind = Kind::kAngle;
  AxisLog log;
};

/// Every joint and axis with something to explain, of the CSV files of a folder.
auto joints_in(const std::string& folder) -> std::vector<Joint>;

/// Errors of two plain fits: of the plainest one, and of the one that does best on the last quarter of the first rows,
/// fitted to the first three, then fitted to all of these; rms on the rows from there to `end`, in degrees, or in % of
/// the target's rms there.
struct PlainResult {
  std::string name;
  double plainest = 0.0, simple = 0.0;
};

auto plain_result(const Joint& joint, Eigen::Index rows, Eigen::Index end) -> PlainResult;

/// What a law leaves there.
auto error_of(const JointFile& law, const Joint& joint, Eigen::Index rows, Eigen::Index end) -> double;

/// Diagnoses the first rows.
auto diagnosis_of(const Joint& joint, Eigen::Index rows) -> Diagnosis;
/// What the law that was delivered leaves; `plainest` where there is none.
auto error_of(const Diagnosis& d, const Joint& joint, Eigen::Index rows, Eigen::Index end, double plainest) -> double;

}  // namespace capstan::tools::machines
