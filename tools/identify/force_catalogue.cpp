// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/force_catalogue.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kPullPush = "pull_push";
constexpr const char* kPreisach = "preisach";
constexpr const char* kForceMotion =
    "slow triangles of torque of several heights, tip locked, each tendon slack in turn";

auto pull_push_columns(const Samples& samples, double /*period_s*/, const Shapes& shapes) -> Eigen::MatrixXd {
  PullPushParameters<double> parameters;
  parameters.eta_top = shapes[0];
  parameters.eta_bottom = shapes[1];
  parameters.pretension_nm = shapes[2];
  PullPush<double> law(parameters);
  Eigen::MatrixXd column(static_cast<Eigen::Index>(samples.size()), 1);
  for (Eigen::Index row = 0; row < column.rows(); ++row) {
    const auto& s = samples[static_cast<std::size_t>(row)];
    column(row, 0) = law.update(s.tau - shapes[4] - (s.forward ? shapes[3] : -shapes[3]), s.forward).force;
  }
  return column;
}

auto torque_of(const Samples& samples) -> Eigen::VectorXd {
  Eigen::VectorXd torque(static_cast<Eigen::Index>(samples.size()));
  for (Eigen::Index row = 0; row < torque.size(); ++row) {
    torque[row] = samples[static_cast<std::size_t>(row)].tau;
  }
  return torque;
}

auto preisach_columns(const Samples& samples, double /*period_s*/, const Shapes& shapes) -> Eigen::MatrixXd {
  return relay_columns(even_levels(shapes[0], shapes[1], kPreisachLevels), torque_of(samples));
}

auto pull_push_term() -> CatalogueTerm {
  CatalogueTerm term;
  term.name = kPullPush;
  term.equation = "r2/r1 times the torque at the output, held through phase I";
  term.source = "(2.16) to (2.21)";
  term.confusable_with = "coulomb_friction where no tendon goes slack";
  term.doubles.emplace_back("coulomb_friction");
  term.exciting_motion = kForceMotion;
  term.coefficients = {{"ratio", "1", Sign::kNonNegative, "output radius over input radius"}};
  term.shapes = {{"eta_top", "1", 0.0, 3.0, 0.5, "friction-bending number of the top tendon"},
                 {"eta_bottom", "1", 0.0, 3.0, 0.5, "of the bottom tendon"},
                 {"pretension", "Nm", 0.0, 8.0, 0.1, "tendon integral times the input radius"},
                 {"friction", "Nm", 0.0, 2.0, 0.0, "of the motor, against its direction"},
                 {"input_offset", "Nm", -2.0, 2.0, 0.0, "of the logged torque"}};
  term.columns = pull_push_columns;
  return term;
}

auto preisach_term() -> CatalogueTerm {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (std::size_t row = 0; row + 1 < kPreisachLevels; ++row) {
      for (std::size_t column = 0; column <= row; ++column) {
        names.push_back("weight_" + std::to_string(row) + "_" + std::to_string(column));
      }
    }
    return names;
  }();
  CatalogueTerm term;
  term.name = kPreisach;
  term.equation = "f- + sum of relays, their weights spread evenly over each cell of the grid";
  term.source = "(4.4), (4.5)";
  term.confusable_with = "coulomb_friction, offset: both are in its span";
  term.doubles = {"coulomb_friction", "offset"};
  term.exciting_motion = "first-order reversals: up to each level of torque in turn, and down to the lowest";
  term.coefficients.push_back({"saturation_low", "Nm", Sign::kAny, "output at the lower end of the grid"});
  for (const auto& name : kNames) {
    term.coefficients.push_back({name.c_str(), "Nm", Sign::kNonNegative, "rise of the output by the cell's relays"});
  }
  term.shapes = {{"input_low", "Nm", -1e3, 1e3, -1.0, "lower end of the grid"},
                 {"input_high", "Nm", -1e3, 1e3, 1.0, "upper end"}};
  term.shapes_are_given = true;
  term.columns = preisach_columns;
  return term;
}

auto opposite(Sign sign) -> Sign {
  return sign == Sign::kAny ? sign : (sign == Sign::kNonNegative ? Sign::kNonPositive : Sign::kNonNegative);
}

