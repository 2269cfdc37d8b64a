// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_law.hpp"

#include <algorithm>
#include <set>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/select/effort_frames.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Laws after each step, and what their numbers come from.
struct Grown {
  PartProducts products;
  std::vector<ScoredLaw<PartLaw>> path;

  [[nodiscard]] auto score() const -> double { return path.back().score; }
};

auto parts_of(const Frame& frame, AxisKind axis) -> std::vector<LawPart> {
  const MotionRanges ranges = motion_ranges(frame.design);
  return frame.law.of_gear() ? gear_parts(ranges) : effort_parts(ranges, frame.design.others(), axis);
}

/// Everything that a choice needs.
struct Choice {
  const std::vector<AxisLog>& logs;
  Frame frame;
  Eigen::VectorXd target;  ///< as logged
  PartColumns columns;
  std::size_t base;  ///< so many of them are the base law's

  Choice(const std::vector<AxisLog>& from, Frame seen, bool bare)
      : logs(from),
        frame(std::move(seen)),
        target(stacked_target(from)),
        columns(frame.design, target, *frame.law.joint.catalogue, parts_of(frame, axis_kind(from))),
        base(frame.law.of_gear() ? kGearBaseParts : (bare ? 1 : kRigidParts)) {}

  /// The whole base law, and with a weight or a spring. In a sine either pushes as inertia does: one without the other
  /// brings nothing, and what grows from the base law alone lets go of both.
  [[nodiscard]] auto starts() const -> std::vector<PartLaw> {
    PartLaw all_of_base;
    for (std::size_t part = 0; part < base; ++part) {
      all_of_base.push_back({part, 0});
    }
    std::vector<PartLaw> starts = {all_of_base};
    for (const char* load : {"gravity", "spring"}) {
      const auto part = std::find_if(columns.parts.begin(), columns.parts.end(),
                                     [&](const LawPart& one) { return one.term == load; });
      if (part != columns.parts.end()) {
        starts.push_back(all_of_base);
        starts.back().push_back({static_cast<std::size_t>(part - columns.parts.begin()), 0});
      }
    }
    return starts;
  }

  /// On the first rows, by their share.
  [[nodiscard]] auto grown(double share) const -> Grown {
    PartProducts products(columns, share);
    PartLaws laws(products, kEffortNumbers);
    Grower grower(laws, kEffortNumbers.growth);
    std::vector<ScoredLaw<PartLaw>> path;
    for (const auto& start : starts()) {
      auto other = grower.run(start);
      if (path.empty()) {
        path = std::move(other);
      } else if (other.back().score < kEffortNumbers.growth.worth_a_step * path.back().score) {
        other.insert(other.begin(), path.front());  // what is called the base law stays without a load
        path = std::move(other);
      }
    }
    return {std::move(products), std::move(path)};
  }
};

/// The law's effort.
auto sum_of_terms(const EffortDesign& design, const JointFile& joint) -> Eigen::VectorXd {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(design.rows());
  for (const auto& term : *joint.catalogue) {  // output terms come last
    if (!joint.has(term.name)) {
      continue;
    }
    const auto first = joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape);
    const Shapes shapes(first, first + static_cast<std::ptrdiff_t>(term.shapes.size()));
    if (term.acts_on_output) {
      sum = design.passed_through(term, shapes, sum);
      continue;
    }
    const Eigen::MatrixXd columns = design.columns(term, shapes);
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      sum += joint.parameters.coefficients[term.first_coefficient + static_cast<std::size_t>(i)] * columns.col(i);
    }
  }
  return sum;
}

