// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/identify/bounded_search.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

enum Unknown : Eigen::Index { kEtaTop, kEtaBottom, kPretension, kRatio, kFriction, kOffset, kUnknowns };
constexpr std::array kNames = {"eta_top", "eta_bottom", "pretension", "ratio", "friction", "offset"};
constexpr std::array kUnits = {"1", "1", "Nm", "1", "Nm", "Nm"};
using Theta = Eigen::Matrix<double, kUnknowns, 1>;

/// Rows of all strokes, one below the other, both torques counted positive where the motor pulls.
struct StrokeRows {
  Eigen::VectorXd in, out, q1;
  std::vector<double> sign;
  Blocks strokes;
};

/// Turning points of q1: a return of more than the threshold makes one.
auto turning_points(const Eigen::VectorXd& q1, double threshold) -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> points = {0};
  Eigen::Index extreme = 0;
  int direction = 0;
  for (Eigen::Index i = 1; i < q1.size(); ++i) {
    const double beyond = q1[i] - q1[extreme];
    if (direction == 0 ? std::abs(beyond) > threshold : beyond * direction < -threshold) {
      if (direction != 0) {
        points.push_back(extreme);
      }
      direction = beyond > 0.0 ? 1 : -1;
      extreme = i;
    } else if (direction == 0 || beyond * direction > 0.0) {
      extreme = direction == 0 ? extreme : i;
    }
  }
  points.push_back(q1.size() - 1);
  return points;
}

/// One way of the motor in one log, and the part of it that is fitted.
struct PullStroke {
  std::size_t log;
  Eigen::Index first, begin, end;
  double sign;
};

/// At first the part of each stroke where the output goes with the motor: from a tenth of its peak on, so that both
/// tendons surely move in their whole length (or one is slack), to shortly before the turn, where friction begins to
/// change sign.
auto pulling_strokes(const std::vector<AxisLog>& logs) -> std::vector<PullStroke> {
  constexpr double kFrom = 0.1;
  constexpr double kBeforeTurn = 0.04;
  constexpr Eigen::Index kFewest = 50;
  std::vector<PullStroke> strokes;
  for (std::size_t number = 0; number < logs.size(); ++number) {
    const auto& log = logs[number];
    const double peak = log.effort.cwiseAbs().maxCoeff();
    const auto points = turning_points(log.q1_rad, 0.05 * (log.q1_rad.maxCoeff() - log.q1_rad.minCoeff()));
    // The first stroke does not begin with a turn: how far each tendon moves then is anybody's guess.
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
      const Eigen::Index length = points[k + 1] - points[k];
      const double s = log.q1_rad[points[k + 1]] > log.q1_rad[points[k]] ? 1.0 : -1.0;
      const auto end = points[k + 1] - static_cast<Eigen::Index>(kBeforeTurn * static_cast<double>(length));
      Eigen::Index begin = end;
      // Averaged over a little, for the sensor's noise must not choose the row.
      const Eigen::Index window = std::max<Eigen::Index>(1, length / 200);
      while (begin - window > points[k] && s * log.effort.segment(begin - window, window).mean() > kFrom * peak) {
        begin -= window;
      }
      if (end - begin >= kFewest) {
        strokes.push_back({number, points[k], begin, end, s});
      }
    }
  }
  return strokes;
}

auto rows_of(const std::vector<AxisLog>& logs, const std::vector<PullStroke>& strokes) -> StrokeRows {
  StrokeRows rows;
  for (const auto& stroke : strokes) {
    const auto before = static_cast<Eigen::Index>(rows.sign.size());
    const Eigen::Index length = stroke.end - stroke.begin;
    rows.strokes.push_back({before, before + length});
    rows.sign.insert(rows.sign.end(), static_cast<std::size_t>(length), stroke.sign);
  }
  rows.in.resize(static_cast<Eigen::Index>(rows.sign.size()));
  rows.out.resize(rows.in.size());
  rows.q1.resize(rows.in.size());
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const auto& [number, first, begin, end, s] = strokes[k];
    const Eigen::Index at = rows.strokes[k].begin;
    rows.in.segment(at, end - begin) = s * logs[number].tau_nm.segment(begin, end - begin);
    rows.out.segment(at, end - begin) = s * logs[number].effort.segment(begin, end - begin);
    rows.q1.segment(at, end - begin) = s * logs[number].q1_rad.segment(begin, end - begin);
  }
  return rows;
}

