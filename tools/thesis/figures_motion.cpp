// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/figures.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/study.hpp"

namespace capstan::tools {
namespace {

/// The last `share` of a signal: the run after its start.
auto tail_of(const Eigen::VectorXd& signal, double share) -> Eigen::VectorXd {
  return signal.tail(static_cast<Eigen::Index>(share * static_cast<double>(signal.size())));
}

// ---- Chapters 5 to 7 --------------------------------------------------------------------------------------------

auto loop_series(const std::string& name, const std::string& colour, const AxisLog& log, double share) -> Series {
  return {name, colour, tail_of(log.q1_rad, share) * kDegreesPerRadian, tail_of(log.q2_rad, share) * kDegreesPerRadian};
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
                                 kDegreesPerRadian);
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
      return Eigen::VectorXd((log.q2_rad - simulate({log}, motion_parameters(law))) * kDegreesPerRadian);
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
  time.series = {{"motor", kColours[1], sample.log.time_s, sample.log.q1_rad * kDegreesPerRadian},
                 {"tip", kColours[7], sample.log.time_s, sample.log.q2_rad * kDegreesPerRadian}};
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
  const Instrument wrist = wrist_of_chapter_6();
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
  elbow = elbow_of_chapter_7();
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

auto motion_figures() -> std::vector<ThesisFigure> {
  std::vector<ThesisFigure> all;
  for (auto chapter : {chapter_5, chapter_6, chapter_7}) {
    for (ThesisFigure& figure : chapter()) {
      all.push_back(std::move(figure));
    }
  }
  return all;
}

}  // namespace capstan::tools