/// Puts a part's numbers into the law, and the columns beside them; says where its coefficients are.
void place_part(const Choice& choice, const ChosenPart& chosen, const Eigen::VectorXd& theta, JointFile& joint,
                Eigen::MatrixXd& columns, std::vector<std::size_t>& places) {
  const LawPart& part = choice.columns.parts[chosen.part];
  const CatalogueTerm& term = joint.catalogue->term(part.term);
  const Shapes& shapes = part.settings[chosen.setting];
  const Eigen::MatrixXd own = choice.frame.design.columns(term, shapes);
  std::copy(shapes.begin(), shapes.end(),
            joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape));
  for (const std::size_t coefficient : part.coefficients) {
    const auto next = static_cast<Eigen::Index>(places.size());
    columns.col(next) = own.col(static_cast<Eigen::Index>(coefficient));
    places.push_back(term.first_coefficient + coefficient);
    joint.parameters.coefficients[places.back()] = theta[next];
  }
}

/// The law in numbers, with intervals from blocks of all rows.
auto in_numbers(const Choice& choice, const PartProducts& products, const PartLaw& chosen_parts) -> EffortLaw {
  EffortLaw law = choice.frame.law;
  JointFile& joint = law.joint;
  const Eigen::VectorXd theta = products.coefficients(chosen_parts, kEffortNumbers.ridge);
  Eigen::MatrixXd columns(choice.frame.design.rows(), theta.size());
  std::vector<std::size_t> places;
  std::set<std::string> terms;
  for (const auto& chosen : chosen_parts) {
    place_part(choice, chosen, theta, joint, columns, places);
    terms.insert(choice.columns.parts[chosen.part].term);
  }
  for (const auto& term : *joint.catalogue) {
    if (terms.count(term.name) > 0) {
      joint.terms.push_back(term.name);
    }
  }
  const Eigen::VectorXd target = choice.frame.design.seen(choice.target);
  const Eigen::VectorXd residual = target - columns * theta;
  const LinearFit fit = fit_columns(columns, target, interval_blocks({{0, target.size()}}, residual),
                                    std::vector<Sign>(places.size(), Sign::kAny));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double half = half_interval(fit, static_cast<Eigen::Index>(i));
    const double value = theta[static_cast<Eigen::Index>(i)];
    joint.coefficient_ci95[places[i]] = Interval{value - half, value + half};
  }
  FitSummary summary;
  summary.rmse = rms(residual);
  summary.gof_percent = goodness_of_fit_percent(target, target - residual);
  summary.samples = target.size();
  for (const auto& log : choice.logs) {
    summary.logs.push_back(log.name);
  }
  joint.fit = summary;
  return law;
}

/// The window through which a law that is given errs least against what was logged. Fast motion asks for a short one, a
/// coarse encoder for a long one. @param design  of the law's own view
auto best_window(const std::vector<AxisLog>& logs, const EffortLaw& law, const EffortDesign& design) -> double {
  const Eigen::VectorXd target = stacked_target(logs);
  double best = law.view.window_s;
  double lowest = rms(target - sum_of_terms(design, law.joint));
  for (const double share : {0.5, 0.25, 0.125}) {
    EffortView view = law.view;
    view.window_s = share * law.view.window_s;
    const double error = rms(target - sum_of_terms(EffortDesign(logs, view), law.joint));
    if (error < lowest) {
      lowest = error;
      best = view.window_s;
    }
  }
  return best;
}