auto line_of(const Theta& theta, double s) -> TransmissionLine<double> {
  const bool forward = s > 0.0;
  return {theta[forward ? kEtaTop : kEtaBottom], theta[forward ? kEtaBottom : kEtaTop], theta[kPretension],
          theta[kRatio]};
}
auto tendon_torque(const Theta& theta, const StrokeRows& rows, Eigen::Index i) -> double {
  return rows.in[i] - theta[kFriction] - rows.sign[static_cast<std::size_t>(i)] * theta[kOffset];
}

auto simulate_rows(const Theta& theta, const StrokeRows& rows) -> Eigen::VectorXd {
  const auto forward = line_of(theta, 1.0);
  const auto backward = line_of(theta, -1.0);
  Eigen::VectorXd out(rows.in.size());
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const auto& line = rows.sign[static_cast<std::size_t>(i)] > 0.0 ? forward : backward;
    out[i] = line.at(tendon_torque(theta, rows, i)).torque;
  }
  return out;
}

auto sensitivities(const Theta& theta, const StrokeRows& rows) -> Eigen::MatrixXd {
  Eigen::MatrixXd columns(rows.in.size(), Eigen::Index{kUnknowns});
  for (Eigen::Index k = 0; k < kUnknowns; ++k) {
    const double step = 1e-5 * std::max(std::abs(theta[k]), 0.01);
    Theta up = theta;
    Theta down = theta;
    up[k] += step;
    down[k] -= step;
    columns.col(k) = (simulate_rows(up, rows) - simulate_rows(down, rows)) / (2.0 * step);
  }
  return columns;
}

/// Slope dout / din over the lowest and the highest part of all strokes of one sign, for a place to start.
struct Slopes {
  double low = 0.9, high = 0.3;
};
auto end_slopes(const StrokeRows& rows, double s) -> Slopes {
  std::array<double, 2> sxy{}, sxx{};
  for (const auto& stroke : rows.strokes) {
    if (rows.sign[static_cast<std::size_t>(stroke.begin)] != s) {
      continue;
    }
    const Eigen::Index part = std::max<Eigen::Index>(2, stroke.size() / 5);
    for (const std::size_t which : {0U, 1U}) {
      const Eigen::Index begin = which == 0 ? stroke.begin : stroke.end - part;
      const Eigen::VectorXd x = rows.in.segment(begin, part).array() - rows.in.segment(begin, part).mean();
      sxy[which] += x.dot(rows.out.segment(begin, part));
      sxx[which] += x.squaredNorm();
    }
  }
  const auto slope = [&](std::size_t i, double otherwise) {
    return sxx[i] > 0.0 ? std::clamp(sxy[i] / sxx[i], 0.01, 4.0) : otherwise;
  };
  return {slope(0, 0.9), slope(1, 0.3)};
}

auto start_of(const StrokeRows& rows) -> Theta {
  const Slopes up = end_slopes(rows, 1.0);
  const Slopes down = end_slopes(rows, -1.0);
  const double ratio = std::clamp(0.5 * (up.low + down.low), 0.05, 4.0);
  const auto eta = [&](double high) { return std::clamp(-std::log(high / ratio), 0.05, 2.9); };
  const double peak = rows.in.maxCoeff();
  Theta theta;
  theta << eta(up.high), eta(down.high), 0.5 * peak * mean_decay(eta(up.high)), ratio, 0.0, 0.0;
  return theta;
}

/// What the numbers of the law may be.
constexpr double kOpen = std::numeric_limits<double>::infinity();
const Theta kLeast = {1e-3, 1e-3, 0.0, 1e-3, -kOpen, -kOpen};
const Theta kMost = {3.0, 3.0, 8.0, 4.0, kOpen, kOpen};

/// A number that ended at a limit of its range is not identified.
auto at_limit(const Theta& theta, Eigen::Index i) -> bool {
  return theta[i] <= kLeast[i] || theta[i] >= kMost[i];
}

