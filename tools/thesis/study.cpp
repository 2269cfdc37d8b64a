// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/study.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

auto with_camera(Instrument axes, double late_s) -> Instrument {
  for (sim::InstrumentAxis& axis : axes) {
    axis.plant.camera_delay_s += late_s;
  }
  return axes;
}

/// The torque without the weight that hangs on the joint, as a controller with a model of the arm takes it out.
void take_gravity_out(AxisLog& log, const sim::PlantParameters& p) {
  const double ratio = p.input_radius_m / p.output_radius_m;
  const sim::Effects& e = p.effects;
  log.tau_nm.array() -= ratio * e.gravity_torque_nm * (ratio * log.q1_rad.array() + e.gravity_angle_rad).sin();
}

}  // namespace

namespace {

/// The log of a signal, the motor going as much farther as the joint lacks of the printed root mean square.
auto run_signal(const Instrument& axes, std::size_t axis, const Signal& signal, std::uint64_t seed) -> AxisLog {
  constexpr int kMostRounds = 3;
  constexpr double kMet = 0.005;
  constexpr double kUsualLoss = 0.12;  // of the motor's way, in these instruments: a start that saves a round
  if (!signal.scaled) {
    return run_experiment(axes, axis, signal.motion, stiff_gains(), seed).log;
  }
  const double wanted = implied_rms_deg(signal.km);
  double factor = 1.0 + kUsualLoss;
  AxisLog log;
  for (int round = 0; round < kMostRounds; ++round) {
    log = run_experiment(axes, axis, signal.scaled(factor), stiff_gains(), seed).log;
    const double got = rms_deg(log.q2_rad.array() - log.q2_rad.mean());
    if (std::fabs(got - wanted) < kMet * wanted) {
      break;
    }
    factor += (wanted - got) / wanted;
  }
  return log;
}

}  // namespace

auto built_in(const char* name) -> Instrument {
  return sim::parse_instrument(sim::built_in_instrument(name), name).axes;
}

auto fit_quality(const Eigen::VectorXd& measured_rad, const Eigen::VectorXd& estimated_rad, int parameters)
    -> FitQuality {
  const Eigen::VectorXd error = measured_rad - estimated_rad;
  const double total = (measured_rad.array() - measured_rad.mean()).matrix().squaredNorm();
  const auto n = static_cast<double>(error.size());
  return {rms(error) * kDegreesPerRadian, 100.0 * (1.0 - std::sqrt(error.squaredNorm() / total)),
          1.0 - (n - 1.0) * error.squaredNorm() / ((n - parameters) * total),
          goodness_of_fit_percent(measured_rad, estimated_rad)};
}

auto implied_rms_deg(const FitQuality& printed) -> double {
  return printed.rmse_deg / (1.0 - 0.01 * printed.gof_percent);
}

auto run_study(const Study& study, const std::vector<Signal>& signals) -> StudyErrors {
  std::uint64_t seed = 1;
  const Instrument axes = with_camera(study.instrument, study.late_s);
  const sim::PlantParameters& plant = axes[study.axis].plant;
  const auto finished = [&](AxisLog log) {
    if (study.gravity_out) {
      take_gravity_out(log, plant);
    }
    return log;
  };
  const auto log_of = [&](const sim::Motion& motion) {
    return finished(run_experiment(axes, study.axis, motion, stiff_gains(), seed++).log);
  };
  const auto log_of_signal = [&](const Signal& signal, const Instrument& instrument) {
    return finished(run_signal(instrument, study.axis, signal, seed++));
  };
  Instrument later = axes;
  later[study.axis].plant.pretension_n *= study.pretension_of_signals;
  std::vector<AxisLog> logs;
  for (const sim::Motion& motion : study.identification) {
    logs.push_back(log_of(motion));
  }
  for (const Signal& signal : study.identification_signals) {
    logs.push_back(log_of_signal(signal, axes));
  }
  StudyErrors errors{{}, {}, fit_laws(logs, study.drag, study.extra_terms)};
  double stood_off_rad = study.stood_off_deg / kDegreesPerRadian;
  const auto judged = [&](AxisLog log) {
    log.q2_rad.array() += stood_off_rad;
    stood_off_rad = -stood_off_rad;
    const auto estimate = [&](const JointFile& law) { return simulate({log}, motion_parameters(law)); };
    const Eigen::VectorXd kinematic = study.rigid_ratio
                                          ? Eigen::VectorXd(plant.input_radius_m / plant.output_radius_m * log.q1_rad)
                                          : estimate(errors.laws.kinematic);
    return SignalErrors{fit_quality(log.q2_rad, kinematic, 1), fit_quality(log.q2_rad, estimate(errors.laws.thesis), 3),
                        law_error_deg(log, errors.laws.augmented), rms(log.tau_nm)};
  };
  for (const AxisLog& log : logs) {
    errors.identification.push_back(judged(log));
  }
  for (const Signal& signal : signals) {
    errors.signals.push_back(judged(log_of_signal(signal, later)));
  }
  return errors;
}

namespace {

auto not_tried() -> SignalErrors {
  const double none = std::nan("");
  return {{none, none, none}, {none, none, none}, none, none};
}

}  // namespace

