// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/model/disturbance.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Window of the local cubic, s. On the shared measured efforts (13 joints, 95 to 250 Hz, November 2026) laws predict
/// alike with 0.12 and 0.18 s; with 0.06 s what is left of the encoder in the acceleration costs a fifth.
constexpr double kWindowS = 0.12;
constexpr double kStandstillShare = 0.02;

auto half_width(double window_s, double period_s, Eigen::Index rows) -> Eigen::Index {
  const auto half = static_cast<Eigen::Index>(0.5 * window_s / period_s);
  return std::clamp<Eigen::Index>(half, 2, std::max<Eigen::Index>(2, (rows - 1) / 2));
}
auto half_width(double window_s, const AxisLog& log) -> Eigen::Index {
  return half_width(window_s, log.period_s, log.samples());
}

/// The torque as it acts `skew_s` later than it was logged, linear between samples, held at the ends.
auto moved(const Eigen::VectorXd& torque, double skew_s, double period_s) -> Eigen::VectorXd {
  if (skew_s == 0.0 || torque.size() < 2) {
    return torque;
  }
  Eigen::VectorXd result(torque.size());
  for (Eigen::Index i = 0; i < torque.size(); ++i) {
    const double at =
        std::clamp(static_cast<double>(i) - skew_s / period_s, 0.0, static_cast<double>(torque.size() - 1));
    const auto before = std::min(static_cast<Eigen::Index>(at), torque.size() - 2);
    const double share = at - static_cast<double>(before);
    result[i] = torque[before] + share * (torque[before + 1] - torque[before]);
  }
  return result;
}

/// Number of the axis whose angle a side signal is; nothing for other signals.
auto axis_of_angle(const std::string& name) -> std::optional<int> {
  const auto slash = name.find('/');
  if (name.rfind("axis", 0) != 0 || slash == std::string::npos || name.compare(slash, 4, "/q1_") != 0) {
    return std::nullopt;
  }
  return std::stoi(name.substr(4, slash - 4));
}

auto angle_of_axis(const AxisLog& log, int axis) -> const SideSignal* {
  const auto found = std::find_if(log.side.begin(), log.side.end(),
                                  [axis](const auto& signal) { return axis_of_angle(signal.name) == axis; });
  return found == log.side.end() ? nullptr : &*found;
}

auto all_have(const std::vector<AxisLog>& logs, int axis) -> bool {
  return std::all_of(logs.begin(), logs.end(), [axis](const auto& log) { return angle_of_axis(log, axis) != nullptr; });
}

auto rests(const Eigen::VectorXd& angle) -> bool {
  return angle.minCoeff() == angle.maxCoeff();
}

auto speed_of(const AxisLog& log, const Eigen::VectorXd& angle, double window_s) -> Eigen::VectorXd {
  return LocalCubic(half_width(window_s, log)).derivative(angle, 1) / log.period_s;
}

/// Speed exceeded in 1 % of the samples.
auto top_speed(const AxisLog& log, const Eigen::VectorXd& angle, double window_s) -> double {
  return quantile(speed_of(log, angle, window_s).cwiseAbs(), 0.99);
}

/// @param standstill  of this angle
auto motion_of(const AxisLog& log, const Eigen::VectorXd& angle, const Eigen::VectorXd& torque, const EffortView& view,
               double standstill) -> Samples {
  constexpr double kKiloPerUnit = 1e-3;
  const LocalCubic cubic(half_width(view.window_s, log));
  const Eigen::VectorXd position = cubic.derivative(angle, 0);
  const Eigen::VectorXd speed = speed_of(log, angle, view.window_s);
  const Eigen::VectorXd acceleration = cubic.derivative(angle, 2) / (log.period_s * log.period_s);
  Samples samples(static_cast<std::size_t>(log.samples()));
  bool forward = true;
  RestingFriction<double> friction(SamplePeriod<double>(log.period_s), view.letting_go_s);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    auto& sample = samples[static_cast<std::size_t>(i)];
    const bool moves = std::abs(speed[i]) > standstill;
    forward = moves ? speed[i] > 0.0 : forward;
    sample.grip = friction.update(moves);
    sample.q1 = sample.q2 = position[i];
    sample.dq1 = speed[i];
    sample.ddq1 = kKiloPerUnit * acceleration[i];
    sample.tau = torque[i];
    sample.forward = forward;
    constexpr double kReferenceC = 25.0;
    sample.warmth = log.temperature_c.size() > 0 ? log.temperature_c[i] - kReferenceC : 0.0;
  }
  return samples;
}