/// What the law leaves of the output.
class LineResidual final : public NonlinearResidual {
 public:
  explicit LineResidual(const StrokeRows& rows) : rows_(rows) {}
  auto at(const Eigen::VectorXd& parameters) -> Eigen::VectorXd override {
    theta_ = parameters;
    return rows_.out - simulate_rows(theta_, rows_);
  }
  auto jacobian() -> Eigen::MatrixXd override { return -sensitivities(theta_, rows_); }

 private:
  const StrokeRows& rows_;
  Theta theta_;
};

/// The law that fits best near a start; `fit` gets the covariance.
auto solve_rows(const StrokeRows& rows, const Theta& start, LinearFit& fit) -> Theta {
  LineResidual residual(rows);
  const Theta theta = least_squares_within({kLeast, kMost}, start, residual).parameters;
  fit = fit_columns(sensitivities(theta, rows), rows.out - simulate_rows(theta, rows), rows.strokes,
                    std::vector<Sign>(kUnknowns, Sign::kAny));
  return theta;
}

/// Extends each stroke backward as far as the law holds: what comes before is phase II, where the pushed tendon does
/// not move in its whole length yet. Returns whether any grew.
auto grow(const std::vector<AxisLog>& logs, const Theta& theta, std::vector<PullStroke>& strokes) -> bool {
  constexpr double kHolds = 0.01;  // of the largest torque: several times the slope error that is left after a round
  bool grew = false;
  for (auto& stroke : strokes) {
    const auto& log = logs[stroke.log];
    const double bound = kHolds * log.effort.cwiseAbs().maxCoeff();
    const auto line = line_of(theta, stroke.sign);
    const Eigen::Index window = std::max<Eigen::Index>(1, (stroke.end - stroke.first) / 200);
    while (stroke.begin - window > stroke.first) {
      double sum = 0.0;
      for (Eigen::Index i = stroke.begin - window; i < stroke.begin; ++i) {
        const double x = stroke.sign * (log.tau_nm[i] - theta[kOffset]) - theta[kFriction];
        sum += stroke.sign * log.effort[i] - line.at(x).torque;
      }
      if (std::abs(sum) > bound * static_cast<double>(window)) {
        break;
      }
      stroke.begin -= window;
      grew = true;
    }
  }
  return grew;
}

/// r1^2 Kn of the tendon pulled in direction s, from the slope dq1 / dtau while the other one is slack, (2.26).
auto stiffness(const Theta& theta, const LinearFit& fit, const StrokeRows& rows, double s, const char* name)
    -> std::optional<ForceParameter> {
  constexpr Eigen::Index kFewest = 50;
  const auto line = line_of(theta, s);
  std::vector<Eigen::Index> slack;
  Blocks blocks;
  for (const auto& stroke : rows.strokes) {
    const auto first = static_cast<Eigen::Index>(slack.size());
    for (Eigen::Index i = stroke.begin; i < stroke.end && rows.sign[static_cast<std::size_t>(stroke.begin)] == s; ++i) {
      const double x = tendon_torque(theta, rows, i);
      if (x > 0.0 && line.at(x).one_slack) {
        slack.push_back(i);
      }
    }
    const Eigen::Index count = static_cast<Eigen::Index>(slack.size()) - first;
    if (count >= 2) {  // halves, so that one stroke has an interval too
      blocks.push_back({first, first + count / 2});
      blocks.push_back({first + count / 2, first + count});
    }
  }
  if (static_cast<Eigen::Index>(slack.size()) < kFewest) {
    return std::nullopt;
  }
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(slack.size()), 2);
  columns.col(0) = rows.in(slack);
  columns.col(1).setOnes();
  const LinearFit slope = fit_columns(columns, rows.q1(slack), blocks, {Sign::kAny, Sign::kAny});
  const Eigen::Index which = s > 0.0 ? kEtaTop : kEtaBottom;
  const double mean = mean_decay(theta[which]);
  const double by_eta = (mean_decay(theta[which] + 1e-5) - mean_decay(theta[which] - 1e-5)) / 2e-5 / mean;
  const double value = mean / slope.theta[0];
  return ForceParameter{
      name, "Nm/rad", value,
      std::abs(value) * std::hypot(half_interval(slope, 0) / slope.theta[0], by_eta * half_interval(fit, which))};
}

