// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/identify.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/identify/given_motion.hpp"
#include "capstan/tools/identify/known_direction.hpp"
#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kCoupledModel = "multi_dof";

/// Lag, in samples, at which the residual's autocorrelation first falls to a tenth, looked for on a coarsening grid.
auto memory_of(const Eigen::VectorXd& residual) -> Eigen::Index {
  const Eigen::VectorXd centred = residual.array() - residual.mean();
  const double power = centred.squaredNorm();
  if (power <= 0.0) {
    return 1;
  }
  for (Eigen::Index lag = 1; lag < centred.size() / 4; lag += 1 + lag / 16) {
    const double covariance = centred.head(centred.size() - lag).dot(centred.tail(centred.size() - lag));
    if (covariance < 0.1 * power) {
      return lag;
    }
  }
  return residual.size() / 4;
}

/// Names "term.coefficient" of a law's columns, in their order.
auto column_names(const LawForm& form) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& term : *form.catalogue) {
    if (form.has(term.name)) {
      for (const auto& coefficient : term.coefficients) {
        names.push_back(term.name + "." + coefficient.name);
      }
    }
  }
  return names;
}

void note_bounds(const LinearFit& fit, const LawForm& form, const AxisLog& log, std::vector<std::string>& notes) {
  const auto names = column_names(form);
  const auto beta = std::find(names.begin(), names.end(), "motor_angle.beta");
  const bool crossed = beta != names.end() && fit.theta[beta - names.begin()] < 0.0;
  // Of a joint that is counted against its motor, a torque that is turned too would make a law that acts the wrong way.
  const std::string turned =
      "check the sign of tau_Nm (--map \"" + axis_column(log.number, "tau_Nm") + "=COLUMN*-1\" turns it)";
  // Of an effort whose other coefficients have their signs, the torque's sign is right.
  const bool lacks = form.catalogue->target() == TargetKind::kEffort &&
                     std::find(fit.at_bound.begin(), fit.at_bound.end(), false) != fit.at_bound.end();
  std::string why = "the fit gives a sign that is physically impossible; " + turned;
  if (crossed) {
    why =
        "the joint is counted against its motor, and effects have the signs of one that goes with it; count it the "
        "other way (--map \"" +
        log.target + "=COLUMN*-1\")";
  } else if (lacks) {
    why =
        "the fit gives a sign that is physically impossible; the law probably lacks an effect, such as dry friction or "
        "a spring: "
        "'capstan diagnose --target " +
        log.target + "' finds what";
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (fit.at_bound[i] && fit.tolerance[static_cast<Eigen::Index>(i)] > 0.0) {
      notes.push_back(names[i] + " is held at 0: " + why);
    }
  }
}

}  // namespace

auto terms_of_model(const std::string& model) -> std::vector<std::string> {
  if (model == "kinematic") {
    return {"motor_angle", "joint_offset"};
  }
  if (model == "pseudo_kinematic") {
    return {"motor_angle", "joint_offset", "tendon_elongation"};
  }
  if (model == "pretensioned") {  // (5.30)
    return {"motor_angle", "joint_offset", "tendon_elongation", "pretension_offset"};
  }
  if (model == "dynamic") {  // (6.21)
    return {"motor_angle", "joint_offset", "tendon_elongation", "transmission_viscous"};
  }
  if (model == kCoupledModel) {  // a row of (6.8)
    return {"motor_angle", "joint_offset", "tendon_elongation", "axis_coupling"};
  }
  if (model == kTendonModel) {
    return {"motor_angle", "joint_offset", "tendon"};
  }
  if (model == kEffortModel) {
    return {"inertia", "viscous_friction"};
  }
  if (model == kInertiaModel) {
    return {"inertia"};
  }
  if (is_force_model(model)) {
    return {model};
  }
  throw BadInput(
      "there is no model " + model +
      "; there are kinematic, pseudo_kinematic, pretensioned, dynamic, multi_dof, tendon, rigid_dynamics, inertia, " +
      "pull_push, blend and preisach");
}

auto is_effort_model(const std::string& model) -> bool {
  return model == kEffortModel || model == kInertiaModel;
}

