// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/run/run.hpp"
#include "capstan/tools/thesis/laws.hpp"
#include "capstan/tools/thesis/rig.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {
namespace {

using Instrument = std::vector<sim::InstrumentAxis>;

auto instrument(const char* name) -> Instrument {
  return sim::parse_instrument(sim::built_in_instrument(name), name).axes;
}

/// Pictures at 20 Hz, as the thesis has them, of which each is known one picture later.
auto with_late_camera(Instrument axes) -> Instrument {
  for (sim::InstrumentAxis& axis : axes) {
    axis.plant.camera_delay_s = 0.05;
  }
  return axes;
}

auto less_percent(double pm, double km) -> double {
  return 100.0 * (1.0 - pm / km);
}

struct Signal {
  std::string name;
  sim::Motion motion;
  double km_deg, pm_deg;  ///< as printed
  std::string why;
};

/// One instrument, or a variant of it, under the signals of a table.
struct Study {
  Instrument instrument;
  std::size_t axis = 0;
  std::vector<sim::Motion> identification;
  bool drag = false;
  std::vector<std::string> extra_terms = {};
};

struct StudyErrors {
  std::vector<std::array<double, 3>> deg;  ///< KM, PM, augmented law, of each signal
  Laws laws;
};

auto errors_of(const Study& study, const std::vector<Signal>& signals) -> StudyErrors {
  std::uint64_t seed = 1;
  const auto log_of = [&](const sim::Motion& motion) {
    return run_experiment(study.instrument, study.axis, motion, stiff_gains(), seed++).log;
  };
  std::vector<AxisLog> logs;
  for (const sim::Motion& motion : study.identification) {
    logs.push_back(log_of(motion));
  }
  StudyErrors errors{{}, fit_laws(logs, study.drag, study.extra_terms)};
  for (const Signal& signal : signals) {
    const AxisLog log = log_of(signal.motion);
    errors.deg.push_back({law_error_deg(log, errors.laws.kinematic), law_error_deg(log, errors.laws.thesis),
                          law_error_deg(log, errors.laws.augmented)});
  }
  return errors;
}

auto estimation_table(std::string number, std::string title, const std::string& variant) -> ThesisTable {
  ThesisTable table{std::move(number), std::move(title), {}, {}, {}};
  for (const std::string& group : {std::string("printed"), std::string("simulated"), variant}) {
    table.columns.push_back({group, "km", "KM", "deg", 3});
    table.columns.push_back({group, "pm", "PM", "deg", 3});
    table.columns.push_back({group, "less", "less %", "%", 1});
    if (group != "printed") {
      table.columns.push_back({group, "law", "law", "deg", 3});
    }
  }
  return table;
}

/// Appends the signals' rows: printed, the instrument, its variant.
auto add_rows(ThesisTable& table, const std::vector<Signal>& signals, const Study& study, const Study& variant)
    -> StudyErrors {
  const StudyErrors plain = errors_of(study, signals);
  const StudyErrors varied = errors_of(variant, signals);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal& s = signals[i];
    ThesisTable::Row row{s.name, {s.km_deg, s.pm_deg, less_percent(s.pm_deg, s.km_deg)}, s.why};
    for (const auto& deg : {plain.deg[i], varied.deg[i]}) {
      row.values.insert(row.values.end(), {deg[0], deg[1], less_percent(deg[1], deg[0]), deg[2]});
    }
    table.rows.push_back(std::move(row));
  }
  return plain;
}

/// The 15 experiments of 5.5.2: sines of 0.1 Hz and 20 to 2.5 deg, each three times.
auto forceps_identification() -> std::vector<sim::Motion> {
  std::vector<sim::Motion> motions;
  for (const double amplitude : {20.0, 15.0, 10.0, 5.0, 2.5}) {
    motions.insert(motions.end(), 3, sine(amplitude, 0.1, 20.0));
  }
  return motions;
}

/// What the motor has to turn so that beta q1 has this root mean square, or amplitude.
auto motor_deg(double joint_deg, const sim::PlantParameters& p) -> double {
  return joint_deg * p.output_radius_m / p.input_radius_m;
}

const std::string kLateCamera = "late camera";
const std::string kLateCameraIs =
    "late camera: by 50 ms, one picture at the printed 20 Hz; the law then has transport_delay.";

}  // namespace

