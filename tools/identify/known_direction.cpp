// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/known_direction.hpp"

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/identify/noncausal_samples.hpp"

namespace capstan::tools {
namespace {

/// Squares that the law leaves as the board runs it, taught by the rows of a design.
/// @param columns, target  as the board sees them
auto running_error(const LawDesign& taught_by, const LawForm& form, const Eigen::MatrixXd& columns,
                   const Eigen::VectorXd& target) -> double {
  const LinearFit fit = fit_columns(taught_by.lined(columns), taught_by.lined(target),
                                    even_blocks(taught_by.log_rows(), 2), law_signs(form));
  return (target - columns * fit.theta).squaredNorm();
}

auto in_doubt(const std::vector<AxisLog>& logs, const LawDesign& running, const ConditionerShape<double>& conditioner)
    -> Blocks {
  const AngleNoise noise = motor_angle_noise(logs);
  Blocks rows;
  Eigen::Index begin = 0;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (const auto& block : doubtful_rows(running.samples()[i], noncausal_samples(logs[i], conditioner, noise))) {
      rows.push_back({begin + block.begin, begin + block.end});
    }
    begin += logs[i].samples();
  }
  return rows;
}

}  // namespace

auto of_known_direction(const std::vector<AxisLog>& logs, const LawDesign& running, const LawForm& form,
                        const ConditionerShape<double>& conditioner) -> LawDesign {
  constexpr double kMostRows = 0.3;  // in doubt; beyond, the rest says too little by itself
  if (form.catalogue->target() != TargetKind::kAngle || !form.has("tendon_elongation")) {
    return running;
  }
  const Blocks rows = in_doubt(logs, running, conditioner);
  const double share = static_cast<double>(rows_in(rows)) / static_cast<double>(running.rows());
  if (share >= kMostRows) {
    return running;
  }
  LawDesign known = running.with_lines(rows);
  // A jump J that is late in a share f of the rows costs f J^2 where it is known. A fit to these rows too makes it
  // smaller by f, and errs by f (1 - f) J^2. Who loses more than that has lost what these rows alone tell: a term that
  // acts behind a turn, as slip_propagation, against elongation.
  const Eigen::VectorXd target = running.smoothed(stacked_target(logs));
  const Eigen::MatrixXd columns = law_columns(running, form);
  const bool only_late =
      running_error(known, form, columns, target) * (1.0 - share) <= running_error(running, form, columns, target);
  return only_late ? known : running;
}

}  // namespace capstan::tools