/// What is new in a law: effects of its parts, in the order they came, whose terms its base does not hold.
auto new_effects(const std::vector<LawPart>& parts, const PartLaw& law, const EffortLaw& base)
    -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& chosen : law) {
    const std::string& term = parts[chosen.part].term;
    const std::string name = effect_name(term);
    if (!base.joint.has(term) && std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace

auto can_select_effort_law(const std::vector<AxisLog>& logs) -> bool {
  constexpr Eigen::Index kFewestRows = 240;  // twenty a block of time
  Eigen::Index rows = 0;
  bool moves = false;
  bool changes = false;
  for (const auto& log : logs) {
    rows += log.samples();
    moves = moves || log.q1_rad.maxCoeff() > log.q1_rad.minCoeff();
    changes = changes || log.effort.maxCoeff() > log.effort.minCoeff();
    if (log.samples() < kFewestRows / 12) {
      return false;  // of a log that a window hardly fits into
    }
  }
  return rows >= kFewestRows && moves && changes;
}

auto select_effort_law(const std::vector<AxisLog>& logs, bool bare) -> EffortSelection {
  constexpr double kLearned = 0.8;
  std::vector<Choice> choices;
  for (auto& frame : frames_for(logs)) {
    choices.emplace_back(logs, std::move(frame), bare);
  }
  std::vector<Grown> learned;
  for (const auto& each : choices) {
    learned.push_back(each.grown(kLearned));
  }
  const bool other =
      choices.size() > 1 && learned.back().score() < kEffortNumbers.worth_another_rest * learned.front().score();
  const Choice& choice = other ? choices.back() : choices.front();
  const EffortDesign& design = choice.frame.design;
  PartLaw start = {{0, 0}};
  if (choice.frame.law.of_gear() || !bare) {
    start.push_back({1, 0});
  }
  EffortSelection result;
  const auto take = [&](const Grown& grown) {
    const auto& [products, path] = grown;
    result.start = in_numbers(choice, products, start);
    result.base = in_numbers(choice, products, path.front().law);
    result.law = in_numbers(choice, products, path.back().law);
    result.effects = new_effects(choice.columns.parts, path.back().law, result.base);
  };
  take(other ? learned.back() : learned.front());
  result.measured = design.seen(choice.target);
  result.by_start = sum_of_terms(design, result.start.joint);
  result.by_law = sum_of_terms(design, result.law.joint);
  result.first_unseen = static_cast<Eigen::Index>(kLearned * static_cast<double>(result.measured.size()));
  const Eigen::Index unseen = result.measured.size() - result.first_unseen;
  result.before = rms((result.measured - sum_of_terms(design, result.base.joint)).tail(unseen));
  result.after = rms((result.measured - result.by_law).tail(unseen));
  result.target_rms = rms(result.measured.tail(unseen));
  take(choice.grown(1.0));
  set_status(result.effects.empty() ? LawStatus::kBase : LawStatus::kProvisional, result.law);
  set_status(LawStatus::kBase, result.base);
  set_status(LawStatus::kBase, result.start);
  return result;
}

void set_status(LawStatus status, EffortLaw& law) {
  law.joint.status = status;
  law.status = word_of(status);
}

auto runnable_law(const JointFile& law, const std::vector<AxisLog>& logs) -> EffortLaw {
  JointFile joint(catalogue_for(logs));
  for (const auto& term : *joint.catalogue) {
    if (!law.has(term.name)) {
      continue;
    }
    joint.terms.push_back(term.name);
    const CatalogueTerm& from = law.catalogue->term(term.name);
    for (std::size_t i = 0; i < from.coefficients.size(); ++i) {  // it may hold more than was asked of
      joint.parameters.coefficients[term.first_coefficient + i] =
          law.parameters.coefficients[from.first_coefficient + i];
      joint.coefficient_ci95[term.first_coefficient + i] = law.coefficient_ci95[from.first_coefficient + i];
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      joint.parameters.shapes[term.first_shape + i] = law.parameters.shapes[from.first_shape + i];
    }
  }
  joint.fit = law.fit;
  const Eigen::VectorXd target = stacked_target(logs);
  std::vector<Frame> frames = frames_by(
      logs, [&](const Frame& frame) { return rms(frame.design.seen(target) - sum_of_terms(frame.design, joint)); });
  auto& [runnable, design] = frames.back();
  runnable.joint = joint;
  set_status(law.status, runnable);
  runnable.view.window_s = best_window(logs, runnable, design);
  return runnable;
}

auto run_effort_law(const std::vector<AxisLog>& logs, const EffortLaw& law) -> Eigen::VectorXd {
  const EffortDesign design(logs, law.view);
  return sum_of_terms(design, law.joint);
}

}  // namespace capstan::tools