auto table_5_2() -> ThesisTable {
  ThesisTable table =
      estimation_table("5.2", "da Vinci micro-forceps: joint angle from motor angle and torque, RMSE", kLateCamera);
  const std::vector<double> tones = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1};
  const std::string slow =
      "at this speed KM is the loop alone, and its width follows from friction, stiffness and pretension of ch. 2, "
      "which "
      "were measured with the tip locked: a moving tip adds the friction of its joint, which is not printed.";
  const std::string fast =
      "a loop of friction and elasticity knows no frequency, so the simulated errors stay; the printed ones grow, and "
      "a "
      "camera whose pictures come late makes them grow.";
  const std::vector<Signal> signals = {
      {"sine 0.05 Hz", sine(15.0, 0.05, 40.0), 3.1258, 1.2522, slow},
      {"sine 0.1 Hz", sine(15.0, 0.1, 20.0), 3.7478, 1.6282, fast},
      {"sine 0.2 Hz", sine(15.0, 0.2, 10.0), 4.2512, 2.1241, fast},
      {"multisine 0.01-0.1 Hz", multisine(4.5, tones, 100.0), 2.2743, 0.8607,
       "slow enough for every delay, and the small reversals in it favour PM less: both as printed."}};
  const Study study{instrument("micro_forceps"), 0, forceps_identification()};
  const Study late{with_late_camera(study.instrument), 0, study.identification, false, {"transport_delay"}};
  const StudyErrors errors = add_rows(table, signals, study, late);
  table.conditions = {"identified, printed: alpha_t -1.626, alpha_b -1.213, beta 1.142; simulated: " +
                          parameter_line(errors.laws.thesis),
                      kLateCameraIs};
  return table;
}

auto table_5_3() -> ThesisTable {
  const Instrument forceps = instrument("micro_forceps");
  const Laws laws = errors_of({forceps, 0, forceps_identification()}, {}).laws;
  ThesisTable table{"5.3",
                    "da Vinci micro-forceps: control of the joint through the estimate, RMSE",
                    {},
                    {{"printed", "km", "KM", "deg", 3},
                     {"printed", "pm", "PM", "deg", 3},
                     {"printed", "control", "control", "deg", 3},
                     {"simulated", "km", "KM", "deg", 3},
                     {"simulated", "pm", "PM", "deg", 3},
                     {"simulated", "control", "control", "deg", 3},
                     {"capstan", "pm_control", "by PM", "deg", 3},
                     {"capstan", "law", "law", "deg", 3},
                     {"capstan", "control", "control", "deg", 3}},
                    {}};
  const std::string stuck =
      "the printed gains are in A, and the motor's N m/A is not printed; with the simulated motor's 0.1 they give 0.29 "
      "N m/rad against 0.09 N m of friction in tendons and motor, so the joint stands until the integral has come up, "
      "and moves less than was asked.";
  const std::vector<Signal> signals = {
      {"sine 0.01 Hz", sine(15.0, 0.01, 200.0), 3.1330, 1.2761, stuck},
      {"sine 0.05 Hz", sine(15.0, 0.05, 40.0), 3.2818, 1.2499, stuck},
      {"sine 0.1 Hz", sine(15.0, 0.1, 20.0), 4.0079, 2.1849, stuck},
      {"sine 0.2 Hz", sine(15.0, 0.2, 10.0), 6.1706, 4.4009, stuck},
      {"decaying 0.01 Hz", decaying_sine(15.0, 0.01, 0.025, 150.0), 1.7045, 0.8213, stuck},
      {"multisine 0.015-0.075", multisine(7.0, {0.015, 0.03, 0.045, 0.06, 0.075}, 66.7), 2.8541, 1.3385, stuck}};
  constexpr std::array<double, 6> kControl = {1.4920, 2.3546, 4.0821, 7.2908, 0.5289, 1.6321};
  constexpr double kDegrees = 57.29577951308232;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal& s = signals[i];
    MotionLaw<double> estimator(SamplePeriod<double>(0.01), motion_parameters(laws.thesis));
    const Experiment run = run_experiment(forceps, 0, s.motion, thesis_gains(), 200,
                                          [&](double q1, double tau) { return estimator.update(q1, tau).q2; });
    const auto firmware = [&](const JointFile& law) {
      sim::Scenario scenario;
      scenario.seed = 200;
      scenario.motion = s.motion;
      scenario.duration_s = s.motion.duration_s();
      FileBanks banks = FileBanks::temporary();
      return run_scenario(scenario, model_lines(law, 0), banks, nullptr).joints[0];
    };
    const JointErrors by_pm = firmware(laws.thesis);
    const JointErrors own = firmware(laws.augmented);
    table.rows.push_back(
        {s.name,
         {s.km_deg, s.pm_deg, kControl[i], law_error_deg(run.log, laws.kinematic), law_error_deg(run.log, laws.thesis),
          rms_deg(run.wanted_rad - run.log.q2_rad), by_pm.tracking_rmse_rad * kDegrees,
          own.estimation_rmse_rad * kDegrees, own.tracking_rmse_rad * kDegrees},
         s.why});
  }
  table.conditions = {
      "simulated: the printed PID on the estimate of PM at 100 Hz. capstan: its firmware, by PM and by the law; "
      "amplitude 15 deg, multisine 7 deg RMS, as the thesis prints none."};
  return table;
}

