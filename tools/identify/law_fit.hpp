// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/identify/shape_range.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

struct LawForm;

/// Logs of one joint, conditioned once: fits and evaluates laws over all of them, one below the other.
/// Every regressor comes from the terms of the model themselves.
class LawDesign {
 public:
  LawDesign(const std::vector<AxisLog>& logs, const ConditionerShape<double>& conditioner);
  /// With samples prepared by the caller, for decisions that may look at the future. `smoothing` is the half width in
  /// samples of the mean that is taken twice over every column of a term; the target needs the same.
  LawDesign(const std::vector<AxisLog>& logs, std::vector<Samples> samples, Eigen::Index smoothing = 0);

  /// With samples that are no log's, as means over several: the period of each series, s.
  LawDesign(std::vector<Samples> samples, std::vector<double> periods_s);

  [[nodiscard]] auto rows() const -> Eigen::Index { return rows_; }
  [[nodiscard]] auto log_rows() const -> const std::vector<Eigen::Index>& { return log_rows_; }
  [[nodiscard]] auto samples() const -> const std::vector<Samples>& { return samples_; }
  [[nodiscard]] auto smoothing() const -> Eigen::Index { return smoothing_; }
  [[nodiscard]] auto reach() const -> const SignalReach& { return reach_; }
  /// Signals over all logs averaged as the columns are.
  [[nodiscard]] auto smoothed(const Eigen::MatrixXd& signals) const -> Eigen::MatrixXd;
  [[nodiscard]] auto period_s(std::size_t log) const -> double { return periods_[log]; }

  /// The same with other samples of its rows.
  [[nodiscard]] auto with(std::vector<Samples> samples) const -> LawDesign;
  /// The same, its laws compared with straight lines through these rows, which say nothing of them. The target needs
  /// the same lines. @param rows  in order, of all logs one below the other
  [[nodiscard]] auto with_lines(Blocks rows) const -> LawDesign;
  /// Signals over all logs with those lines.
  [[nodiscard]] auto lined(Eigen::MatrixXd signals) const -> Eigen::MatrixXd;
  /// The same samples as what stands behind the law's input terms sees them.
  [[nodiscard]] auto behind(const LawForm& form) const -> LawDesign;

  /// One column per coefficient of a sum term, over all logs, by these samples.
  [[nodiscard]] auto columns(const CatalogueTerm& term, const Shapes& shapes) const -> Eigen::MatrixXd;
  /// Signals over all logs passed through an output term, column by column.
  [[nodiscard]] auto apply(const CatalogueTerm& term, const Shapes& shapes, const Eigen::MatrixXd& signals) const
      -> Eigen::MatrixXd;

 private:
  std::vector<Samples> samples_;
  SignalReach reach_;
  std::vector<double> periods_;
  std::vector<Eigen::Index> log_rows_;
  Eigen::Index rows_ = 0;
  Eigen::Index smoothing_ = 0;
  Blocks lines_;
  double rate_time_constant_s_ = ConditionerShape<double>{}.rate_time_constant_s;
};

/// The targets of all logs, one below the other. @pre every log has one
auto stacked_target(const std::vector<AxisLog>& logs) -> Eigen::VectorXd;

/// A law to be fitted: its terms (names of its catalogue) and a full set of shapes, of which those of the terms count.
struct LawForm {
  const Catalogue* catalogue = &term_catalogue();
  std::vector<std::string> terms;
  Shapes shapes = catalogue->initial_shapes();
  std::vector<std::string> held = {};  ///< terms, and single shapes as TERM.SHAPE, that no fit moves
  /// Tendons' compliance over beta, rad/Nm, where no fit moves that either: their column goes with the motor angle's.
  std::optional<double> tied_compliance = {};

  [[nodiscard]] auto shapes_of(const CatalogueTerm& term) const -> Shapes;
  void set_shapes(const CatalogueTerm& term, const Shapes& shapes);
  [[nodiscard]] auto has(const std::string& term) const -> bool;
};

/// The law of a joint file, to be fitted anew from where it is.
auto form_of(const JointFile& joint) -> LawForm;

/// The same with its tendons as they are, stiffness and all: what such a law leaves of a log is what has changed.
auto base_of(const JointFile& joint) -> LawForm;

/// Terms of the form in the order of the catalogue.
auto ordered_terms(const LawForm& form) -> std::vector<const CatalogueTerm*>;

/// Columns of the law's coefficients, output terms applied, in the order of the catalogue.
auto law_columns(const LawDesign& design, const LawForm& form) -> Eigen::MatrixXd;
auto law_signs(const LawForm& form) -> std::vector<Sign>;

/// Least squares for the coefficients, the shapes given.
auto fit_law(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, const LawForm& form)
    -> LinearFit;

/// The shapes that fit best within what the logs can tell (range_of), of those around where they are.
auto refine_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, LawForm form)
    -> LawForm;

/// The shapes that fit best within what the logs can tell, wherever they were: from starts on a Latin hypercube, the
/// best few of them refined.
auto search_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, const LawForm& form)
    -> LawForm;

/// A shape of a law, and the term that it belongs to.
struct TermShape {
  const CatalogueTerm* term;
  std::size_t own;  ///< place among the term's shapes

  [[nodiscard]] auto info() const -> const ShapeInfo& { return term->shapes[own]; }
  /// Place among the shapes of all terms.
  [[nodiscard]] auto index() const -> std::size_t { return term->first_shape + own; }
};

/// The shapes of a law that a fit searches for, in the order of its terms: none that is given, none that does nothing.
auto searched_shapes(const LawForm& form) -> std::vector<TermShape>;
/// Step for the derivative of a fit with respect to a shape, inside the shape's limits.
auto shape_step(const ShapeInfo& info, double value) -> double;

/// A shape that ended at a limit of what the logs can tell is not identified: names of those.
auto shapes_at_limits(const LawDesign& design, const LawForm& form) -> std::vector<std::string>;

/// How the law's angle or effort changes with each of these shapes of it, the coefficients held: a column per shape.
auto sensitivities(const LawDesign& design, const LawForm& form, const Eigen::VectorXd& theta,
                   const std::vector<TermShape>& shapes) -> Eigen::MatrixXd;
/// The law's columns, then its sensitivities to the shapes that are searched for.
auto with_sensitivities(const LawDesign& design, const LawForm& form, const Eigen::VectorXd& theta,
                        const Eigen::MatrixXd& columns) -> Eigen::MatrixXd;

/// The fitted law with 95 % intervals; those of shapes come from the fit's sensitivity to them.
auto law_with_intervals(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks,
                        const LawForm& form, const ConditionerShape<double>& conditioner) -> JointFile;

/// What a joint sensor would report under the law, over all logs: MotionLaw<double> itself, causal, free-running.
auto simulate(const std::vector<AxisLog>& logs, const LawParameters<double>& law) -> Eigen::VectorXd;

/// What a law of either family gives over the logs of the design: MotionLaw<double>, or the sum of the effort's terms,
/// whose motion is given.
auto estimates(const std::vector<AxisLog>& logs, const LawDesign& design, const JointFile& joint) -> Eigen::VectorXd;
/// What a law leaves of logs as it runs, one below the other; of a law without terms nothing is known, so 0.
auto left_by(const JointFile& law, const std::vector<AxisLog>& logs) -> Eigen::VectorXd;

}  // namespace capstan::tools
