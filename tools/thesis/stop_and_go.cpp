// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/stop_and_go.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/model/belt_drive.hpp"

namespace capstan::tools {
namespace {

constexpr double kRecordEveryS = 5e-4;
constexpr std::array<double, StopAndGo::kLegs> kStart = {0.02, 0.10, 0.14, 0.22, 0.26, 0.34, 0.38, 0.46, 0.50, 0.58};
constexpr std::array<double, StopAndGo::kLegs> kWay = {1.0, 0.0, 1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0, 0.0};

auto as_idler(const sim::PulleyParameters& p) -> Idler {
  return {p.wrap_rad, p.bore_radius_m / p.radius_m,
          p.locked ? kSeizedBearing / (p.bore_radius_m / p.radius_m) : p.bearing_friction, p.surface_friction,
          p.radius_m};
}

/// Mean over the last part of a leg, where what rang has died out.
auto late_mean(const PulleyRun& run, const Eigen::VectorXd& values, std::size_t leg) -> double {
  const double end = leg + 1 < kStart.size() ? kStart[leg + 1] : run.time_s[run.time_s.size() - 1];
  const Eigen::Index from = run.row_at(end - 0.02);
  return values.segment(from, run.row_at(end) - from).mean();
}

}  // namespace

auto StopAndGo::leg_start_s(std::size_t leg) -> double {
  return kStart.at(leg);
}

auto StopAndGo::speed_at(double time_s) const -> double {
  double way = 0.0;
  for (std::size_t leg = 0; leg < kStart.size() && time_s > kStart[leg]; ++leg) {
    const double share = std::min(1.0, (time_s - kStart[leg]) / ramp_s);
    way += (kWay[leg] - way) * 0.5 * (1.0 - std::cos(std::numbers::pi * share));
  }
  return speed_m_per_s * way;
}

auto PulleyRun::row_at(double t) const -> Eigen::Index {
  return std::min<Eigen::Index>(time_s.size() - 1, std::lower_bound(time_s.begin(), time_s.end(), t) - time_s.begin());
}

auto run_stop_and_go(const sim::PulleyLineParameters& parameters, const StopAndGo& motion, double until_s)
    -> PulleyRun {
  sim::PulleyLine line(parameters);
  const auto rows = static_cast<Eigen::Index>(until_s / kRecordEveryS);
  PulleyRun run;
  for (Eigen::VectorXd* column : {&run.time_s, &run.drum_m, &run.load_m, &run.rim_m, &run.in_n, &run.out_n}) {
    column->resize(rows);
  }
  for (Eigen::Index row = 0; row < rows; ++row) {
    while (line.time_s() < kRecordEveryS * static_cast<double>(row)) {
      line.step(motion.speed_at(line.time_s()));
    }
    run.time_s[row] = line.time_s();
    run.drum_m[row] = line.input_travel_m();
    run.load_m[row] = line.output_travel_m();
    run.rim_m[row] = line.pulley_angle_rad(0) * parameters.pulleys[0].radius_m;
    run.in_n[row] = line.input_tension_n();
    run.out_n[row] = line.output_tension_n();
  }
  run.energy = line.energy();
  return run;
}

auto one_idler() -> sim::PulleyLineParameters {
  sim::PulleyLineParameters line;
  line.nodes_per_pulley = 6;  // as a polygon loses 2e-4 of the capstan equation's logarithm
  line.load_mass_kg = 0.02;
  line.load_damping_ns_per_m = 20.0;
  return line;
}

auto two_idlers() -> sim::PulleyLineParameters {
  sim::PulleyLineParameters line = one_idler();
  line.pulleys.push_back(line.pulleys[0]);
  line.spans_m = {0.15, 0.05, 0.15};
  return line;
}

auto two_surfaces() -> sim::PulleyLineParameters {
  sim::PulleyLineParameters line = two_idlers();
  for (sim::PulleyParameters& pulley : line.pulleys) {
    pulley.surface_friction = -std::log(idler_ratio(as_idler(pulley))) / pulley.wrap_rad;
    pulley.locked = true;
  }
  return line;
}

auto closed_form_ratio(const sim::PulleyLineParameters& line) -> double {
  double ratio = 1.0;
  for (const sim::PulleyParameters& pulley : line.pulleys) {
    ratio *= idler_ratio(as_idler(pulley));
  }
  return ratio;
}

auto start_error_percent(const PulleyRun& run) -> double {
  const double moving = late_mean(run, run.ratio(), 2);
  double worst = 0.0;
  for (Eigen::Index i = run.row_at(kStart[2]); i < run.row_at(kStart[3]); ++i) {
    worst = std::max(worst, 100.0 * std::fabs(run.out_n[i] - moving * run.in_n[i]) / run.out_n[i]);
  }
  return worst;
}

auto figures_of(const PulleyRun& run) -> StopAndGoFigures {
  const Eigen::VectorXd ratio = run.ratio();
  StopAndGoFigures f{};
  f.moving = late_mean(run, ratio, 2);
  f.kept_percent = 100.0 * (1.0 - late_mean(run, ratio, 3)) / (1.0 - f.moving);
  const double stopped = late_mean(run, ratio, 3);
  const double back = late_mean(run, ratio, 4);
  const Eigen::Index turned = run.row_at(kStart[4]);
  Eigen::Index row = turned;
  while (row + 1 < ratio.size() && ratio[row] < stopped + 0.95 * (back - stopped)) {
    ++row;
  }
  f.reversal_mm = 1e3 * std::fabs(run.drum_m[row] - run.drum_m[turned]);
  f.start_error_percent = start_error_percent(run);
  const double friction = run.energy.slip + run.energy.bearings;
  f.slip_percent = 100.0 * run.energy.slip / friction;
  f.missing_percent = 100.0 * run.energy.missing() / friction;
  return f;
}

}  // namespace capstan::tools
