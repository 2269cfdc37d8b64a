// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// Whether the model is a law of the joint torque: pull_push or preisach.
auto is_force_model(const std::string& model) -> bool;
/// One of these, or the blend of two, which is fitted and run but no law to start a diagnosis from.
auto is_force_law(const std::string& model) -> bool;

/// Motor torque to joint torque: the force law of that name as the first term, then what an effort may hold beside it,
/// creep of the tendon, and OutputTerms.
///   pull_push  coefficient r2 / r1; shapes eta_top, eta_bottom, pretension I r1, and of the logged torque friction and
///              offset, which do not reach the tendons: (2.16) to (2.21)
///   preisach   the lower saturation and a weight per cell of the grid, none negative: (4.4), (4.5) as a sum of relays;
///              its shapes are the grid's ends, known before the fit
auto force_catalogue(const std::string& model) -> const Catalogue&;

/// The base law of a force model, its shapes started where these logs say. Throws Refusal where they do not determine a
/// start, with what to record. @pre every log has motor torque and joint torque
auto force_form(const std::string& model, const std::vector<AxisLog>& logs) -> LawForm;

/// A pull-push law as identify fits and writes it, as a law of the catalogue. @pre its kind is kPullPush
auto pull_push_joint(const PullPushFit& fit) -> JointFile;

/// What the steps of a Preisach grid may hide, by Richardson's rule from a grid twice as wide. Zero for laws without a
/// grid.
auto hidden_by_grid(const LawDesign& design, const LawForm& form, const Eigen::VectorXd& fitted) -> Eigen::VectorXd;

/// A log averaged over stretches, so that no log has more rows than a quasi-static law can tell apart, and the noise of
/// the torque is not taken for reversals.
auto averaged_for_force(const std::string& model, const AxisLog& log) -> AxisLog;

}  // namespace capstan::tools
