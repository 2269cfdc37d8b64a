// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/effort_replay.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/replay/board_effort_law.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Every row that the axis's channels have in common: who replays a log has to see it.
struct EffortRows {
  CsvLog csv;
  AxisLog log;
};

auto effort_rows(const CsvLog& csv, int axis, const EffortLaw& law) -> EffortRows {
  const auto slash = law.target.find('/');
  const std::string quantity = slash == std::string::npos ? law.target : law.target.substr(slash + 1);
  AxisRequest request;
  request.axis = axis;
  request.effort = !law.of_gear();
  request.force = law.of_gear();
  request.target = axis_column(axis, quantity);
  request.every_row = true;
  std::vector<std::string> notes;
  EffortRows rows{.csv = common_rows_of(csv, request, notes), .log = {}};
  rows.log = read_axis(rows.csv, request);
  rows.log.warnings.insert(rows.log.warnings.end(), notes.begin(), notes.end());
  return rows;
}

/// @param name  "dist" of "axis0/tau_Nm": "axis0/tau_dist_Nm"
auto sibling(const std::string& target, const std::string& name) -> std::string {
  const auto unit = target.find_last_of('_');
  return unit == std::string::npos ? target + "_" + name : target.substr(0, unit) + "_" + name + target.substr(unit);
}

template <typename Scalar, typename ToScalar, typename ToDouble>
auto run_on(const AxisLog& log, Disturbance<Scalar> disturbance, ToScalar&& to_scalar, ToDouble&& to_double)
    -> BoardEffort {
  const Eigen::Index rows = log.samples();
  const Eigen::Index delay = disturbance.delay();
  BoardEffort result{Eigen::VectorXd::Zero(rows), Eigen::VectorXd::Zero(rows), 0, delay};
  for (Eigen::Index i = 0; i < rows; ++i) {
    Measured<Scalar> now;
    now.q1 = to_scalar(log.q1_rad[i]);
    now.tau = to_scalar(log.effort[i]);
    if (log.temperature_c.size() > 0) {
      now.temperature = to_scalar(log.temperature_c[i]);
    }
    const DisturbanceEstimate<Scalar> estimate = disturbance.update(now);
    if (i >= 2 * delay) {
      result.law[i - delay] = to_double(estimate.law_nm);
      result.disturbance[i] = to_double(estimate.disturbance_nm);
      result.saturated += estimate.known ? 0 : 1;
    }
  }
  if (rows > 2 * delay) {  // no motion is known from both sides at the ends: as the nearest that is
    result.law.head(delay).setConstant(result.law[delay]);
    result.law.tail(delay).setConstant(result.law[rows - 1 - delay]);
  }
  return result;
}

auto to_fixed(const BoardEffortLaw& law) -> Disturbance<Q24> {
  const auto rounded = [](double value) { return Q24::from_double(value); };
  TorqueLawParameters<Q24> fixed;
  std::transform(law.law.coefficients.begin(), law.law.coefficients.end(), fixed.coefficients.begin(), rounded);
  std::transform(law.law.shapes.begin(), law.law.shapes.end(), fixed.shapes.begin(), rounded);
  return {
      SamplePeriod<Q24>(kFirmwareRateHz), fixed,
      MotionView<Q24>{rounded(law.view.window_s), rounded(law.view.standstill_rad_s), rounded(law.view.letting_go_s)}};
}

}  // namespace

auto run_board_effort(const AxisLog& log, const BoardEffortLaw& law, Arithmetic arithmetic) -> BoardEffort {
  if (arithmetic == Arithmetic::kDouble) {
    const auto same = [](double x) { return x; };
    return run_on(log, Disturbance<double>(SamplePeriod<double>(log.period_s), law.law, law.view), same, same);
  }
  if (std::abs(log.rate_hz() / kFirmwareRateHz - 1.0) > 0.01) {
    throw Refusal(log.name + ": the log runs at " + rounded(log.rate_hz()) +
                  " Hz and the firmware's arithmetic is made for " + std::to_string(kFirmwareRateHz) +
                  " Hz; replay it with --arithmetic double");
  }
  return run_on(
      log, to_fixed(law), [](double x) { return Q24::from_double(x); }, [](Q24 x) { return x.to_double(); });
}

namespace {

auto law_in_fixed_point(const EffortLaw& law, const std::string& name) -> BoardEffortLaw {
  try {
    return board_effort_law(law, name);
  } catch (const BadInput& reason) {
    throw Refusal(std::string(reason.what()) + "; to run it over a log all the same, add --arithmetic double");
  }
}

}  // namespace

auto estimate_column(const std::string& target) -> std::string {
  return sibling(target, "est");
}

auto replay_effort(const CsvLog& csv, int axis, const EffortLaw& law) -> EffortReplay {
  auto [rows, log] = effort_rows(csv, axis, law);
  std::string text = rows.text_with({estimate_column(log.target)}, {run_effort_law({log}, law)});
  return {std::move(text), std::move(log)};
}

auto replay_board_effort(const CsvLog& csv, int axis, const EffortLaw& law, const std::string& name)
    -> BoardEffortReplay {
  const BoardEffortLaw board = law_in_fixed_point(law, name);
  auto [rows, log] = effort_rows(csv, axis, law);
  BoardEffort effort = run_board_effort(log, board, Arithmetic::kFixed);
  std::string text =
      rows.text_with({estimate_column(log.target), sibling(log.target, "dist")}, {effort.law, effort.disturbance});
  return {{std::move(text), std::move(log)}, std::move(effort)};
}

}  // namespace capstan::tools
