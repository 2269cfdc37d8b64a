// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/figures.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/model/stiffness.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/blend.hpp"
#include "capstan/tools/thesis/chapter4.hpp"

namespace capstan::tools {
namespace {

// ---- Chapter 2: force, tip locked -------------------------------------------------------------------------------

auto chapter_2() -> std::vector<ThesisFigure> {
  const TorqueRun run = triangle_of_chapter_2(sim::PlantParameters{});
  const ForceModels models = force_models(run);
  const BlendWeights w = blend_weights(run, models);
  Plot both = plot_of("Triangle of torque, tip locked", "time [s]", "joint torque [N m]");
  both.series = {{"simulated", kColours[7], run.time_s, run.out_nm},
                 {"pull", kColours[1], run.time_s, models.pull},
                 {"pull-push", kColours[2], run.time_s, models.pull_push}};
  ThesisFigure models_figure{"2.9",
                             "Estimates of the pull and the pull-push model and the torque at the joint",
                             "Printed: the measured torque lies between the two. Weights of (2.27) by least squares: "
                             "printed 0.5904 and 0.4686, here " +
                                 rounded(w.pull, 3) + " and " + rounded(w.pull_push, 3) + "; table 2.27 has why.",
                             {both}};
  ThesisFigure blend{"2.10", "Joint torque and the blend (2.27) on three other torques", "", {}};
  constexpr std::array<std::array<double, 2>, 3> kTones = {{{0.05, 0.025}, {0.02, 0.014}, {0.1, 0.03}}};
  for (const auto& tones : kTones) {
    const TorqueRun other = torque_run(sim::PlantParameters{}, 80.0, [&](double t) {
      return 0.06228 * (std::sin(kTurn * tones[0] * t) + std::sin(kTurn * tones[1] * t));
    });
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

constexpr double kMostCompliance = 25.0;  // drawn, rad/(N m)

/// A triangle of torque on a jaw that closes on tissue.
auto press(const sim::Environment& tissue) -> Pressing {
  sim::PlantParameters p;
  p.environment = tissue;
  // The jaw opens against a stop: torque alone would else take it away from the tissue for good.
  p.stop_low_rad = -0.15;
  p.stop_stiffness_nm_per_rad = tissue.kind == sim::EnvironmentKind::kLayered ? 5.0 : 0.0;
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

/// Mean compliance over the last second and a half of the press, before the torque turns.
auto pressed(const Pressing& c) -> double {
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < c.time_s.size(); ++i) {
    const double phase = std::fmod(c.time_s[i], 40.0);
    if (c.time_s[i] > 40.0 && phase > 7.0 && phase < 8.5) {
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
    plot.series.push_back({name, kColours[k++], c.time_s, c.q1_rad.cwiseMin(kMostCompliance).cwiseMax(0.0)});
  }
  plot.y_range = std::pair(0.0, kMostCompliance);
  return plot;
}

/// What (3.24) and (3.26) predict of a spring in the second press: both tendons active from 43.5 to 47 s, one slack at
/// 49 s.
auto predicted(double stiffness) -> Series {
  const sim::PlantParameters p;
  const TendonPair pair{{p.eta_top, p.stiffness_top_n_per_m},
                        {p.eta_bottom, p.stiffness_bottom_n_per_m},
                        p.input_radius_m,
                        p.output_radius_m};
  const auto felt = [&](ForcePhase phase) {
    return combined_compliance(pair, phase_stiffness(pair, phase), stiffness);
  };
  Series line{"", kColours[7], Eigen::VectorXd(3), Eigen::VectorXd(3)};
  line.x << 43.5, 47.0, 49.0;
  line.y << felt(ForcePhase::kBothActive), felt(ForcePhase::kBothActive), felt(ForcePhase::kOneSlack);
  return line;
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
  Plot soft = compliance_plot("Combined compliance",
                              {{"compliant", spring(0.05)}, {"semi-compliant", spring(0.2)}, {"rigid", spring(2.0)}});
  for (const double value : {0.05, 0.2, 2.0}) {
    soft.series.push_back(predicted(value));
  }
  soft.series.back().label = "predicted";
  const Plot tumour = compliance_plot("Combined compliance over tissue", {{"no tumour", inclusion(0.0, 0.05)},
                                                                          {"in the middle", inclusion(0.08, 0.0)},
                                                                          {"at the surface", inclusion(0.0, 0.0)}});
  Plot map = plot_of("Compliance at the end of the press, site by site", "site [mm]", "dq1 / dtau [rad/(N m)]");
  for (const auto& [name, depth, colour] : {std::tuple{"tumour at the surface", 0.0, 0}, std::tuple{"deep", 0.08, 1}}) {
    Series series{name, kColours[static_cast<std::size_t>(colour)], Eigen::VectorXd(9), Eigen::VectorXd(9)};
    for (int i = 0; i < 9; ++i) {
      series.x[i] = 5.0 * (i - 4);
      series.y[i] = pressed(compliance(press(inclusion(depth, 0.001 * series.x[i]))));
    }
    map.series.push_back(series);
  }
  return {{"3.9",
           "Palpation of three samples",
           "Printed: stiffness falls from large values in phases I and II to "
           "plateaus that rank the samples; compliance tells them apart while the torque is high. Grey: by "
           "(3.24) and (3.26), the sample seen through pulleys and friction.",
           {stiffness, soft}},
          {"3.10, 3.11",
           "Tissue with an inclusion: a layer of 0.15 N m/rad, 0.3 more over the inclusion",
           "Printed: compliance is lower over a tumour, at the surface and in the middle.",
           {tumour}},
          {"3.12",
           "Distribution of compliance",
           "Printed: the map shows where the tumours are. Printed from the last two seconds of the "
           "release; on the simulator friction still holds the tip then, so this is the end of the press.",
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

}  // namespace

auto force_figures() -> std::vector<ThesisFigure> {
  std::vector<ThesisFigure> all;
  for (auto chapter : {chapter_2, chapter_3, chapter_4}) {
    for (ThesisFigure& figure : chapter()) {
      all.push_back(std::move(figure));
    }
  }
  return all;
}

}  // namespace capstan::tools