auto catalogue_of_model(const std::string& model, const std::vector<AxisLog>& logs) -> const Catalogue& {
  const bool of_motion = logs.front().motion_alone();
  if (of_motion != is_effort_model(model) && !is_force_model(model)) {
    throw BadInput(of_motion ? "the model " + model + " explains a joint angle, and the target " + logs.front().target +
                                   " is an effort; choose " + kEffortModel
                             : "the model " + model + " explains an effort, and the target " + logs.front().target +
                                   " is a joint angle; name the effort with --target axis0/tau_Nm");
  }
  if (is_force_model(model)) {
    if (logs.front().effort.size() == 0) {
      throw BadInput("the model " + model + " explains the joint's torque, and the target " + logs.front().target +
                     " is a joint angle; name the torque with --target axis0/tau_out_Nm");
    }
    return force_catalogue(model);
  }
  return of_motion ? effort_catalogue(logs.front().linear ? AxisKind::kLinear : AxisKind::kRotary) : term_catalogue();
}

auto form_of_model(const std::string& model, const std::vector<AxisLog>& logs) -> LawForm {
  if (is_force_model(model)) {
    return force_form(model, logs);
  }
  LawForm form;
  form.terms = terms_of_model(model);
  if (model == kCoupledModel) {
    constexpr const char* kFurther[] = {"axis_coupling_2", "axis_coupling_3"};
    for (std::size_t slot = 1; slot < std::min(logs.front().others_asked, kMostOthers); ++slot) {
      form.terms.emplace_back(kFurther[slot - 1]);
    }
  }
  form.catalogue = &catalogue_of_model(model, logs);
  form.shapes = form.catalogue->initial_shapes();
  return form;
}

auto design_for(const std::vector<AxisLog>& logs, const LawForm& form, const ConditionerShape<double>& conditioner)
    -> LawDesign {
  if (form.catalogue->target() != TargetKind::kEffort) {
    return {logs, conditioner};
  }
  const AngleNoise noise = motor_angle_noise(logs);
  std::vector<Samples> samples;
  for (const auto& log : logs) {
    samples.push_back(given_motion(log, conditioner, noise).samples);
  }
  return {logs, std::move(samples), effort_smoothing(logs, noise)};
}

auto averaging_note(const LawDesign& design) -> std::string {
  const double span_ms = 2e3 * static_cast<double>(2 * design.smoothing() + 1) * design.period_s(0);
  return design.smoothing() == 0 ? "effort and law are compared sample by sample"
                                 : "effort and law are averaged alike, over " + rounded(span_ms, 2) +
                                       " ms with a triangular weight, against the noise of the acceleration";
}

namespace {

/// The conditioner with that value of one of its shapes which serves a law best. Values come from the quick to the
/// slow: what lags more has to earn its place.
auto with_best(double ConditionerShape<double>::*shape, const std::vector<double>& values,
               const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
               const LawForm& form, ConditionerShape<double> conditioner) -> ConditionerShape<double> {
  constexpr double kWorthIts = 0.995;
  double best = std::numeric_limits<double>::infinity();
  ConditionerShape<double> trial = conditioner;
  for (const double value : values) {
    trial.*shape = value;
    const double rmse = fit_law(LawDesign(logs, trial), target, blocks, form).rmse;
    if (rmse < kWorthIts * best) {
      best = rmse;
      conditioner = trial;
    }
  }
  return conditioner;
}

}  // namespace

auto choose_direction_threshold(const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
                                const LawForm& form, const ConditionerShape<double>& conditioner)
    -> ConditionerShape<double> {
  return with_best(&ConditionerShape<double>::direction_threshold_rad,
                   direction_thresholds(logs, motor_angle_noise(logs)), logs, target, blocks, form, conditioner);
}

