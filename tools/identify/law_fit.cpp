// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/law_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/identify/torque_noise.hpp"
#include "capstan/tools/support/side_by_side.hpp"

namespace capstan::tools {
namespace {

auto all_causal_samples(const std::vector<AxisLog>& logs, const ConditionerShape<double>& conditioner)
    -> std::vector<Samples> {
  std::vector<Samples> samples;
  for (const auto& log : logs) {
    samples.push_back(causal_samples(log, conditioner));
  }
  return samples;
}

constexpr const char* kMotorAngle = "motor_angle";

/// Columns of a form whose compliance is tied.
struct Tie {
  Eigen::Index motor = -1;
  Eigen::Index tendon = -1;
};

auto tie_of(const LawForm& form) -> std::optional<Tie> {
  if (!form.tied_compliance || !form.has(kTendonModel) || !form.has(kMotorAngle)) {
    return std::nullopt;
  }
  Tie tie;
  Eigen::Index next = 0;
  for (const auto* term : ordered_terms(form)) {
    if (term->name == kTendonModel) {
      tie.tendon = next;
    } else if (term->name == kMotorAngle) {
      tie.motor = next;
    }
    next += static_cast<Eigen::Index>(term->coefficients.size());
  }
  return tie;
}

/// Coefficients as the law has them, of those of its columns: a tied compliance from beta.
auto untied(const LawForm& form, Eigen::VectorXd theta) -> Eigen::VectorXd {
  if (const auto tie = tie_of(form)) {
    theta[tie->tendon] += *form.tied_compliance * theta[tie->motor];
  }
  return theta;
}

}  // namespace

LawDesign::LawDesign(const std::vector<AxisLog>& logs, const ConditionerShape<double>& conditioner)
    : LawDesign(logs, all_causal_samples(logs, conditioner)) {
  rate_time_constant_s_ = conditioner.rate_time_constant_s;
}

LawDesign::LawDesign(const std::vector<AxisLog>& logs, std::vector<Samples> samples, Eigen::Index smoothing)
    : samples_(std::move(samples)), smoothing_(smoothing) {
  for (const auto& log : logs) {
    periods_.push_back(log.period_s);
    log_rows_.push_back(log.samples());
    rows_ += log.samples();
  }
  reach_ = reach_of(samples_, periods_);
}

LawDesign::LawDesign(std::vector<Samples> samples, std::vector<double> periods_s)
    : samples_(std::move(samples)), periods_(std::move(periods_s)) {
  reach_ = reach_of(samples_, periods_);
  for (const auto& one : samples_) {
    log_rows_.push_back(static_cast<Eigen::Index>(one.size()));
    rows_ += log_rows_.back();
  }
}

auto LawDesign::with(std::vector<Samples> samples) const -> LawDesign {
  LawDesign result = *this;
  result.samples_ = std::move(samples);
  return result;
}

auto LawDesign::with_lines(Blocks rows) const -> LawDesign {
  LawDesign result = *this;
  result.lines_ = std::move(rows);
  return result;
}

auto LawDesign::lined(Eigen::MatrixXd signals) const -> Eigen::MatrixXd {
  const Blocks logs = pieces_of(log_rows_);
  auto log = logs.begin();
  for (const auto& [begin, end] : lines_) {
    while (log->end < end) {
      ++log;
    }
    const Eigen::Index before = begin > log->begin ? begin - 1 : std::min(end, log->end - 1);  // flat at a log's end
    const Eigen::Index after = end < log->end ? end : before;
    for (Eigen::Index row = begin; row < end; ++row) {
      const double share =
          after > before ? static_cast<double>(row - before) / static_cast<double>(after - before) : 0.0;
      signals.row(row) = (1.0 - share) * signals.row(before) + share * signals.row(after);
    }
  }
  return signals;
}

auto LawDesign::behind(const LawForm& form) const -> LawDesign {
  LawDesign result = *this;
  for (const auto* term : ordered_terms(form)) {
    for (std::size_t i = 0; term->acts_on_input && i < samples_.size(); ++i) {
      result.samples_[i] = term->input(result.samples_[i], periods_[i], rate_time_constant_s_, form.shapes_of(*term));
    }
  }
  return result;
}

auto LawDesign::columns(const CatalogueTerm& term, const Shapes& shapes) const -> Eigen::MatrixXd {
  if (samples_.size() == 1 && smoothing_ == 0) {
    return term.columns(samples_.front(), periods_.front(), shapes);
  }
  Eigen::MatrixXd result(rows_, static_cast<Eigen::Index>(term.coefficients.size()));
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    result.middleRows(row, log_rows_[i]) = term.columns(samples_[i], periods_[i], shapes);
    row += log_rows_[i];
  }
  return smoothed(result);
}

auto LawDesign::smoothed(const Eigen::MatrixXd& signals) const -> Eigen::MatrixXd {
  return moving_mean(moving_mean(signals, log_rows_, smoothing_), log_rows_, smoothing_);
}