auto estimation_table(std::string number, std::string title, const std::vector<StudyTrial>& trials, bool adjusted_r2)
    -> ThesisTable {
  ThesisTable table{std::move(number), std::move(title), {}, {}, {}};
  std::vector<std::string> groups = {"printed", "simulated"};
  for (const StudyTrial& t : trials) {
    groups.push_back(t.trial.group);
    table.trials.push_back(t.trial);
  }
  for (const std::string& group : groups) {
    table.columns.push_back({group, "km", "KM", "deg", 3});
    table.columns.push_back({group, "pm", "PM", "deg", 3});
    table.columns.push_back({group, "less", "less %", "%", 1, true});
    table.columns.push_back({group, "gof_km", "GoF KM", "%", 1});
    table.columns.push_back({group, "gof_pm", "GoF PM", "%", 1});
    if (adjusted_r2) {
      table.columns.push_back({group, "r2_km", "R2 KM", "1", 4});
      table.columns.push_back({group, "r2_pm", "R2 PM", "1", 4});
    }
    if (group == "simulated") {
      table.columns.push_back({group, "law", "law", "deg", 3});
    }
  }
  return table;
}

auto add_rows(ThesisTable& table, const std::vector<Signal>& signals, const Study& study,
              const std::vector<StudyTrial>& trials) -> std::vector<StudyErrors> {
  std::vector<StudyErrors> all = {run_study(study, signals)};
  for (const StudyTrial& t : trials) {
    const std::vector<Signal>& whole = t.instead.empty() ? signals : t.instead;
    std::vector<Signal> tried;
    for (const std::size_t i : t.only) {
      tried.push_back(whole[i]);
    }
    StudyErrors errors = run_study(t.study, t.only.empty() ? whole : tried);
    if (!t.only.empty()) {
      std::vector<SignalErrors> spread(signals.size(), not_tried());
      for (std::size_t k = 0; k < t.only.size(); ++k) {
        spread[t.only[k]] = errors.signals[k];
      }
      errors.signals = std::move(spread);
    }
    all.push_back(std::move(errors));
  }
  const bool adjusted_r2 =
      std::any_of(table.columns.begin(), table.columns.end(), [](const auto& column) { return column.key == "r2_km"; });
  for (std::size_t i = 0; i < signals.size(); ++i) {
    ThesisTable::Row row{signals[i].name, {}};
    const auto append = [&](const FitQuality& km, const FitQuality& pm) {
      row.values.insert(row.values.end(), {km.rmse_deg, pm.rmse_deg, 100.0 * (1.0 - pm.rmse_deg / km.rmse_deg),
                                           km.gof_percent, pm.gof_percent});
      if (adjusted_r2) {
        row.values.insert(row.values.end(), {km.adjusted_r2, pm.adjusted_r2});
      }
    };
    append(signals[i].km, signals[i].pm);
    for (std::size_t k = 0; k < all.size(); ++k) {
      append(all[k].signals[i].km, all[k].signals[i].pm);
      if (k == 0) {
        row.values.push_back(all[k].signals[i].law_deg);
      }
    }
    table.rows.push_back(std::move(row));
  }
  return all;
}

auto motor_deg(double joint_deg, const sim::PlantParameters& plant) -> double {
  return joint_deg * plant.output_radius_m / plant.input_radius_m;
}

auto sine_signal(std::string name, double frequency_hz, double duration_s, const FitQuality& km, const FitQuality& pm,
                 const sim::PlantParameters& plant) -> Signal {
  const double amplitude = motor_deg(std::numbers::sqrt2 * implied_rms_deg(km), plant);
  const auto scaled = [=](double factor) { return sine(factor * amplitude, frequency_hz, duration_s); };
  return {std::move(name), scaled(1.0), km, pm, scaled};
}

auto multisine_signal(std::string name, const std::vector<double>& frequencies_hz, double duration_s,
                      const FitQuality& km, const FitQuality& pm, const sim::PlantParameters& plant) -> Signal {
  const double motor_rms = motor_deg(implied_rms_deg(km), plant);
  const auto scaled = [=](double factor) { return multisine(factor * motor_rms, frequencies_hz, duration_s); };
  return {std::move(name), scaled(1.0), km, pm, scaled};
}

auto fitted_keys(const std::string& law) -> std::vector<std::string> {
  return {law, "gof_" + law, "r2_" + law};
}

auto fitted_places(const std::string& law, const std::vector<std::size_t>& rows) -> std::vector<ThesisTable::Place> {
  std::vector<ThesisTable::Place> places;
  for (const std::size_t row : rows) {
    for (const std::string& key : fitted_keys(law)) {
      places.push_back({row, key});
    }
  }
  return places;
}

auto thesis_parameters(const JointFile& law) -> std::array<double, 3> {
  const auto& theta = law.parameters.coefficients;
  const auto first = catalogue_term("tendon_elongation").first_coefficient;
  return {theta[first], theta[first + 1], theta[0]};
}

void add_parameter_columns(const std::string& group, ThesisTable& table) {
  table.columns.push_back({group, "alpha_t", "alpha_t", "rad/(N m)", 3});
  table.columns.push_back({group, "alpha_b", "alpha_b", "rad/(N m)", 3});
  table.columns.push_back({group, "beta", "beta", "1", 3});
}

}  // namespace capstan::tools