/// What an effort may hold, and the creep of a tendon under torque. A motor pays for friction; here the joint goes
/// without what friction takes.
auto with_effects(CatalogueTerm law) -> Catalogue {
  // Of a motor's motion; a gear's own friction with the load stands in gear_law_catalogue().
  constexpr std::array kOfMotors = {"inertia", "power_law_friction", "spring", "load_friction"};
  std::vector<CatalogueTerm> terms = {std::move(law)};
  CatalogueTerm creep = catalogue_term("viscoelastic_creep");
  for (auto& coefficient : creep.coefficients) {
    coefficient.unit = "1";
    coefficient.sign = Sign::kAny;  // torque relaxes or is taken over, by what the tip meets
  }
  creep.special_cases = {"viscous_friction"};  // of a time constant that is short against the motion
  for (const auto& term : effort_catalogue(AxisKind::kRotary)) {
    if (term.acts_on_output && !creep.name.empty()) {
      terms.push_back(std::exchange(creep, {}));
    }
    if (!is_one_of(kOfMotors, term.name)) {
      terms.push_back(term);
      for (auto& coefficient : terms.back().coefficients) {
        coefficient.sign = opposite(coefficient.sign);
      }
    }
  }
  return {TargetKind::kForce, "Nm", "rad", std::move(terms)};
}

}  // namespace

auto is_force_law(const std::string& model) -> bool {
  return is_force_model(model) || model == "blend";
}

auto is_force_model(const std::string& model) -> bool {
  return model == kPullPush || model == kPreisach;
}

auto force_catalogue(const std::string& model) -> const Catalogue& {
  static const Catalogue kByPullPush = with_effects(pull_push_term());
  static const Catalogue kByPreisach = with_effects(preisach_term());
  return model == kPullPush ? kByPullPush : kByPreisach;
}

auto force_form(const std::string& model, const std::vector<AxisLog>& logs) -> LawForm {
  LawForm form;
  form.catalogue = &force_catalogue(model);
  form.terms = {model};
  form.shapes = form.catalogue->initial_shapes();
  const auto& term = form.catalogue->term(model);
  if (model == kPullPush) {
    const PullPushFit fit = fit_pull_push(logs);
    form.set_shapes(term, {fit.law.eta_top, fit.law.eta_bottom, fit.law.pretension_nm, fit.friction_nm, fit.offset_nm});
  } else {
    const auto grid = fit_preisach(logs).table.inputs;
    form.set_shapes(term, {grid.front(), grid[kPreisachLevels - 1]});
  }
  return form;
}

auto pull_push_joint(const PullPushFit& fit) -> JointFile {
  JointFile joint(force_catalogue(kPullPush));
  joint.terms = {kPullPush};
  const CatalogueTerm& term = joint.catalogue->term(kPullPush);
  const auto take = [&](const std::string& name, double& value, std::optional<Interval>& ci95) {
    const auto& [own, unit, best, half] =
        *std::find_if(fit.parameters.begin(), fit.parameters.end(), [&](const auto& one) { return one.name == name; });
    value = best;
    ci95 = Interval{best - half, best + half};
  };
  take("ratio", joint.parameters.coefficients[term.first_coefficient], joint.coefficient_ci95[term.first_coefficient]);
  for (std::size_t i = 0; i < term.shapes.size(); ++i) {
    const std::string name = term.shapes[i].name;
    take(name == "input_offset" ? "offset" : name, joint.parameters.shapes[term.first_shape + i],
         joint.shape_ci95[term.first_shape + i]);
  }
  return joint;
}

auto hidden_by_grid(const LawDesign& design, const LawForm& form, const Eigen::VectorXd& fitted) -> Eigen::VectorXd {
  constexpr std::size_t kHalf = (kPreisachLevels + 1) / 2;
  if (!form.has(kPreisach)) {
    return Eigen::VectorXd::Zero(fitted.size());
  }
  const Shapes ends = form.shapes_of(form.catalogue->term(kPreisach));
  Eigen::MatrixXd coarser(fitted.size(), kHalf * (kHalf - 1) / 2 + 1);
  Eigen::Index row = 0;
  for (const auto& samples : design.samples()) {
    const Eigen::VectorXd torque = torque_of(samples);
    coarser.middleRows(row, torque.size()) = relay_columns(even_levels(ends[0], ends[1], kHalf), torque);
    row += torque.size();
  }
  const Eigen::MatrixXd gram = coarser.transpose() * coarser;
  const Eigen::VectorXd weights = gram.completeOrthogonalDecomposition().solve(coarser.transpose() * fitted);
  constexpr double kGrowth = 1.5;  // of the error from grid to grid, less one: 3 for smooth surfaces, 1 for kinked ones
  return (fitted - coarser * weights) / kGrowth;
}

auto averaged_for_force(const std::string& model, const AxisLog& log) -> AxisLog {
  const Eigen::Index most_rows = model == kPullPush ? 16000 : 4000;  // one column, or one for each cell
  return averaged_over(log, averaging_stretch(log.samples(), most_rows, log.period_s));
}

}  // namespace capstan::tools
