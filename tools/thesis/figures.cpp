// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/model/pull_push.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/palpation.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/chapter4.hpp"
#include "capstan/tools/thesis/page.hpp"
#include "capstan/tools/thesis/study.hpp"

namespace capstan::tools {
namespace {

constexpr double kPerDegree = 180.0 / std::numbers::pi;
constexpr double kTurn = 2.0 * std::numbers::pi;
const std::array<std::string, 8> kColours = {"#1d4ed8", "#c2410c", "#0f766e", "#7c3aed",
                                             "#be185d", "#4d7c0f", "#0369a1", "#444"};

auto plot_of(std::string title, std::string x, std::string y) -> Plot {
  Plot plot;
  plot.title = std::move(title);
  plot.x_label = std::move(x);
  plot.y_label = std::move(y);
  return plot;
}

/// The last `share` of a signal: the run after its start.
auto tail_of(const Eigen::VectorXd& signal, double share) -> Eigen::VectorXd {
  return signal.tail(static_cast<Eigen::Index>(share * static_cast<double>(signal.size())));
}

auto hertz(double frequency) -> std::string {
  return rounded(frequency, 3) + " Hz";
}

// ---- Chapter 2: force, tip locked -------------------------------------------------------------------------------

struct TorqueRun {
  Eigen::VectorXd time_s, in_nm, out_nm;
};

template <typename Torque>
auto torque_run(double seconds, Torque&& torque_nm) -> TorqueRun {
  sim::PlantParameters p;
  p.environment.kind = sim::EnvironmentKind::kLocked;
  sim::Plant plant(p, 600);
  const auto rows = static_cast<Eigen::Index>(seconds * 100.0);
  TorqueRun run{Eigen::VectorXd(rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (Eigen::Index i = 0; i < rows; ++i) {
    run.time_s[i] = 0.01 * static_cast<double>(i);
    run.in_nm[i] = run.out_nm[i] = 0.0;
    for (int k = 0; k < 10; ++k) {
      plant.step(torque_nm(run.time_s[i] + 0.001 * k) / p.torque_constant_nm_per_a, true);
      run.in_nm[i] += 0.1 * p.torque_constant_nm_per_a * plant.readings().current_a;
      run.out_nm[i] += 0.1 * plant.truth().tip_torque_nm;
    }
  }
  return run;
}

struct ForceModels {
  Eigen::VectorXd pull, pull_push;
};

/// (2.17) to (2.21) with the numbers of chapter 2, each holding its last value as the thesis says.
auto force_models(const TorqueRun& run) -> ForceModels {
  const sim::PlantParameters p;
  const double r1 = p.input_radius_m;
  const double r2 = p.output_radius_m;
  ForceModels m{Eigen::VectorXd::Zero(run.in_nm.size()), Eigen::VectorXd::Zero(run.in_nm.size())};
  double pull = 0.0;
  double both = 0.0;
  for (Eigen::Index i = 10; i < run.in_nm.size(); ++i) {
    // Direction by a tenth of a second: the noise of a current turns more often than the motion.
    const double s = run.in_nm[i] > run.in_nm[i - 10] ? 1.0 : -1.0;
    const double eta = s > 0.0 ? p.eta_top : p.eta_bottom;
    if (s * run.in_nm[i] > 0.0) {
      pull = run.in_nm[i] * r2 / r1 * std::exp(-eta);
    }
    // With the pulling end P and the pushed end Q = P - s tau / r1: P (1 - e^-eta) / eta + Q (e^eta - 1) / eta = I.
    const double a = (1.0 - std::exp(-eta)) / eta;
    const double b = (std::exp(eta) - 1.0) / eta;
    const double force = s * run.in_nm[i] / r1;
    const double pulling = (p.pretension_n + b * force) / (a + b);
    const double pushed = pulling - force;
    const double at_output = std::exp(-eta) * pulling - std::exp(eta) * std::max(pushed, 0.0);
    if (pushed > 0.0 && at_output > 0.0) {
      both = s * r2 * at_output;
    } else if (pushed <= 0.0) {
      both = pull;
    }
    m.pull[i] = pull;
    m.pull_push[i] = both;
  }
  return m;
}

struct Weights {
  double pull, pull_push;
};

auto blend_weights(const TorqueRun& run, const ForceModels& m) -> Weights {
  Eigen::MatrixXd columns(run.out_nm.size(), 2);
  columns << m.pull, m.pull_push;
  const Eigen::Vector2d w = columns.colPivHouseholderQr().solve(run.out_nm);
  return {w[0], w[1]};
}

auto chapter_2() -> std::vector<ThesisFigure> {
  const auto triangle = [](double t) { return 0.155 * 2.0 / std::numbers::pi * std::asin(std::sin(kTurn * t / 40.0)); };
  const TorqueRun run = torque_run(95.0, triangle);
  const ForceModels models = force_models(run);
  const Weights w = blend_weights(run, models);
  Plot both = plot_of("Triangle of torque, tip locked", "time [s]", "joint torque [N m]");
  both.series = {{"simulated", kColours[7], run.time_s, run.out_nm},
                 {"pull", kColours[1], run.time_s, models.pull},
                 {"pull-push", kColours[2], run.time_s, models.pull_push}};
  ThesisFigure models_figure{"2.9",
                             "Estimates of the pull and the pull-push model and the torque at the joint",
                             "Printed: the measured torque lies between the two. Weights of (2.27) by least squares: "
                             "printed 0.5904 and 0.4686, here " +
                                 rounded(w.pull, 3) + " and " + rounded(w.pull_push, 3) +
                                 ": the simulated tendons are held by I alone, and the pull-push model knows I.",
                             {both}};
  ThesisFigure blend{"2.10", "Joint torque and the blend (2.27) on three other torques", "", {}};
  constexpr std::array<std::array<double, 2>, 3> kTones = {{{0.05, 0.025}, {0.02, 0.014}, {0.1, 0.03}}};
  for (const auto& tones : kTones) {
    const TorqueRun other = torque_run(
        80.0, [&](double t) { return 0.06228 * (std::sin(kTurn * tones[0] * t) + std::sin(kTurn * tones[1] * t)); });
    const ForceModels m = force_models(other);
    const Eigen::VectorXd estimate = w.pull * m.pull + w.pull_push * m.pull_push;
    Plot plot = plot_of(hertz(tones[0]) + " and " + hertz(tones[1]), "time [s]", "joint torque [N m]");
    plot.series = {{"simulated", kColours[7], other.time_s, other.out_nm},
                   {"blend", kColours[1], other.time_s, estimate}};
    blend.plots.push_back(plot);
    blend.caption += plot.title + ": RMS " + rounded(1000.0 * rms(estimate - other.out_nm), 3) + " mN m. ";
  }
  blend.caption += "The weights are those of figure 2.9.";
  return {models_figure, blend};
}

// ---- Chapter 3: palpation ---------------------------------------------------------------------------------------

struct Pressing {
  Eigen::VectorXd time_s, tau_nm, q1_rad;
};

/// A triangle of torque on a jaw that closes on tissue.
auto press(const sim::Environment& tissue) -> Pressing {
  sim::PlantParameters p;
  p.environment = tissue;
  sim::Plant plant(p, 610);
  constexpr Eigen::Index kRows = 8000;  // two cycles of 40 s, every 10 ms
  Pressing run{Eigen::VectorXd(kRows), Eigen::VectorXd(kRows), Eigen::VectorXd(kRows)};
  for (Eigen::Index i = 0; i < kRows; ++i) {
    run.time_s[i] = 0.01 * static_cast<double>(i);
    double tau = 0.0;
    double q1 = 0.0;
    for (int k = 0; k < 10; ++k) {
      const double t = run.time_s[i] + 0.001 * k;
      const double wave = 2.0 / std::numbers::pi * std::asin(std::sin(kTurn * t / 40.0));
      plant.step(0.155 * wave / p.torque_constant_nm_per_a, true);
      tau += 0.1 * p.torque_constant_nm_per_a * plant.readings().current_a;
      q1 += 0.1 * plant.truth().q1_rad;
    }
    run.tau_nm[i] = tau;
    run.q1_rad[i] = q1;
  }
  return run;
}

/// d q1 / d tau over two seconds.
auto compliance(const Pressing& run) -> Pressing {
  constexpr Eigen::Index kHalf = 100;
  const Eigen::Index rows = run.time_s.size() - 2 * kHalf;
  Pressing result{Eigen::VectorXd(rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto tau = run.tau_nm.segment(i, 2 * kHalf + 1);
    const auto q1 = run.q1_rad.segment(i, 2 * kHalf + 1);
    const Eigen::VectorXd t = tau.array() - tau.mean();
    result.time_s[i] = run.time_s[i + kHalf];
    result.tau_nm[i] = run.tau_nm[i + kHalf];
    result.q1_rad[i] = t.dot(q1) / std::max(t.squaredNorm(), 1e-9);
  }
  return result;
}

/// Mean compliance over the last two seconds of the release, as 3.6.2 has it.
auto released(const Pressing& c) -> double {
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < c.time_s.size(); ++i) {
    const double phase = std::fmod(c.time_s[i], 40.0);
    if (c.time_s[i] > 40.0 && phase > 15.0 && phase < 17.0) {
      sum += c.q1_rad[i];
      ++count;
    }
  }
  return sum / std::max(count, 1);
}

auto spring(double stiffness) -> sim::Environment {
  return {.kind = sim::EnvironmentKind::kSpring, .stiffness = stiffness};
}

auto compliance_plot(const std::string& title, const std::vector<std::pair<std::string, sim::Environment>>& tissues)
    -> Plot {
  Plot plot = plot_of(title, "time [s]", "dq1 / dtau [rad/(N m)]");
  std::size_t k = 0;
  for (const auto& [name, tissue] : tissues) {
    const Pressing c = compliance(press(tissue));
    plot.series.push_back({name, kColours[k++], c.time_s, c.q1_rad.cwiseMin(12.0).cwiseMax(0.0)});
  }
  plot.y_range = std::pair(0.0, 12.0);
  return plot;
}

auto inclusion(double depth_rad, double site_m) -> sim::Environment {
  sim::Environment e;
  e.kind = sim::EnvironmentKind::kLayered;
  e.stiffness = 0.15;
  e.deep_stiffness = 0.15;
  e.inclusion_stiffness = 0.3;
  e.inclusion_depth_rad = depth_rad;
  e.inclusion_width_m = 0.004;
  e.site_m = site_m;
  return e;
}

auto chapter_3() -> std::vector<ThesisFigure> {
  Plot stiffness = plot_of("Combined stiffness", "time [s]", "dtau / dq1 [N m/rad]");
  std::size_t k = 0;
  for (const auto& [name, value] :
       {std::pair{"compliant", 0.05}, std::pair{"semi-compliant", 0.2}, std::pair{"rigid", 2.0}}) {
    const Pressing c = compliance(press(spring(value)));
    stiffness.series.push_back({name, kColours[k++], c.time_s, c.q1_rad.cwiseInverse().cwiseMin(1.0).cwiseMax(0.0)});
  }
  const Plot soft = compliance_plot(
      "Combined compliance", {{"compliant", spring(0.05)}, {"semi-compliant", spring(0.2)}, {"rigid", spring(2.0)}});
  const Plot tumour = compliance_plot("Combined compliance over tissue", {{"no tumour", inclusion(0.0, 0.05)},
                                                                          {"in the middle", inclusion(0.08, 0.0)},
                                                                          {"at the surface", inclusion(0.0, 0.0)}});
  Plot map = plot_of("Compliance at the end of the release, site by site", "site [mm]", "dq1 / dtau [rad/(N m)]");
  for (const auto& [name, depth, colour] : {std::tuple{"tumour at the surface", 0.0, 0}, std::tuple{"deep", 0.08, 1}}) {
    Series series{name, kColours[static_cast<std::size_t>(colour)], Eigen::VectorXd(9), Eigen::VectorXd(9)};
    for (int i = 0; i < 9; ++i) {
      series.x[i] = 5.0 * (i - 4);
      series.y[i] = released(compliance(press(inclusion(depth, 0.001 * series.x[i]))));
    }
    map.series.push_back(series);
  }
  return {{"3.9",
           "Palpation of three samples",
           "Printed: stiffness falls from large values in phases I and II to "
           "plateaus that rank the samples; compliance tells them apart while the torque is high.",
           {stiffness, soft}},
          {"3.10, 3.11",
           "Tissue with an inclusion: a layer of 0.15 N m/rad, 0.3 more over the inclusion",
           "Printed: compliance is lower over a tumour, at the surface and in the middle.",
           {tumour}},
          {"3.12",
           "Distribution of compliance",
           "Printed: the map shows where the tumours are. Averaged over two seconds "
           "of the release, as 3.6.2 does.",
           {map}}};
}

// ---- Chapter 4 --------------------------------------------------------------------------------------------------

auto chapter_4() -> std::vector<ThesisFigure> {
  const ForceSurface surface = measured_surface(11);
  Plot curves = plot_of("First-order reversal curves, 11 levels", "input [V]", "joint torque [N m]");
  for (std::size_t peak = 1; peak < surface.levels; ++peak) {
    Series s{"", kColours[peak % 7], Eigen::VectorXd(static_cast<Eigen::Index>(peak) + 1),
             Eigen::VectorXd(static_cast<Eigen::Index>(peak) + 1)};
    for (std::size_t valley = 0; valley <= peak; ++valley) {
      s.x[static_cast<Eigen::Index>(valley)] = surface.inputs[valley];
      s.y[static_cast<Eigen::Index>(valley)] = surface.force(peak, valley);
    }
    curves.series.push_back(s);
  }
  std::vector<ThesisFigure> figures = {{"4.7, 4.8",
                                        "Identification: the reversal curves, and the mesh of their values",
                                        "Each line is one row of the "
                                        "mesh: rise to its right end, fall to -5 V.",
                                        {curves}}};
  const ForceSurface fine = measured_surface(41);
  constexpr std::array<const char*, 3> kNumbers = {"4.9, 4.10", "4.11", "4.12"};
  for (std::size_t i = 0; i < 3; ++i) {
    const ForceRun run = run_of_chapter_4(i);
    const Eigen::VectorXd coarse = preisach_estimate(surface, run);
    const Eigen::VectorXd best = preisach_estimate(fine, run);
    Plot time = plot_of("u" + std::to_string(i + 1) + ": response", "time [s]", "joint torque [N m]");
    time.series = {{"simulated", kColours[7], run.time_s, run.torque_nm},
                   {"11 levels", kColours[1], run.time_s, coarse},
                   {"41 levels", kColours[2], run.time_s, best}};
    Plot loop = plot_of("u" + std::to_string(i + 1) + ": input and output", "input [V]", "joint torque [N m]");
    loop.series = {{"simulated", kColours[7], run.input_v, run.torque_nm},
                   {"11 levels", kColours[1], run.input_v, coarse}};
    figures.push_back({kNumbers[i],
                       "Response to u" + std::to_string(i + 1) + ", simulated and estimated",
                       i == 0 ? "Printed: two minor loops of equal size (congruency)." : "",
                       {time, loop}});
  }
  return figures;
}

// ---- Chapters 5 to 7 --------------------------------------------------------------------------------------------

auto loop_series(const std::string& name, const std::string& colour, const AxisLog& log, double share) -> Series {
  return {name, colour, tail_of(log.q1_rad, share) * kPerDegree, tail_of(log.q2_rad, share) * kPerDegree};
}

/// Loops of one axis over frequency, the last turn of each.
auto loops(const Instrument& axes, std::size_t axis, double amplitude_deg, const std::vector<double>& frequencies,
           const std::string& title) -> Plot {
  Plot plot = plot_of(title, "motor angle q1 [deg]", "joint angle q2 [deg]");
  std::size_t k = 0;
  for (const double f : frequencies) {
    const Experiment run = run_experiment(axes, axis, sine(amplitude_deg, f, 2.0 / f), stiff_gains(), 620);
    const double share = (1.0 / f) / (2.0 / f + 0.5);
    Series s = loop_series(hertz(f), kColours[k++ % 8], run.log, share + 0.5 / (2.0 / f + 0.5));
    const auto rows = static_cast<Eigen::Index>(100.0 / f);
    s.x.conservativeResize(std::min(rows, s.x.size()));
    s.y.conservativeResize(s.x.size());
    plot.series.push_back(std::move(s));
  }
  return plot;
}

auto two_sines(double a, double phase, double b) -> sim::Motion {
  sim::Segment segment{.kind = sim::SegmentKind::kPolyline, .duration_s = 60.0};
  segment.speed_rad_per_s = 0.4;
  segment.corner_s = 0.2;
  for (int i = 0; i <= 240; ++i) {
    const double t = 0.25 * i;
    segment.points_rad.push_back((a * std::sin(kTurn * t / 30.0 + phase) + b * std::sin(kTurn * t / 10.0)) /
                                 kPerDegree);
  }
  segment.duration_s = sim::polyline_duration_s(segment);
  return sim::Motion({segment}, 1, 0.5);
}

struct Named {
  std::string name;
  Eigen::VectorXd km, pm;  ///< errors, deg
};

auto errors_of(const Study& study, const std::vector<Signal>& signals) -> std::vector<Named> {
  std::uint64_t seed = 630;
  std::vector<AxisLog> logs;
  for (const sim::Motion& motion : study.identification) {
    logs.push_back(run_experiment(study.instrument, study.axis, motion, stiff_gains(), seed++).log);
  }
  const Laws laws = fit_laws(logs, study.drag);
  std::vector<Named> all;
  for (const Signal& s : signals) {
    const AxisLog log = run_experiment(study.instrument, study.axis, s.motion, stiff_gains(), seed++).log;
    const auto error = [&](const JointFile& law) {
      return Eigen::VectorXd((log.q2_rad - simulate({log}, motion_parameters(law))) * kPerDegree);
    };
    all.push_back({s.name, error(laws.kinematic), error(laws.thesis)});
  }
  return all;
}

/// Box from the first to the third quartile, whiskers to the last value within 1.5 of its height: the thesis's plot.
void add_box(Plot& plot, double at, const Eigen::VectorXd& errors, const std::string& label,
             const std::string& colour) {
  const double q1 = quantile(errors, 0.25);
  const double q3 = quantile(errors, 0.75);
  const double middle = median(errors);
  double low = q1;
  double high = q3;
  for (const double e : errors) {
    low = e >= q1 - 1.5 * (q3 - q1) ? std::min(low, e) : low;
    high = e <= q3 + 1.5 * (q3 - q1) ? std::max(high, e) : high;
  }
  const double w = 0.18;
  const std::vector<std::pair<double, double>> path = {
      {at, low}, {at, q1},   {at - w, q1}, {at - w, middle}, {at + w, middle}, {at - w, middle}, {at - w, q3},
      {at, q3},  {at, high}, {at, q3},     {at + w, q3},     {at + w, q1},     {at, q1}};
  Series s{label, colour, Eigen::VectorXd(static_cast<Eigen::Index>(path.size())),
           Eigen::VectorXd(static_cast<Eigen::Index>(path.size()))};
  for (std::size_t i = 0; i < path.size(); ++i) {
    s.x[static_cast<Eigen::Index>(i)] = path[i].first;
    s.y[static_cast<Eigen::Index>(i)] = path[i].second;
  }
  plot.series.push_back(std::move(s));
}

auto box_plot(const std::vector<Named>& all) -> Plot {
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    names += (i > 0 ? ", " : "") + std::to_string(i + 1) + ": " + all[i].name;
  }
  Plot plot = plot_of("Errors: quartiles and whiskers", names, "measured less estimated [deg]");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto at = static_cast<double>(i + 1);
    add_box(plot, at - 0.22, all[i].km, i + 1 == all.size() ? "KM" : "", kColours[1]);
    add_box(plot, at + 0.22, all[i].pm, i + 1 == all.size() ? "PM" : "", kColours[2]);
  }
  return plot;
}

auto histogram(const std::vector<Named>& all) -> Plot {
  Plot plot = plot_of("Share of absolute errors, 0.25 deg wide", "absolute error [deg]", "share");
  constexpr int kBins = 28;
  for (const auto& [name, colour, pm] : {std::tuple{"KM", kColours[1], false}, std::tuple{"PM", kColours[2], true}}) {
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(kBins);
    double total = 0.0;
    for (const Named& n : all) {
      for (const double e : pm ? n.pm : n.km) {
        counts[std::min(kBins - 1, static_cast<int>(4.0 * std::fabs(e)))] += 1.0;
        total += 1.0;
      }
    }
    Series s{name, colour, Eigen::VectorXd(2 * kBins), Eigen::VectorXd(2 * kBins)};
    for (int i = 0; i < kBins; ++i) {
      s.x[2 * i] = 0.25 * i;
      s.x[2 * i + 1] = 0.25 * (i + 1);
      s.y[2 * i] = s.y[2 * i + 1] = counts[i] / total;
    }
    plot.series.push_back(std::move(s));
  }
  return plot;
}

auto chapter_5() -> std::vector<ThesisFigure> {
  const Instrument forceps = built_in("micro_forceps");
  const Experiment sample = run_experiment(forceps, 0, sine(20.0, 0.1, 20.0), stiff_gains(), 620);
  Plot time = plot_of("(a) 20 deg at 0.1 Hz", "time [s]", "angle [deg]");
  time.series = {{"motor", kColours[1], sample.log.time_s, sample.log.q1_rad * kPerDegree},
                 {"tip", kColours[7], sample.log.time_s, sample.log.q2_rad * kPerDegree}};
  Plot minor = plot_of("(c) minor loops", "motor angle q1 [deg]", "joint angle q2 [deg]");
  std::size_t k = 0;
  for (const auto& [name, a, phase, b] :
       {std::tuple{"5, 5", 5.0, 0.0, 5.0}, std::tuple{"5, 5, turned", 5.0, std::numbers::pi, 5.0},
        std::tuple{"10, 7.5", 10.0, 0.5 * std::numbers::pi, 7.5}}) {
    const Experiment run = run_experiment(forceps, 0, two_sines(a, phase, b), stiff_gains(), 621);
    minor.series.push_back(loop_series(name, kColours[k++], run.log, 0.9));
  }
  ThesisFigure response{"5.4",
                        "Response of the micro-forceps: a sine, loops over frequency, minor loops",
                        "Printed: a loop that converges as frequency falls, and minor loops inside it.",
                        {time, loops(forceps, 0, 15.0, {0.01, 0.1, 0.3, 0.7}, "(b) loops over frequency"), minor}};
  const Study study{forceps, 0, {sine(20.0, 0.1, 20.0), sine(10.0, 0.1, 20.0), sine(5.0, 0.1, 20.0)}};
  const std::vector<double> tones = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1};
  const auto errors = errors_of(study, {{"0.05 Hz", sine(15.0, 0.05, 40.0), {}, {}},
                                        {"0.1 Hz", sine(15.0, 0.1, 20.0), {}, {}},
                                        {"0.2 Hz", sine(15.0, 0.2, 10.0), {}, {}},
                                        {"multisine", multisine(4.7, tones, 100.0), {}, {}}});
  return {response,
          {"5.6",
           "Error distributions of KM and PM",
           "Printed: most errors of PM lie within 1.5 deg.",
           {box_plot(errors), histogram(errors)}}};
}

auto chapter_6() -> std::vector<ThesisFigure> {
  Instrument wrist = built_in("da_vinci_wrist");
  // Drag as in table 6.2, without which a loop of friction and elasticity knows no frequency.
  for (auto& axis : wrist) {
    axis.plant.effects.transmission_viscous_forward_ns_per_m = 265.3;
    axis.plant.effects.transmission_viscous_backward_ns_per_m = 265.3;
  }
  const Plot swept = loops(wrist, 0, 10.0, {0.05, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0}, "Pitch, 10 deg");
  Study study{wrist, 1, {multisine(9.0, {0.2, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.3}, 20.0)}};
  study.drag = true;
  const auto errors = errors_of(study, {{"I", study.identification[0], {}, {}},
                                        {"II", multisine(8.4, {0.4, 0.7, 1.0, 1.3, 1.6, 1.9, 2.2}, 20.0), {}, {}},
                                        {"III", multisine(10.1, {0.05, 0.1, 1.0}, 20.0), {}, {}},
                                        {"IV", multisine(6.4, {0.05, 0.25, 0.45, 0.65}, 20.0), {}, {}},
                                        {"V", multisine(9.5, {0.05, 0.07, 0.09}, 100.0), {}, {}}});
  return {{"6.9",
           "Loops of the pitch over frequency, with drag in the tendons",
           "Printed: the loop converges toward low frequencies, the lag grows toward high ones.",
           {swept}},
          {"6.11", "Errors of the dynamic law, right jaw", "", {box_plot(errors)}}};
}

auto chapter_7() -> std::vector<ThesisFigure> {
  Instrument elbow = {built_in("raven2")[1]};
  Plot tension = plot_of("Pretension, 10 deg at 0.1 Hz", "motor angle q1 [deg]", "joint angle q2 [deg]");
  std::size_t k = 0;
  for (const double pretension : {0.2, 1.0, 2.0}) {
    Instrument axes = elbow;
    axes[0].plant.pretension_n = pretension;
    // The load makes the tendon that does not pull go slack, which is where pretension narrows the loop.
    axes[0].plant.joint_coulomb_nm = 0.02;
    const Experiment run = run_experiment(axes, 0, sine(10.0, 0.1, 20.0), stiff_gains(), 640);
    tension.series.push_back(loop_series(rounded(pretension, 2) + " N", kColours[k++], run.log, 0.55));
  }
  elbow[0].plant.pretension_n = 0.2;
  sim::Motion decaying = decaying_sine(10.0, 0.8 / kTurn, 0.1, 40.0);
  const Experiment minor = run_experiment(elbow, 0, decaying, stiff_gains(), 641);
  Plot inner = plot_of("10 exp(-0.1 t) sin(0.8 t) deg", "motor angle q1 [deg]", "joint angle q2 [deg]");
  inner.series = {loop_series("simulated", kColours[7], minor.log, 0.98)};
  const Study study{elbow, 0, {multisine(12.0, {0.05, 0.07, 0.09}, 100.0)}};
  const auto errors = errors_of(study, {{"I", sine(8.0, 0.1, 20.0), {}, {}},
                                        {"II", sine(8.6, 0.2, 10.0), {}, {}},
                                        {"III", study.identification[0], {}, {}},
                                        {"IV", multisine(5.0, {0.05, 0.075, 0.1, 0.125, 0.15, 0.16}, 200.0), {}, {}},
                                        {"V", multisine(6.4, {0.08, 0.1, 0.12, 0.14}, 50.0), {}, {}}});
  return {
      {"7.6",
       "Loops of the elbow under growing pretension",
       "Printed: the loop narrows as pretension grows. It does so while a tendon goes slack under the load (here 20 "
       "mN m in the joint); with both taut, more pretension widens it.",
       {tension}},
      {"7.7", "Minor loops", "Printed: close to a pure backlash.", {inner}},
      {"7.8",
       "Loops of the elbow over frequency",
       "Printed: converges to a fixed loop.",
       {loops(elbow, 0, 10.0, {0.1, 0.2, 0.4, 1.0}, "Elbow, 10 deg")}},
      {"7.11",
       "Error distributions of KM and PM, elbow",
       "Printed: most errors of PM lie within 2 deg.",
       {box_plot(errors), histogram(errors)}}};
}

}  // namespace

auto thesis_figures() -> std::vector<ThesisFigure> {
  std::vector<ThesisFigure> all;
  for (auto chapter : {chapter_2, chapter_3, chapter_4, chapter_5, chapter_6, chapter_7}) {
    for (ThesisFigure& figure : chapter()) {
      all.push_back(std::move(figure));
    }
  }
  return all;
}

}  // namespace capstan::tools
