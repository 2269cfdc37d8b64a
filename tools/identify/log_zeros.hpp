// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// By how much a log's joint angle or effort is counted from another zero than the first log's, with its 95 % half
/// width, in the unit of what was measured.
struct LogZero {
  double shift = 0.0, half = 0.0;
  /// Twice what its interval says at least: the law that it was found by is a rough one.
  [[nodiscard]] auto is_certain() const -> bool { return std::abs(shift) > 2.0 * half; }
};

/// By a flexible law that all logs share: a cubic of the motor's angle, gaps of many widths, its torque, speed and
/// acceleration. One for each log, the first 0. @pre logs of a joint's angle, or of an effort
auto log_zeros(const std::vector<AxisLog>& logs) -> std::vector<LogZero>;
/// By what a law leaves of the logs, one below the other.
auto log_zeros_beside(const std::vector<AxisLog>& logs, const Eigen::VectorXd& residual) -> std::vector<LogZero>;

/// Counts logs of one joint's angle from the first one's zero, where another is certain: by the rough law, and then by
/// the one that left_by_law fits to them, which gives what it leaves of the logs, one below the other. Logs in which
/// the joint goes another way with its motor stay as they are, as with its tip held. Logs of an effort over the same
/// angles are counted from one zero by the rough law.
/// @return what was taken off, a sentence for each log
auto count_from_one_zero(std::vector<AxisLog>& logs,
                         const std::function<Eigen::VectorXd(const std::vector<AxisLog>&)>& left_by_law)
    -> std::vector<std::string>;
/// The same, where the law of this form is fitted to them.
auto count_from_one_zero(std::vector<AxisLog>& logs, const LawForm& form) -> std::vector<std::string>;

}  // namespace capstan::tools
