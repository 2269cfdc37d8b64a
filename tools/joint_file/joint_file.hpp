// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "capstan/model/motion_law.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/identify/torque_parts.hpp"
#include "capstan/tools/joint_file/error_bar_numbers.hpp"
#include "capstan/tools/joint_file/pretension_numbers.hpp"

namespace capstan::tools {

using Interval = std::array<double, 2>;

/// Motor torque while the motor moves steadily, N m: what the feedforward takes as the torque of a motion to come.
struct SteadyTorque {
  double forward_nm = 0.0;
  double backward_nm = 0.0;
};

/// Every number of a law of either family, in its catalogue's order.
struct LawNumbers {
  std::vector<double> coefficients;
  Shapes shapes;
  ConditionerShape<double> conditioner{};
};

/// How well the law reproduced the logs it was fitted to.
struct FitSummary {
  double rmse = 0.0;  ///< in the target's unit
  double gof_percent = 0.0;
  long samples = 0;
  std::optional<Interval> motor_range = {};       ///< of the motor angle in the logs, rad
  std::optional<double> loop_half_width = {};     ///< of a law with tendons: of the loop in the logs, at the motor, rad
  std::optional<double> loop_torque = {};         ///< that it takes, Nm
  std::optional<double> late = {};                ///< by which the joint's sensor is later than the motor's, s
  std::optional<TorqueParts> torque = {};         ///< of the motor beyond the loop
  std::optional<double> friction_rms = {};        ///< of a stretch's friction beyond the steady torque, Nm
  std::optional<ErrorBarNumbers> error_bar = {};  ///< of the estimate, in motions like the logs'
  std::optional<PretensionNumbers> pretension = {};  ///< of a law with tendons
  double joint_range = 0.0;                          ///< of the target in the logs: its way from end to end
  std::vector<std::string> logs;
};

inline constexpr const char* kJointSchema = "capstan.joint/1";
/// Written for people and other programs; nothing here reads it back, for nothing runs a law of an effort.
inline constexpr const char* kEffortSchema = "capstan.effort/1";
inline constexpr std::string_view kEffortSchemas = "capstan.effort/";  ///< of any version
/// What the text of a law or a machine says its schema is, before its first section; empty where it says nothing.
auto schema_of(std::string_view text) -> std::string_view;

/// How sure a law is. A board runs each of them; its shell says which it is.
enum class LawStatus : std::uint8_t {
  kConfirmed,    ///< its effects are named and certain; also a model that was asked for by name
  kProvisional,  ///< it lowers the error on unseen rows for certain; what it is made of is not
  kBase,         ///< nothing was found that lowers the error
};
/// The word of joint.toml.
auto word_of(LawStatus status) -> const char*;

/// A law as a file: the numbers with units and intervals. Terms that are absent are off.
struct JointFile {
  /// With every effect off and shapes at their initial values; beta = 1 where there is one.
  JointFile() : JointFile(term_catalogue()) {}
  explicit JointFile(const Catalogue& of);

  const Catalogue* catalogue;
  LawNumbers parameters;
  std::vector<std::string> terms;  ///< names of the terms that are on, in the order of the catalogue
  std::vector<std::optional<Interval>> coefficient_ci95, shape_ci95;
  std::optional<SteadyTorque> steady_torque;
  std::vector<int> coupled_to;  ///< numbers of the axes whose motors pull at this one, by slots of the coupling
  LawStatus status = LawStatus::kConfirmed;
  std::optional<FitSummary> fit;

  [[nodiscard]] auto has(const std::string& term) const -> bool;
  /// Coefficient `i` of a term is nothing, and no bound holds it there: the law took other parts of the term.
  [[nodiscard]] auto left_out(const CatalogueTerm& term, std::size_t i) const -> bool;
};

/// Ends of the firmware's numbers, and so of a joint file's; the largest is one step below 128.
inline constexpr double kLargestNumber = 127.999999;
/// Below this ratio the law could not be turned round for the feedforward within the range of numbers.
inline constexpr double kSmallestBeta = 0.01;

/// Ratio of the joint to its motor, of a law of a joint's angle.
auto beta_of(const JointFile& joint) -> double;

/// Slots of the coupling that the law's terms read, from the first.
auto slots_used(const JointFile& joint) -> std::size_t;

/// Parameters of a law with every effect off (shapes at their initial values), beta = 1.
auto rigid_law() -> LawParameters<double>;

/// What the firmware and MotionLaw<double> take. Throws Refusal for a law of an effort: nothing runs one.
auto motion_parameters(const JointFile& joint) -> LawParameters<double>;

/// The same law in the firmware's numbers. @pre every number is within +-128; read_joint_file() and the fits see to it
auto to_fixed(const LawParameters<double>& parameters) -> LawParameters<Q24>;

/// Throws BadInput: one sentence with file, line and cure for an unknown key, a missing value, a number that is not
/// finite, a wrong unit, or a value out of range.
auto read_joint_file(const std::string& path) -> JointFile;
auto parse_joint_file(const std::string& text, const std::string& name) -> JointFile;

auto joint_file_text(const JointFile& joint) -> std::string;
void write_joint_file(const std::string& path, const JointFile& joint);

}  // namespace capstan::tools
