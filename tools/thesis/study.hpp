// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "capstan/tools/thesis/laws.hpp"
#include "capstan/tools/thesis/rig.hpp"
#include "capstan/tools/thesis/table.hpp"

namespace capstan::tools {

using Instrument = std::vector<sim::InstrumentAxis>;

/// One of the built-in instruments, by name.
auto built_in(const char* name) -> Instrument;

/// The wrist with the right jaw of table 6.2 and its drag; the elbow of table 7.2.
auto wrist_of_chapter_6() -> Instrument;
auto elbow_of_chapter_7() -> Instrument;

/// How well an estimate fits, as the thesis counts it. Footnotes 4 and 5 of ch. 5 divide by the estimate's spread, but
/// RMSE / (1 - GoF) of KM and of PM agree to three digits in every printed row, and their estimates have not the same
/// spread: what was divided by is the measurement's.
struct FitQuality {
  double rmse_deg = 0.0;
  double gof_percent = 0.0;
  double adjusted_r2 = 0.0;  ///< with the sum of squares of the estimate, which is what the printed figures follow
  double gof_as_written_percent = 0.0;  ///< over the estimate's spread, as 5.5.2 and 6.4 write it
};

auto fit_quality(const Eigen::VectorXd& measured_rad, const Eigen::VectorXd& estimated_rad, int parameters)
    -> FitQuality;

/// A signal of a table with what is printed of it; NaN where nothing is.
struct Signal {
  std::string name;
  sim::Motion motion;
  FitQuality km, pm;
  /// The motor's motion by a factor, where the printed row says how far the joint went but not the motor.
  std::function<sim::Motion(double)> scaled = {};
};

/// The root mean square of the measured joint angle that a printed row implies: RMSE / (1 - GoF).
auto implied_rms_deg(const FitQuality& printed) -> double;

/// One instrument, or a variant of it, under the signals of a table.
struct Study {
  Instrument instrument;
  std::size_t axis = 0;
  std::vector<sim::Motion> identification;
  std::vector<Signal> identification_signals = {};  ///< after these
  bool drag = false;                                ///< PM is (6.21)
  std::vector<std::string> extra_terms = {};
  double late_s = 0.0;                 ///< the joint's camera, by the time stamps of its pictures
  bool rigid_ratio = false;            ///< KM with r1 / r2 instead of a ratio fitted to the logs
  double pretension_of_signals = 1.0;  ///< over that under which the laws are identified
  bool gravity_out = false;            ///< the plant's gravity is taken out of the torque before laws see it
  /// How far off its zero the tip stood where a run began that is judged, one way and the other in turn: its angle
  /// counts from there. Over the runs of an identification that averages out.
  double stood_off_deg = 0.0;
};

struct SignalErrors {
  FitQuality km, pm;
  double law_deg = 0.0;
  double torque_nm = 0.0;  ///< rms of the motor's torque
};

struct StudyErrors {
  std::vector<SignalErrors> signals;
  std::vector<SignalErrors> identification;
  Laws laws;
};

auto run_study(const Study& study, const std::vector<Signal>& signals) -> StudyErrors;

/// A named change of the study behind a table.
struct StudyTrial {
  ThesisTable::Trial trial;
  Study study;
  std::vector<std::size_t> only = {};  ///< the signals that it is tried on; empty: all
  std::vector<Signal> instead = {};    ///< the signals themselves, where they are what is changed
};

/// Columns km, pm, less, gof_km, gof_pm and, if printed, r2_km and r2_pm for the print, the simulator and every trial;
/// `law` for the simulator.
auto estimation_table(std::string number, std::string title, const std::vector<StudyTrial>& trials, bool adjusted_r2)
    -> ThesisTable;
/// Appends the signals' rows. Returns what the study itself gave, then each of the trials.
auto add_rows(ThesisTable& table, const std::vector<Signal>& signals, const Study& study,
              const std::vector<StudyTrial>& trials) -> std::vector<StudyErrors>;

/// What the motor has to turn so that r1 / r2 of it is this much at the joint.
auto motor_deg(double joint_deg, const sim::PlantParameters& plant) -> double;
/// A signal under which the joint goes as far as the printed RMSE and GoF of the kinematic model say.
auto sine_signal(std::string name, double frequency_hz, double duration_s, const FitQuality& km, const FitQuality& pm,
                 const sim::PlantParameters& plant) -> Signal;
auto multisine_signal(std::string name, const std::vector<double>& frequencies_hz, double duration_s,
                      const FitQuality& km, const FitQuality& pm, const sim::PlantParameters& plant) -> Signal;

/// Places of a study's table whose error of a law a number was chosen by: "km" or "pm" of these rows. The goodness of
/// fit and R-squared go with it, for the measurement's spread is the printed one.
auto fitted_places(const std::string& law, const std::vector<std::size_t>& rows) -> std::vector<ThesisTable::Place>;
/// The same keys for a row of the simulator's own.
auto fitted_keys(const std::string& law) -> std::vector<std::string>;

/// alpha_t, alpha_b, beta.
auto thesis_parameters(const JointFile& law) -> std::array<double, 3>;
/// Columns of a table for these three.
void add_parameter_columns(const std::string& group, ThesisTable& table);

}  // namespace capstan::tools