auto LawDesign::apply(const CatalogueTerm& term, const Shapes& shapes, const Eigen::MatrixXd& signals) const
    -> Eigen::MatrixXd {
  Eigen::MatrixXd result(signals.rows(), signals.cols());
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    for (Eigen::Index c = 0; c < signals.cols(); ++c) {
      result.col(c).segment(row, log_rows_[i]) =
          term.apply(signals.col(c).segment(row, log_rows_[i]), periods_[i], shapes);
    }
    row += log_rows_[i];
  }
  return result;
}

auto stacked_target(const std::vector<AxisLog>& logs) -> Eigen::VectorXd {
  Eigen::VectorXd target(total_samples(logs));
  Eigen::Index rows = 0;
  for (const auto& log : logs) {
    target.segment(rows, log.samples()) = log.measured();
    rows += log.samples();
  }
  return target;
}

auto LawForm::shapes_of(const CatalogueTerm& term) const -> Shapes {
  const auto first = shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape);
  return {first, first + static_cast<std::ptrdiff_t>(term.shapes.size())};
}

void LawForm::set_shapes(const CatalogueTerm& term, const Shapes& values) {
  std::copy(values.begin(), values.end(), shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape));
}

auto LawForm::has(const std::string& term) const -> bool {
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

auto form_of(const JointFile& joint) -> LawForm {
  return {joint.catalogue, joint.terms, joint.parameters.shapes};
}

auto base_of(const JointFile& joint) -> LawForm {
  LawForm form = form_of(joint);
  if (joint.has(kTendonModel) && joint.has(kMotorAngle)) {
    const auto coefficient = [&](const char* term) {
      return joint.parameters.coefficients[joint.catalogue->term(term).first_coefficient];
    };
    form.tied_compliance = coefficient(kTendonModel) / coefficient(kMotorAngle);
  }
  return form;
}

auto ordered_terms(const LawForm& form) -> std::vector<const CatalogueTerm*> {
  std::vector<const CatalogueTerm*> terms;
  for (const auto& term : *form.catalogue) {
    if (form.has(term.name)) {
      terms.push_back(&term);
    }
  }
  return terms;
}

auto law_columns(const LawDesign& design, const LawForm& form) -> Eigen::MatrixXd {
  const auto terms = ordered_terms(form);
  Eigen::Index count = 0;
  std::optional<LawDesign> behind;
  for (const auto* term : terms) {
    count += static_cast<Eigen::Index>(term->coefficients.size());
    if (term->acts_on_input && !behind) {
      behind = design.behind(form);
    }
  }
  Eigen::MatrixXd columns(design.rows(), count);
  Eigen::Index next = 0;
  const auto tie = tie_of(form);
  for (const auto* term : terms) {
    if (term->acts_on_output) {
      columns = design.apply(*term, form.shapes_of(*term), columns);
    } else if (!term->acts_on_input) {
      const auto own = static_cast<Eigen::Index>(term->coefficients.size());
      const LawDesign& seen = behind && term->reads_input ? *behind : design;
      columns.middleCols(next, own) = seen.columns(*term, form.shapes_of(*term));
      next += own;
      if (tie && next == tie->tendon + 1) {
        columns.col(tie->motor) += *form.tied_compliance * columns.col(tie->tendon);
        columns.col(tie->tendon).setZero();
      }
    }
  }
  return design.lined(std::move(columns));
}

auto law_signs(const LawForm& form) -> std::vector<Sign> {
  std::vector<Sign> signs;
  for (const auto* term : ordered_terms(form)) {
    for (const auto& coefficient : term->coefficients) {
      signs.push_back(coefficient.sign);
    }
  }
  return signs;
}

auto fit_law(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, const LawForm& form)
    -> LinearFit {
  return fit_columns(law_columns(design, form), target, blocks, law_signs(form));
}

namespace {

/// The part of a law that moves with a shape of one of its terms.
struct MovingPart {
  LawForm law;
  Eigen::VectorXd weights;  ///< coefficients of the part's columns
};

/// The term alone, with what the law's output passes through. Terms at input or output move all of the law.
auto part_that_moves(const LawForm& form, const CatalogueTerm& term, const Eigen::VectorXd& all) -> MovingPart {
  MovingPart part{form, all};
  part.law.tied_compliance.reset();
  if (term.acts_on_output || term.acts_on_input) {
    return part;
  }
  std::erase_if(part.law.terms, [&](const auto& name) {
    const auto& other = form.catalogue->term(name);
    return name != term.name && !other.acts_on_output && !(other.acts_on_input && term.reads_input);
  });
  Eigen::Index first = 0;
  for (const auto* other : ordered_terms(form)) {
    if (other == &term) {
      break;
    }
    first += static_cast<Eigen::Index>(other->coefficients.size());
  }
  part.weights = all.segment(first, static_cast<Eigen::Index>(term.coefficients.size()));
  return part;
}

/// How the part's angle or effort changes with the shape, by a difference to either side.
auto change_of(const LawDesign& design, MovingPart part, const TermShape& shape) -> Eigen::VectorXd {
  double& value = part.law.shapes[shape.index()];
  const double middle = value;
  const double step = shape_step(shape.info(), middle);
  const auto at = [&](double place) -> Eigen::VectorXd {
    value = place;
    return law_columns(design, part.law) * part.weights;
  };
  const double below = std::max(shape.info().minimum, middle - step);
  return (at(middle + step) - at(below)) / (middle + step - below);
}

}  // namespace

auto sensitivities(const LawDesign& design, const LawForm& form, const Eigen::VectorXd& theta,
                   const std::vector<TermShape>& shapes) -> Eigen::MatrixXd {
  const Eigen::VectorXd all = untied(form, theta);
  Eigen::MatrixXd changes(design.rows(), static_cast<Eigen::Index>(shapes.size()));
  two_at_a_time(shapes.size(), [&](std::size_t i) {
    changes.col(static_cast<Eigen::Index>(i)) =
        change_of(design, part_that_moves(form, *shapes[i].term, all), shapes[i]);
  });
  return changes;
}

auto with_sensitivities(const LawDesign& design, const LawForm& form, const Eigen::VectorXd& theta,
                        const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
  const Eigen::MatrixXd changes = sensitivities(design, form, theta, searched_shapes(form));
  Eigen::MatrixXd result(columns.rows(), columns.cols() + changes.cols());
  result << columns, changes;
  return result;
}

auto law_with_intervals(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks,
                        const LawForm& form, const ConditionerShape<double>& conditioner) -> JointFile {
  const Eigen::MatrixXd columns = law_columns(design, form);
  auto signs = law_signs(form);
  const LinearFit plain = fit_columns(columns, target, blocks, signs);
  const Eigen::Index linear = columns.cols();
  // Shapes enter the covariance by their sensitivities, as columns whose coefficient is the correction still due
  // (none).
  Eigen::MatrixXd all = with_sensitivities(design, form, plain.theta, columns);
  signs.resize(static_cast<std::size_t>(all.cols()), Sign::kAny);
  // A setting that these logs can not tell from its neighbours, with other coefficients, has no interval.
  constexpr double kAlike = 1e-9;
  for (Eigen::Index shape = linear; shape < all.cols(); ++shape) {
    if (fit_columns(all, target, blocks, signs).tolerance[shape] < kAlike) {
      all.col(shape).setZero();
    }
  }
  const LinearFit full = fit_columns(all, target, blocks, signs);
  const FittedIntervals intervals(design, form, all, blocks, full);
  const Eigen::VectorXd theta = untied(form, plain.theta);
  const auto tie = tie_of(form);
  JointFile joint(*form.catalogue);
  joint.parameters.shapes = form.shapes;
  joint.parameters.conditioner = conditioner;
  Eigen::Index next = 0;
  Eigen::Index shape = linear;
  for (const auto* term : ordered_terms(form)) {
    joint.terms.push_back(term->name);
    for (std::size_t i = 0; i < term->coefficients.size(); ++i, ++next) {
      joint.parameters.coefficients[term->first_coefficient + i] = theta[next];
      const bool given = tie && next == tie->tendon;
      if (!given && !plain.at_bound[static_cast<std::size_t>(next)]) {
        joint.coefficient_ci95[term->first_coefficient + i] = intervals.around(theta[next], next);
      }
    }
  }
  for (const TermShape& searched : searched_shapes(form)) {
    if (full.tolerance[shape] > 0.0) {
      joint.shape_ci95[searched.index()] = intervals.around(form.shapes[searched.index()], shape);
    }
    ++shape;
  }
  return joint;
}

auto simulate(const std::vector<AxisLog>& logs, const LawParameters<double>& law) -> Eigen::VectorXd {
  Eigen::VectorXd estimate(total_samples(logs));
  Eigen::Index rows = 0;
  for (const auto& log : logs) {
    MotionLaw<double> motion(SamplePeriod<double>(log.period_s), law);
    for (const auto& now : measured_series(log)) {
      estimate[rows++] = motion.update(now).q2_reported;
    }
  }
  return estimate;
}

auto estimates(const std::vector<AxisLog>& logs, const LawDesign& design, const JointFile& joint) -> Eigen::VectorXd {
  if (joint.catalogue->target() == TargetKind::kAngle) {
    return simulate(logs, motion_parameters(joint));
  }
  const Eigen::MatrixXd columns = law_columns(design, {joint.catalogue, joint.terms, joint.parameters.shapes});
  Eigen::VectorXd theta(columns.cols());
  Eigen::Index next = 0;
  for (const auto& term : *joint.catalogue) {
    for (std::size_t i = 0; joint.has(term.name) && i < term.coefficients.size(); ++i) {
      theta[next++] = joint.parameters.coefficients[term.first_coefficient + i];
    }
  }
  return columns * theta;
}

auto left_by(const JointFile& law, const std::vector<AxisLog>& logs) -> Eigen::VectorXd {
  const Eigen::VectorXd target = stacked_target(logs);
  if (law.terms.empty()) {
    return Eigen::VectorXd::Zero(target.size());
  }
  return target - estimates(logs, LawDesign(logs, law.parameters.conditioner), law);
}

}  // namespace capstan::tools