/// The motors of other axes as the terms of a joint's angle see them, by slots.
void see_others(const AxisLog& log, const EffortView& view, Samples& samples) {
  const LocalCubic cubic(half_width(view.window_s, log));
  for (std::size_t slot = 0; slot < std::min(kMostOthers, log.others.size()); ++slot) {
    const OtherAxis& other = log.others[slot];
    const Eigen::VectorXd position = cubic.derivative(other.q1_rad, 0);
    const Eigen::VectorXd speed = speed_of(log, other.q1_rad, view.window_s);
    const double standstill = kStandstillShare * quantile(speed.cwiseAbs(), 0.99);
    bool forward = true;
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      forward = std::abs(speed[i]) > standstill ? speed[i] > 0.0 : forward;
      samples[static_cast<std::size_t>(i)].others[slot] = {position[i], other.tau_nm[i], forward};
    }
  }
}

}  // namespace

LocalCubic::LocalCubic(Eigen::Index half_width) : half_(half_width) {
  const Eigen::Index size = 2 * half_ + 1;
  Eigen::MatrixXd powers(size, 4);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto x = static_cast<double>(i - half_) / static_cast<double>(half_);
    powers.row(i) << 1.0, x, x * x, x * x * x;
  }
  from_window_ = (powers.transpose() * powers).ldlt().solve(powers.transpose());
}

auto LocalCubic::derivative(const Eigen::VectorXd& signal, int order, Eigen::Index step) const -> Eigen::VectorXd {
  const Eigen::Index n = signal.size();
  const Eigen::Index size = 2 * half_ + 1;
  Eigen::VectorXd result((n + step - 1) / step);
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const Eigen::Index first = std::clamp<Eigen::Index>(k * step - half_, 0, std::max<Eigen::Index>(0, n - size));
    const double x = static_cast<double>(k * step - first - half_) / static_cast<double>(half_);
    Eigen::RowVector4d at = order == 0 ? Eigen::RowVector4d(1.0, x, x * x, x * x * x)
                                       : (order == 1 ? Eigen::RowVector4d(0.0, 1.0, 2.0 * x, 3.0 * x * x)
                                                     : Eigen::RowVector4d(0.0, 0.0, 2.0, 6.0 * x));
    at /= std::pow(static_cast<double>(half_), order);
    const Eigen::RowVectorXd weights =
        x == 0.0 && order < 2 ? Eigen::RowVectorXd(at[order] * from_window_.row(order)) : at * from_window_;
    // From the sample itself on: where nothing moves the derivatives are 0, and no rounding has a direction.
    const double here = signal[k * step];
    result[k] = weights.dot((signal.segment(first, size).array() - here).matrix()) + (order == 0 ? here : 0.0);
  }
  return result;
}

auto axes_beside(const std::vector<AxisLog>& logs) -> std::vector<KnownAxis> {
  std::vector<KnownAxis> axes;
  for (int axis = 0; axis < kMostCouplingAxes; ++axis) {
    if (!all_have(logs, axis)) {
      continue;
    }
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    bool moves = false;
    for (const auto& log : logs) {
      const Eigen::VectorXd& angle = angle_of_axis(log, axis)->values;
      lowest = std::min(lowest, angle.minCoeff());
      highest = std::max(highest, angle.maxCoeff());
      moves = moves || !rests(angle);
    }
    if (moves) {
      axes.push_back({axis, angle_of_axis(logs.front(), axis)->name.ends_with("_m"), highest - lowest});
    }
  }
  return axes;
}