auto table_6_2() -> ThesisTable {
  ThesisTable table = estimation_table("6.2", "da Vinci wrist: both jaws, dynamic law (6.21), RMSE", kLateCamera);
  struct Tones {
    const char* name;
    std::vector<double> frequencies_hz;
    double duration_s;
    std::array<double, 2> estimate_rms_deg, km, pm;  // right, left; the first is RMSE / (1 - GoF) as printed
  };
  const std::vector<Tones> all = {
      {"I", {0.2, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.3}, 20.0, {9.98, 8.77}, {4.0539, 3.6706}, {1.1175, 1.7892}},
      {"II", {0.4, 0.7, 1.0, 1.3, 1.6, 1.9, 2.2}, 20.0, {9.33, 10.30}, {4.060, 3.9115}, {1.083, 1.3599}},
      {"III", {0.05, 0.1, 1.0}, 20.0, {11.25, 10.75}, {3.1377, 2.5800}, {1.2733, 1.3295}},
      {"IV", {0.05, 0.25, 0.45, 0.65}, 20.0, {7.05, 6.67}, {2.7831, 2.1206}, {1.5760, 1.3704}},
      {"V", {0.05, 0.07, 0.09}, 100.0, {10.5, 10.8}, {2.012, 1.6037}, {0.8222, 0.6593}}};
  const std::string fast =
      "the printed KM grows with frequency, the simulated one does not, for its tendons have no drag; a camera that is "
      "late by a picture makes the same growth, and the speed of (6.21) absorbs it as it would absorb drag: the table "
      "cannot tell the two apart.";
  const std::string slow =
      "without speed only the loop is left, whose width is friction over stiffness: that of this jaw as identified in "
      "table 6.1.";
  const Instrument wrist = instrument("da_vinci_wrist");
  for (std::size_t jaw = 0; jaw < 2; ++jaw) {
    const std::string name = jaw == 0 ? "right jaw" : "left jaw";
    std::vector<Signal> signals;
    for (const Tones& t : all) {
      const double rms = motor_deg(t.estimate_rms_deg[jaw], wrist[jaw + 1].plant);
      signals.push_back({name + " " + t.name, multisine(rms, t.frequencies_hz, t.duration_s), t.km[jaw], t.pm[jaw],
                         std::string(t.name) == "V" ? slow : fast});
    }
    const Study study{wrist, jaw + 1, {signals.front().motion}, true};
    const Study late{with_late_camera(wrist), jaw + 1, study.identification, true, {"transport_delay"}};
    const StudyErrors errors = add_rows(table, signals, study, late);
    table.conditions.push_back(name + ", identified on I: " + parameter_line(errors.laws.thesis));
  }
  table.conditions.push_back(kLateCameraIs);
  return table;
}

auto table_7_2() -> ThesisTable {
  ThesisTable table =
      estimation_table("7.2", "RAVEN II elbow: joint angle from motor angle and torque, RMSE", "half friction");
  // One axis alone: the first three axes of RAVEN II do not pull on each other.
  Instrument elbow = {instrument("raven2")[1]};
  sim::PlantParameters& plant = elbow[0].plant;
  plant.pretension_n = 1.0;
  Instrument smoother = elbow;
  smoother[0].plant.joint_coulomb_nm *= 0.5;
  const std::string why =
      "the loop of a slack drive is as wide as the joint's friction stretches one tendon, and that friction, 0.01 N m, "
      "is "
      "an estimate: half of it gives about the printed KM.";
  const std::vector<Signal> signals = {
      {"I sine 0.1 Hz", sine(motor_deg(6.59, plant), 0.1, 20.0), 1.2546, 0.5073, why},
      {"II sine 0.2 Hz", sine(motor_deg(6.96, plant), 0.2, 10.0), 1.5927, 0.7749, why},
      {"III multisine", multisine(motor_deg(9.79, plant), {0.05, 0.07, 0.09}, 100.0), 1.4977, 0.7830, why},
      {"IV multisine", multisine(motor_deg(4.04, plant), {0.05, 0.075, 0.1, 0.125, 0.15, 0.16}, 200.0), 1.5680, 0.9106,
       why},
      {"V multisine", multisine(motor_deg(5.20, plant), {0.08, 0.1, 0.12, 0.14}, 50.0), 1.2557, 0.6239, why}};
  const Study study{elbow, 0, {signals[2].motion}};
  const StudyErrors errors = add_rows(table, signals, study, {smoother, 0, study.identification});
  table.conditions = {
      "identified on III, printed: alpha_t -5.302, alpha_b -1.002, beta 0.839; simulated: " +
          parameter_line(errors.laws.thesis),
      "pretension 1 N: the thesis measured with next to none. Half friction: the elbow's Coulomb friction halved."};
  return table;
}

}  // namespace capstan::tools