auto choose_conditioner(const std::vector<AxisLog>& logs, const LawForm& form, std::vector<std::string>& notes)
    -> ConditionerShape<double> {
  ConditionerShape<double> shape;
  if (form.has(kTendonModel)) {
    shape.rate_time_constant_s = kTendonRateFilterS;
  }
  const AngleNoise noise = motor_angle_noise(logs);
  const auto thresholds = direction_thresholds(logs, noise);
  shape.direction_threshold_rad = thresholds.front();
  std::string how = "just above the noise of q1";
  if (form.has("tendon_elongation") && thresholds.size() > 1) {
    std::vector<Eigen::Index> log_rows;
    std::transform(logs.begin(), logs.end(), std::back_inserter(log_rows),
                   [](const auto& log) { return log.samples(); });
    shape = with_best(&ConditionerShape<double>::direction_threshold_rad, thresholds, logs, stacked_target(logs),
                      even_blocks(log_rows, 2), form, shape);
    how = "the best fit among " + std::to_string(thresholds.size()) + " from " + rounded(thresholds.front(), 2) +
          " rad up";
  }
  const std::string unit = " " + form.catalogue->motion_unit();
  if (shape.direction_threshold_rad < noise.step_rad) {
    how += ", below one count, because the encoder showed no jitter";
  }
  notes.push_back("direction threshold " + rounded(shape.direction_threshold_rad, 3) + unit + ": " + how +
                  " (resolution " + rounded(noise.step_rad, 3) + unit + ", noise " + rounded(noise.white_rad, 2) +
                  unit + ")");
  return shape;
}

auto choose_rate_filter(const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
                        const LawForm& form, const ConditionerShape<double>& conditioner) -> ConditionerShape<double> {
  const bool has_rates = form.has("transmission_viscous") || form.has("load_inertia");
  if (form.catalogue->target() != TargetKind::kAngle || !has_rates || form.has(kTendonModel)) {
    return conditioner;
  }
  return with_best(&ConditionerShape<double>::rate_time_constant_s, {0.002, 0.004, 0.008, 0.016, 0.032}, logs, target,
                   blocks, form, conditioner);
}

auto choose_tendon_filter(const std::vector<AxisLog>& logs, const Eigen::VectorXd& target, const Blocks& blocks,
                          const LawForm& form, const ConditionerShape<double>& conditioner)
    -> ConditionerShape<double> {
  return with_best(&ConditionerShape<double>::rate_time_constant_s,
                   {0.5 * kTendonRateFilterS, kTendonRateFilterS, 2.0 * kTendonRateFilterS, 4.0 * kTendonRateFilterS},
                   logs, target, blocks, form, conditioner);
}

auto interval_blocks(const Blocks& pieces, const Eigen::VectorXd& residual) -> Blocks {
  constexpr Eigen::Index kFewest = 8;
  constexpr Eigen::Index kMost = 60;
  constexpr Eigen::Index kMemoriesPerBlock = 8;
  const Eigen::Index wanted = rows_in(pieces) / (kMemoriesPerBlock * memory_of(stacked(residual, pieces)));
  return even_parts(pieces, std::clamp(wanted, kFewest, kMost));
}

namespace {

/// Columns that others reproduce: those with a part in a direction in which the scaled columns add up to nothing. Signs
/// play no part here, for a copy stays one when a sign holds it at zero.
auto copied_columns(const Eigen::MatrixXd& columns) -> std::vector<bool> {
  constexpr double kNothing = 1e-9;
  constexpr double kPart = 0.01;
  Eigen::VectorXd scale = columns.colwise().norm();
  for (double& value : scale) {
    value = value > 0.0 ? 1.0 / value : 0.0;
  }
  const Eigen::MatrixXd gram = scale.asDiagonal() * (columns.transpose() * columns) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(gram);
  std::vector<bool> copied(static_cast<std::size_t>(columns.cols()), false);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    for (Eigen::Index i = 0; directions.eigenvalues()[k] < kNothing && i < columns.cols(); ++i) {
      copied[static_cast<std::size_t>(i)] =
          copied[static_cast<std::size_t>(i)] || std::abs(directions.eigenvectors()(i, k)) > kPart;
    }
  }
  return copied;
}

}  // namespace

