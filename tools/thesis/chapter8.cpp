// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "capstan/model/tension_profile.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/figures.hpp"
#include "capstan/tools/thesis/stop_and_go.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {
namespace {

constexpr double kWholeS = 0.62;
constexpr double kPerMm = 1e3;

auto heavy(sim::PulleyLineParameters line, double factor) -> sim::PulleyLineParameters {
  for (sim::PulleyParameters& pulley : line.pulleys) {
    pulley.inertia_kgm2 *= factor;
  }
  return line;
}

auto column_of(const std::vector<double>& values) -> Eigen::VectorXd {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

auto tension_figure(const PulleyRun& one, const PulleyRun& two) -> ThesisFigure {
  ThesisFigure figure{
      "8.2.3 (a)",
      "Stop and go over one idler and over two: 50 mm/s, ramps of 5 ms",
      "While the drum stands, most of the loss stays: bearing and surface hold what they took. Driven on the same way "
      "it is there at once; turned back, the drum's tension falls by twice the loss before the load moves.",
      {}};
  for (const auto& [name, run] : {std::pair{"One idler", &one}, std::pair{"Two idlers", &two}}) {
    Plot plot = plot_of(name, "time [s]", "tension [N]");
    plot.series = {{"at the drum", kColours[1], run->time_s, run->in_n},
                   {"at the load", kColours[0], run->time_s, run->out_n}};
    figure.plots.push_back(std::move(plot));
  }
  return figure;
}

/// From the first turning back to its stop, over the drum's travel.
auto reversal_series(const std::string& name, const std::string& colour, const PulleyRun& run) -> Series {
  const Eigen::Index from = run.row_at(StopAndGo::leg_start_s(4));
  const Eigen::Index rows = run.row_at(StopAndGo::leg_start_s(4) + 0.04) - from;
  return {name, colour, kPerMm * (run.drum_m[from] - run.drum_m.segment(from, rows).array()).matrix(),
          run.ratio().segment(from, rows)};
}

auto slip_series(const std::string& name, const std::string& colour, const PulleyRun& run) -> Series {
  return {name, colour, run.time_s, 1e6 * (run.load_m - run.rim_m)};
}

/// The tension along the arc of one pulley with its load held, while the drum goes 0.4 mm forth and then back.
auto profile_plot(bool locked) -> Plot {
  sim::PulleyLineParameters parameters = one_idler();
  parameters.load_held = true;
  parameters.nodes_per_pulley = 16;
  parameters.mass_kg_per_m = 4e-3;  // the tendon's own waves are of no interest here, and this halves the steps
  parameters.damping_s = 2e-6;
  sim::PulleyParameters& pulley = parameters.pulleys[0];
  pulley.locked = locked;
  sim::PulleyLine line(parameters);
  TensionProfile closed_form({pulley.surface_friction * pulley.wrap_rad, 1.0}, parameters.preload_n);
  Plot plot = plot_of(locked ? "Held pulley; dots: (2.4) to (2.10)" : "Idler that turns",
                      "angle from the load's side [rad]", "tension [N]");
  std::size_t k = 0;
  for (const double travel_mm : {0.2, 0.1, 0.0}) {
    const double speed = travel_mm / kPerMm > line.input_travel_m() ? 0.01 : -0.01;
    while (std::fabs(line.input_travel_m() - travel_mm / kPerMm) > std::fabs(speed) * line.step_s()) {
      line.step(speed);
    }
    line.run(0.002, 0.0);
    const std::vector<double> tension = line.tensions_on(0);
    closed_form.pull_to(tension.front());
    std::vector<double> angle, theory;
    const double step = pulley.wrap_rad / parameters.nodes_per_pulley;
    for (std::size_t i = 0; i < tension.size(); ++i) {
      angle.push_back(pulley.wrap_rad - step * static_cast<double>(i));
      theory.push_back(closed_form.at(static_cast<double>(i) / parameters.nodes_per_pulley));
    }
    const std::string name = (k == 0 ? "pulled to " : "let back to ") + rounded(travel_mm, 2) + " mm";
    plot.series.push_back({name, kColours[k], column_of(angle), column_of(tension)});
    if (locked) {
      plot.series.push_back({k == 2 ? "closed form" : "", kColours[7], column_of(angle), column_of(theory)});
    }
    ++k;
  }
  return plot;
}

auto inertia_plot() -> Plot {
  Plot plot = plot_of("Largest error of the steady ratio in a start, one idler", "mean acceleration of the drum [m/s2]",
                      "error over the load's tension [%]");
  std::size_t k = 0;
  for (const double factor : {1.0, 10.0, 100.0}) {
    std::vector<double> acceleration, error;
    for (const double ramp_s : {0.02, 0.005, 0.00125}) {
      StopAndGo motion;
      motion.ramp_s = ramp_s;
      const PulleyRun run = run_stop_and_go(heavy(one_idler(), factor), motion, StopAndGo::leg_start_s(3) + 0.02);
      acceleration.push_back(motion.speed_m_per_s / ramp_s);
      error.push_back(start_error_percent(run));
    }
    plot.series.push_back({rounded(5.0 * factor, 3) + " g", kColours[k++], column_of(acceleration), column_of(error)});
  }
  return plot;
}

}  // namespace

auto study_figures() -> std::vector<ThesisFigure> {
  const PulleyRun one = run_stop_and_go(one_idler(), {}, kWholeS);
  const PulleyRun two = run_stop_and_go(two_idlers(), {}, kWholeS);
  const PulleyRun surfaces = run_stop_and_go(two_surfaces(), {}, kWholeS);
  Plot reversal =
      plot_of("First turning back, from rest", "travel of the drum [mm]", "tension at the load over the drum's");
  reversal.series = {reversal_series("one idler", kColours[0], one), reversal_series("two idlers", kColours[1], two),
                     reversal_series("two surfaces of the same loss", kColours[2], surfaces)};
  Plot slip = plot_of("Travel of the load ahead of the first idler's rim", "time [s]", "[um]");
  slip.series = {slip_series("one idler", kColours[0], one), slip_series("two idlers", kColours[1], two)};
  return {
      tension_figure(one, two),
      {"8.2.3 (b)",
       "A reversal: idlers that turn beside surfaces that stand still",
       "Surfaces in the place of two idlers (5.2.1) give the same loop but for its corner, which comes a little later, "
       "and for the ringing of an idler between its spans, which its bearing hardly damps.",
       {reversal, slip}},
      {"8.2.3 (c)",
       "Tension along the arc, load held: pulled, then let back",
       "On the held pulley a slip front travels in from the drum's side and leaves the past behind it. On the idler "
       "the tendon slips in from both ends, as far as the rim turns, and the tension in between goes with it.",
       {profile_plot(true), profile_plot(false)}},
      {"8.2.3 (d)",
       "What an idler's inertia adds",
       "An idler of 5 g adds 2 % at 40 m/s2; one of 500 g, heavier than the load, is the transient. The steady law of "
       "5.2.1 needs no inertia at the accelerations of an instrument.",
       {inertia_plot()}}};
}

auto table_8_2_3() -> ThesisTable {
  ThesisTable table{"8.2.3",
                    "Stop and go over rotating idlers: what the steady law of 5.2.1 leaves out",
                    {},
                    {{"closed form", "ratio", "ratio", "1", 4},
                     {"plant", "ratio", "ratio", "1", 4},
                     {"plant", "kept", "kept %", "%", 1},
                     {"plant", "reversal", "turns mm", "mm", 3},
                     {"plant", "start", "start %", "%", 1},
                     {"plant", "slip", "slip %", "%", 2},
                     {"plant", "missing", "missing %", "%", 3}},
                    {}};
  for (const auto& [name, line] :
       {std::pair{"one idler", one_idler()}, std::pair{"two idlers", two_idlers()},
        std::pair{"two surfaces", two_surfaces()}, std::pair{"two idlers, 20 x inertia", heavy(two_idlers(), 20.0)}}) {
    const StopAndGoFigures f = figures_of(run_stop_and_go(line, {}, kWholeS));
    table.rows.push_back({name,
                          {closed_form_ratio(line), f.moving, f.kept_percent, f.reversal_mm, f.start_error_percent,
                           f.slip_percent, f.missing_percent}});
  }
  table.conditions = {
      "One tendon (E A 5 kN, 2 g/m, spans of 0.15 m, 0.05 m between the idlers) from a drum that moves at 50 mm/s to a "
      "load of "
      "10 N; idlers of 5 g, 8 mm radius, a quarter turn, friction 0.2 on the surface and 0.2 in a bore of 3 mm radius. "
      "ratio: "
      "the load's tension over the drum's, moving; the closed form is (5.7) for idlers and (5.1) for surfaces, of the "
      "same "
      "loss. kept: share of the loss that stays while the drum stands. turns: travel of the drum from a reversal until "
      "95 "
      "% of the other ratio. start: largest error of the moving ratio while the drum starts again the same way. slip: "
      "share of the friction's work done between tendon and idler, the rest in bearings. missing: what the balance of "
      "energy "
      "does not close by.",
      "The thesis asks for this study and prints no figures."};
  return table;
}

}  // namespace capstan::tools