EffortDesign::EffortDesign(const std::vector<AxisLog>& logs, const EffortView& view)
    : view_(view), others_(axes_beside(logs)) {
  for (const auto& log : logs) {
    samples_.push_back(motion_of(log, log.q1_rad, moved(log.tau_nm, view.skew_s, log.period_s), view, view.standstill));
    see_others(log, view, samples_.back());
    periods_.push_back(log.period_s);
    rows_ += log.samples();
  }
  for (int axis = 0; axis < kMostCouplingAxes; ++axis) {
    if (all_have(logs, axis)) {
      add_other(logs, axis);
    }
  }
}

void EffortDesign::add_other(const std::vector<AxisLog>& logs, int axis) {
  double standstill = 0.0;
  for (const auto& log : logs) {
    const double top = top_speed(log, angle_of_axis(log, axis)->values, view_.window_s);
    standstill = std::max(standstill, kStandstillShare * top);
  }
  for (const auto& log : logs) {
    other_axes_[axis].push_back(motion_of(log, angle_of_axis(log, axis)->values, log.tau_nm, view_, standstill));
  }
}

auto EffortDesign::columns(const CatalogueTerm& term, const Shapes& shapes, Eigen::Index step) const
    -> Eigen::MatrixXd {
  const auto count = static_cast<Eigen::Index>(term.coefficients.size());
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(rows_, count);
  const bool logged = !term.of_axis || other_axes_.count(*term.of_axis) > 0;  // else it counts as at rest at its zero
  const std::vector<Samples>& samples = term.of_axis && logged ? other_axes_.at(*term.of_axis) : samples_;
  Eigen::Index row = 0;
  for (std::size_t i = 0; logged && i < samples.size(); ++i) {
    const auto rows = static_cast<Eigen::Index>(samples[i].size());
    whole.middleRows(row, rows) =
        term.pair_columns ? term.pair_columns(samples_[i], samples[i]) : term.columns(samples[i], periods_[i], shapes);
    row += rows;
  }
  Eigen::MatrixXd result(seen(Eigen::VectorXd::Zero(rows_), step).size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    result.col(i) = seen(whole.col(i), step);
  }
  return result;
}

auto EffortDesign::passed_through(const CatalogueTerm& term, const Shapes& shapes, const Eigen::VectorXd& signal) const
    -> Eigen::VectorXd {
  Eigen::VectorXd result(signal.size());
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const auto rows = static_cast<Eigen::Index>(samples_[i].size());
    result.segment(row, rows) = term.apply(signal.segment(row, rows), periods_[i], shapes);
    row += rows;
  }
  return result;
}

auto EffortDesign::seen(const Eigen::VectorXd& signal, Eigen::Index step) const -> Eigen::VectorXd {
  std::vector<double> kept;
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const auto rows = static_cast<Eigen::Index>(samples_[i].size());
    const Eigen::VectorXd own = signal.segment(row, rows);
    const LocalCubic cubic(half_width(view_.window_s, periods_[i], rows));
    const Eigen::VectorXd part =
        view_.averaged ? cubic.derivative(own, 0, step) : Eigen::VectorXd(own(Eigen::seq(0, rows - 1, step)));
    kept.insert(kept.end(), part.begin(), part.end());
    row += rows;
  }
  return Eigen::Map<const Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size()));
}

auto usual_view(const std::vector<AxisLog>& logs) -> EffortView {
  EffortView view;
  view.window_s = kWindowS;
  view.averaged = logs.front().motion_alone();
  for (const auto& log : logs) {
    view.standstill = std::max(view.standstill, kStandstillShare * top_speed(log, log.q1_rad, view.window_s));
  }
  return view;
}

}  // namespace capstan::tools