/// The law run over every sample, the motor's friction taken out by its direction.
void judge_run(const std::vector<AxisLog>& logs, PullPushFit& result) {
  double squares = 0.0;
  for (const auto& log : logs) {
    PullPush<double> law(result.law);
    SampleConditioner<double> conditioner(SamplePeriod<double>(0.001), ConditionerShape<double>{});
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      const bool forward = conditioner.update(log.q1_rad[i], log.tau_nm[i]).forward;
      const double tau = log.tau_nm[i] - result.offset_nm - (forward ? 1.0 : -1.0) * result.friction_nm;
      const auto estimate = law.update(tau, forward);
      squares += estimate.known ? std::pow(estimate.force - log.effort[i], 2.0) : 0.0;
      result.samples += estimate.known ? 1 : 0;
      result.full_scale_nm = std::max(result.full_scale_nm, std::abs(log.effort[i]));
    }
  }
  result.rmse_nm = std::sqrt(squares / static_cast<double>(std::max(1L, result.samples)));
}

}  // namespace

auto fit_pull_push(const std::vector<AxisLog>& logs) -> PullPushFit {
  auto strokes = pulling_strokes(logs);
  StrokeRows rows = rows_of(logs, strokes);
  const auto has = [&](double s) { return std::find(rows.sign.begin(), rows.sign.end(), s) != rows.sign.end(); };
  if (rows.strokes.size() < 2 || !has(1.0) || !has(-1.0)) {
    throw Refusal("the logs do not pull in both directions with the joint torque following; record slow triangles of " +
                  std::string("torque with the tip locked, far enough that each tendon goes slack in turn"));
  }
  LinearFit fit;
  Theta theta = solve_rows(rows, start_of(rows), fit);
  constexpr int kGrowths = 8;
  for (int round = 0; round < kGrowths && grow(logs, theta, strokes); ++round) {
    rows = rows_of(logs, strokes);
    theta = solve_rows(rows, theta, fit);
  }
  PullPushFit result;
  result.law = {theta[kEtaTop], theta[kEtaBottom], theta[kPretension], theta[kRatio], 0.0, 1.0};
  result.friction_nm = theta[kFriction];
  result.offset_nm = theta[kOffset];
  // A number whose interval is as wide as this is not known; a column of nothing has no interval at all.
  const std::array<double, kUnknowns> enough = {
      0.25, 0.25, 0.5 * std::max(theta[kPretension], 0.005), 0.25 * theta[kRatio], 1e9, 1e9};
  for (Eigen::Index k = 0; k < kUnknowns; ++k) {
    const auto i = static_cast<std::size_t>(k);
    result.parameters.push_back({kNames[i], kUnits[i], theta[k], half_interval(fit, k)});
    if (at_limit(theta, k) || fit.tolerance[k] < 1e-7 || half_interval(fit, k) > enough[i]) {
      result.undetermined.emplace_back(kNames[i]);
    }
  }
  for (const auto& [s, name] : {std::pair{1.0, "stiffness_top"}, std::pair{-1.0, "stiffness_bottom"}}) {
    // Without the pretension nobody knows on which rows a tendon was slack.
    const auto found = at_limit(theta, kPretension) ? std::nullopt : stiffness(theta, fit, rows, s, name);
    if (found) {
      result.parameters.push_back(*found);
    } else {
      result.undetermined.emplace_back(name);
    }
  }
  result.cure =
      "pull slowly and farther in both directions with the tip locked, until the joint torque rises less steeply, "
      "and not so fast that less than a tenth of the stroke lies before that";
  result.notes.push_back(std::to_string(rows.strokes.size()) + " strokes, " + std::to_string(rows.in.size()) +
                         " samples with the output following");
  judge_run(logs, result);
  result.error_bar = force_error_bar(logs, force_law_of(result), {});
  return result;
}

}  // namespace capstan::tools