auto undetermined_coefficients(const LinearFit& fit, const LawForm& form, const Eigen::MatrixXd& columns,
                               const Eigen::VectorXd& target) -> std::vector<std::string> {
  const std::vector<bool> copied = copied_columns(columns);
  const double motion = target.maxCoeff() - target.minCoeff();
  const auto names = column_names(form);
  const auto at_offset = [&names](Eigen::Index i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    return is_offset(name.substr(0, name.find('.')));
  };
  // Where angles are counted from says nothing: beside an offset a column counts about its mean, and the offset where
  // the others are at theirs.
  const bool about_means = std::any_of(form.terms.begin(), form.terms.end(), is_offset);
  const Eigen::VectorXd means = columns.colwise().mean();
  const auto half_width_of = [&](Eigen::Index i) {
    return at_offset(i) ? half_interval_of_sum(fit, means) : half_interval(fit, i);
  };
  const auto size_of = [&](Eigen::Index i) {
    return about_means && !at_offset(i) ? rms_about_mean(columns.col(i)) : rms(columns.col(i));
  };
  std::vector<std::string> undetermined;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const double size = size_of(i);
    if (form.tied_compliance && size <= 0.0 && names[static_cast<std::size_t>(i)].starts_with(kTendonModel)) {
      continue;  // it goes with beta
    }
    // An interval within which this term alone could make half of all motion says nothing.
    const bool loose = half_width_of(i) * size > 0.5 * motion;
    if (size <= 0.0 || copied[static_cast<std::size_t>(i)] || loose) {
      undetermined.push_back(names[static_cast<std::size_t>(i)]);
    }
  }
  return undetermined;
}

namespace {

/// Tendons that are known, those of another time of the joint, settle from where they are: what these logs do not tell
/// apart then stays as it was. Others are looked for.
auto with_best_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const LawForm& start)
    -> LawForm {
  if (!start.has(kTendonModel)) {
    return search_shapes(design, target, rows, start);
  }
  const CatalogueTerm& tendon = start.catalogue->term(kTendonModel);
  const bool known = start.shapes_of(tendon) != tendon.initial_shapes();
  return known ? refine_tendon(design, target, rows, start) : fit_tendon(design, target, rows, start);
}

}  // namespace

auto identify(const std::vector<AxisLog>& logs, const LawForm& start) -> Identification {
  Identification result;
  auto conditioner = choose_conditioner(logs, start, result.notes);
  const LawDesign first_design = design_for(logs, start, conditioner);
  const Eigen::VectorXd target = first_design.smoothed(stacked_target(logs));
  const Blocks halves = even_blocks(first_design.log_rows(), 2);
  conditioner = choose_rate_filter(logs, target, halves, start, conditioner);
  LawDesign design = design_for(logs, start, conditioner);
  LawForm form = with_best_shapes(design, target, halves, start);
  if (form.has(kTendonModel)) {
    const double tried = conditioner.rate_time_constant_s;
    conditioner = choose_tendon_filter(logs, target, halves, form, conditioner);
    if (conditioner.rate_time_constant_s != tried) {
      design = design_for(logs, form, conditioner);
      form = refine_tendon(design, target, halves, std::move(form));
    }
  }
  const LawDesign known = of_known_direction(logs, design, form, conditioner);
  const Eigen::VectorXd taught = known.lined(target);
  const Eigen::MatrixXd columns = law_columns(known, form);
  const auto signs = law_signs(form);
  const LinearFit first = fit_columns(columns, taught, halves, signs);
  const Blocks blocks = interval_blocks(pieces_of(design.log_rows()), taught - columns * first.theta);
  const LinearFit fit = fit_columns(columns, taught, blocks, signs);
  note_bounds(fit, form, logs.front(), result.notes);
  result.undetermined = undetermined_coefficients(fit, form, columns, taught);
  result.joint = law_with_intervals(known, taught, blocks, form, conditioner);
  if (form.catalogue->target() == TargetKind::kEffort) {
    result.notes.push_back(averaging_note(design));
  }
  result.estimate = estimates(logs, design, result.joint);
  const auto notes = describe_logs(logs, design, target, result.estimate, result.joint);
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  return result;
}

}  // namespace capstan::tools
