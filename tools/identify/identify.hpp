// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// Terms of a base law by its name in the command line. Throws Refusal for a model that this version does not have and
/// BadInput for one that nobody has.
auto terms_of_model(const std::string& model) -> std::vector<std::string>;
inline constexpr const char* kDefaultModel = "pseudo_kinematic";
/// The base law of an effort: q1'' and q1'; and q1'' alone.
inline constexpr const char* kEffortModel = "rigid_dynamics";
inline constexpr const char* kInertiaModel = "inertia";
auto is_effort_model(const std::string& model) -> bool;

/// The catalogue that a model's laws are made of, for these logs. Throws BadInput where the model explains an effort
/// and the logs have a joint angle as target, or the other way round.
auto catalogue_of_model(const std::string& model, const std::vector<AxisLog>& logs) -> const Catalogue&;
/// The model as a law to be fitted. Throws as catalogue_of_model(), and Refusal where a force law finds no start.
auto form_of_model(const std::string& model, const std::vector<AxisLog>& logs) -> LawForm;

struct Identification {
  JointFile joint;
  std::vector<std::string> undetermined;  ///< parameters that these logs can not determine
  std::vector<std::string> notes;         ///< how things were chosen, and what to look at
  Eigen::VectorXd estimate;               ///< of all logs, one below the other
};

/// The conditioner for these logs: the direction threshold from noise and resolution of q1 and, where the law has
/// torque, the best fit among its multiples.
auto choose_conditioner(const std::vector<AxisLog>& logs, const LawForm& form, std::vector<std::string>& notes)
    -> ConditionerShape<double>;

/// The conditioner with the direction threshold, from just above the noise upwards, that serves a law best.
auto choose_direction_threshold(const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
                                const LawForm& form, const ConditionerShape<double>& conditioner)
    -> ConditionerShape<double>;

/// The conditioner with the rate filter that serves a law of the joint angle with rates in it best: a slow one lags, a
/// fast one trembles with the encoder.
auto choose_rate_filter(const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
                        const LawForm& form, const ConditionerShape<double>& conditioner) -> ConditionerShape<double>;

/// The same of a law whose tendons are fitted already: they take the torque through the same filters. Slow ones let the
/// motor ring out first, fast ones tremble with the encoder, and tendons keep what a peak does to their tension.
auto choose_tendon_filter(const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
                          const LawForm& form, const ConditionerShape<double>& conditioner) -> ConditionerShape<double>;

/// Blocks for intervals: longer than what the residual of all rows remembers on the pieces, as many as that allows (8
/// to 60, and one a piece).
auto interval_blocks(const Blocks& pieces, const Eigen::VectorXd& residual) -> Blocks;

/// Samples for a fit: causal ones, as the firmware has them, or for an effort those of the given motion, with rates
/// that do not lag, every column averaged as the effort has to be.
auto design_for(const std::vector<AxisLog>& logs, const LawForm& form, const ConditionerShape<double>& conditioner)
    -> LawDesign;

/// Fits a law to logs of one joint, its shapes too. @pre every log has the target
auto identify(const std::vector<AxisLog>& logs, const LawForm& start) -> Identification;

/// Writes into the law what the logs say beside its terms: steady torque, the axis that pulls, how well it fits. What a
/// person should know of that is the answer.
auto describe_logs(const std::vector<AxisLog>& logs, const LawDesign& design, const Eigen::VectorXd& target,
                   const Eigen::VectorXd& estimate, JointFile& joint) -> std::vector<std::string>;

/// Median torque of steady motion forward and backward; nothing for an effort law, which has the torque as its target.
auto steady_torque(const std::vector<AxisLog>& logs, const LawDesign& design) -> std::optional<SteadyTorque>;

/// How far an effort law's design averages, for people.
auto averaging_note(const LawDesign& design) -> std::string;

/// Names of coefficients that the fit leaves undetermined.
auto undetermined_coefficients(const LinearFit& fit, const LawForm& form, const Eigen::MatrixXd& columns,
                               const Eigen::VectorXd& target) -> std::vector<std::string>;

}  // namespace capstan::tools
