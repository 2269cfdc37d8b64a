// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "capstan/tools/diagnose/candidate.hpp"
#include "capstan/tools/support/geometric_grid.hpp"
#include "capstan/tools/support/side_by_side.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kGridPoints = 22;
constexpr std::size_t kFinePoints = 6;
/// Neighbours on the grid are nearly the same: the best is looked for among all, but only every so many take part in
/// what follows.
constexpr std::size_t kKeptOfGrid = 3;

/// Periods per angle can be told apart as finely as the motion is long: a quarter of a period over the whole range.
auto periods_step(const SignalReach& reach) -> double {
  return 0.5 * std::numbers::pi / reach.q1;
}

/// Less than one period is a smooth curve like any other.
auto fewest_periods(const ShapeInfo& info, const SignalReach& reach) -> double {
  return std::max(info.minimum, 2.0 * std::numbers::pi / reach.q1);
}

auto counts_periods(const CatalogueTerm& term) -> bool {
  return std::any_of(term.shapes.begin(), term.shapes.end(), [](const auto& info) {
    return info.scale == ShapeScale::kPeriods && info.of == ShapeOf::kNothing;
  });
}

/// What the grid of a shape in equal ratios spans. Shares of the log's torque are no wider than the log's: what is over
/// within a small part of it is a step at each reversal. Others that begin at nothing are cut where nothing can be told
/// from nothing.
auto grid_range(const ShapeInfo& info, const SignalReach& reach) -> ShapeRange {
  constexpr double kOfTorque = 1.0 / 25.0;
  constexpr double kOfLimit = 1.0 / 400.0;
  ShapeRange range = range_of(info, reach);
  if (info.of == ShapeOf::kTorqueRange && reach.tau > info.minimum) {
    range.high = std::min(reach.tau, info.maximum);
    range.low = std::max(info.minimum, kOfTorque * range.high);
  } else if (info.of != ShapeOf::kMotorRange && info.of != ShapeOf::kOtherRange) {
    range.low = std::max(range.low, kOfLimit * range.high);
  }
  return range;
}

/// One shape's grid: equal ratios, or equal steps for periods per angle.
auto grid_of(const ShapeInfo& info, std::size_t points, const SignalReach& reach) -> std::vector<double> {
  if (info.scale == ShapeScale::kRatio) {
    const ShapeRange range = grid_range(info, reach);
    return geometric_grid(range.low, range.high, points);
  }
  constexpr std::size_t kMostPeriods = 120;
  std::vector<double> values;
  double order = fewest_periods(info, reach);
  for (; order < info.maximum && values.size() < kMostPeriods; order += periods_step(reach)) {
    values.push_back(order);
  }
  return values;
}

/// Where the motor was, for shapes that are places or shares of its motion.
struct MotionPlace {
  double centre = 0.0, half = 0.0;

  explicit MotionPlace(const Eigen::VectorXd& q1)
      : centre(0.5 * (q1.maxCoeff() + q1.minCoeff())), half(0.5 * (q1.maxCoeff() - q1.minCoeff())) {}
};

/// A place on the way of the motor: where something rests.
auto is_place(const ShapeInfo& info) -> bool {
  return info.minimum < 0.0;
}

/// Of the rests that grown laws may have (law_parts.cpp): springs from beside the motion to beside it, and a load whose
/// size comes again after half a turn.
constexpr int kSpringRests = 13;
constexpr double kFarthestRest = 1.2;  // of the motion's half range
constexpr int kLoadRests = 12;

auto step_of_places(const CatalogueTerm& term, const MotionPlace& motion) -> double {
  return term.name == "spring" ? 2.0 * kFarthestRest * motion.half / (kSpringRests - 1) : std::numbers::pi / kLoadRests;
}

auto places_of(const CatalogueTerm& term, const MotionPlace& motion) -> std::vector<double> {
  const bool spring = term.name == "spring";
  std::vector<double> places;
  for (int i = 0; i < (spring ? kSpringRests : kLoadRests); ++i) {
    places.push_back((spring ? motion.centre - kFarthestRest * motion.half : 0.0) + i * step_of_places(term, motion));
  }
  return places;
}

/// An effect in the form in which its name is asked first, or in a wider one: a spring that hardens about the middle of
/// the motion, or about a rest beside it.
struct Form {
  const CatalogueTerm* term;
  bool wider;

  [[nodiscard]] auto searches(const ShapeInfo& info) const -> bool {
    return info.of != ShapeOf::kGiven && (wider || term->name != "spring");
  }
  [[nodiscard]] auto searched() const -> std::size_t {
    return static_cast<std::size_t>(
        std::count_if(term->shapes.begin(), term->shapes.end(), [this](const auto& info) { return searches(info); }));
  }
};

/// Every combination of the shapes' grids; a term without shapes has one, empty.
auto shape_grid(const Form& form, const SignalReach& reach, const MotionPlace& motion) -> std::vector<Shapes> {
  const std::size_t points = form.searched() > 1 ? 6 : kGridPoints;
  return combinations(form.term->shapes, [&](const auto& info) {
    if (form.searches(info)) {
      return is_place(info) ? places_of(*form.term, motion) : grid_of(info, points, reach);
    }
    const bool is_speed = std::string_view(info.name) == "speed";
    return std::vector<double>{is_place(info) ? motion.centre : (is_speed ? reach.dq1 : motion.half)};
  });
}

/// A few settings around the best, closer than the grid.
auto fine_grid(const Form& form, const Shapes& best, const SignalReach& reach, const MotionPlace& motion)
    -> std::vector<Shapes> {
  std::vector<Shapes> grid;
  for (std::size_t s = 0; s < best.size(); ++s) {
    const ShapeInfo& info = form.term->shapes[s];
    if (!form.searches(info)) {
      continue;
    }
    if (is_place(info)) {
      for (const double share : {-0.5, 0.0, 0.5}) {
        grid.push_back(best);
        grid.back()[s] += share * step_of_places(*form.term, motion);
      }
      continue;
    }
    const ShapeRange range = grid_range(info, reach);
    const double step = std::pow(range.high / range.low, 1.0 / static_cast<double>(kGridPoints - 1));
    const bool in_ratio = info.scale == ShapeScale::kRatio;
    const double ratio = in_ratio ? step : 1.0 + periods_step(reach) / best[s];
    const ShapeRange limits = range_of(info, reach);
    const double least = in_ratio ? limits.low : fewest_periods(info, reach);
    for (const double value : geometric_grid(best[s] / ratio, best[s] * ratio, kFinePoints + 2)) {
      if (value > least && value < limits.high) {
        grid.push_back(best);
        grid.back()[s] = value;
      }
    }
  }
  return grid;
}

/// Residual energy on some rows, once the free columns are fitted to the error less the fixed one.
auto energy_left(const Eigen::MatrixXd& free, const std::vector<Sign>& signs, const Eigen::VectorXd& wanted,
                 const Blocks& rows) -> double {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(free.cols(), free.cols());
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(free.cols());
  double energy = 0.0;
  for (const auto& block : rows) {
    const auto x = free.middleRows(block.begin, block.size());
    const auto y = wanted.segment(block.begin, block.size());
    gram.noalias() += x.transpose() * x;
    rhs.noalias() += x.transpose() * y;
    energy += y.squaredNorm();
  }
  return energy - solve_signed(gram, rhs, signs).dot(rhs);
}

class Builder {
 public:
  Builder(const Preparation& p, const LawForm& law, const LawResidual& residual)
      : p_(p), law_(law), residual_(residual), rows_(p.split.of(Role::kFit)) {}

  auto build(const Form& form) const -> Candidate {
    const CatalogueTerm& term = *form.term;
    Candidate candidate;
    candidate.name = term.name;
    candidate.in_catalogue = true;
    candidate.acts_on_output = term.acts_on_output;
    candidate.builds_on = term.builds_on;
    candidate.special_cases = term.special_cases;
    candidate.waits = !term.builds_on.empty() && std::none_of(term.builds_on.begin(), term.builds_on.end(),
                                                              [this](const auto& name) { return law_.has(name); });
    for (const auto& coefficient : term.coefficients) {
      candidate.signs.push_back(coefficient.sign);
    }
    if (term.acts_on_output) {
      candidate.signs = {Sign::kNonNegative};
    }
    if (counts_periods(term) && !at_many_places(p_.signals.q1)) {
      return candidate;
    }
    Best best;
    const SignalReach& reach = p_.noncausal.reach();
    const MotionPlace motion(p_.signals.q1);
    if (brings_offset(law_, term.name)) {
      candidate.signs.push_back(Sign::kAny);
    }
    candidate.searched = form.searched();
    candidate.wider = form.wider;
    if (form.wider) {
      candidate.special_cases = {"offset", "gravity", term.name};
    }
    add(term, shape_grid(form, reach, motion), kKeptOfGrid, candidate, best);
    if (candidate.variants.empty()) {
      return candidate;  // it changes nothing here, as a delay of a law that is nought
    }
    if (candidate.searched > 0) {
      add(term, fine_grid(form, best.shapes, reach, motion), 1, candidate, best);
    }
    if (term.acts_on_output) {
      candidate.variants.insert(candidate.variants.begin(), {best.shapes, exact_columns(term, best.shapes)});
    }
    return candidate;
  }

 private:
  struct Best {
    double energy = std::numeric_limits<double>::infinity();
    Shapes shapes;
  };

  void add(const CatalogueTerm& term, const std::vector<Shapes>& grid, std::size_t keep_every, Candidate& candidate,
           Best& best) const {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const Shapes& shapes = grid[i];
      if (is_another(term, shapes)) {
        continue;
      }
      Eigen::MatrixXd columns = term.acts_on_output ? change_of_law(term, shapes) : sum_columns(term, shapes);
      if (columns.cwiseAbs().maxCoeff() <= 0.0) {
        continue;
      }
      const double energy =
          term.acts_on_output ? energy_with_output(term, shapes) : energy_with(columns, candidate.signs);
      if (energy < best.energy) {
        best = {energy, shapes};
      }
      if (i % keep_every == 0) {
        candidate.variants.push_back({shapes, std::move(columns)});
      }
    }
  }

  /// Friction behind a play that the motion hardly crosses is a spring, and a power near 1 is drag, which the law has.
  auto is_another(const CatalogueTerm& term, const Shapes& shapes) const -> bool {
    constexpr double kNearOne = 0.75;  // the nearest that grown laws take is 0.7 (law_parts.cpp)
    return (term.name == "play_friction" && shapes[0] > 0.5 * MotionPlace(p_.signals.q1).half) ||
           (term.name == "power_law_friction" && shapes[0] > kNearOne && shapes[0] < 1.0 / kNearOne);
  }

  auto sum_columns(const CatalogueTerm& term, const Shapes& shapes) const -> Eigen::MatrixXd {
    Eigen::MatrixXd columns = p_.noncausal.columns(term, shapes);
    if (brings_offset(law_, term.name)) {
      columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
      columns.rightCols(1).setOnes();
    }
    for (const auto& other : *law_.catalogue) {
      if (other.acts_on_output && law_.has(other.name)) {
        columns = p_.noncausal.apply(other, law_.shapes_of(other), columns);
      }
    }
    return p_.coarse(columns);
  }

  auto change_of_law(const CatalogueTerm& term, const Shapes& shapes) const -> Eigen::MatrixXd {
    return p_.coarse(p_.noncausal.apply(term, shapes, residual_.fitted) - residual_.fitted);
  }

  /// [change of the law | the law's columns through the term]
  auto exact_columns(const CatalogueTerm& term, const Shapes& shapes) const -> Eigen::MatrixXd {
    const Eigen::MatrixXd law = p_.coarse(p_.noncausal.apply(term, shapes, residual_.full_base));
    Eigen::MatrixXd columns(law.rows(), law.cols() + 1);
    columns << change_of_law(term, shapes), law;
    return columns;
  }

  auto energy_with(const Eigen::MatrixXd& own, const std::vector<Sign>& own_signs) const -> double {
    Eigen::MatrixXd free(own.rows(), residual_.base.cols() + own.cols());
    free << residual_.base, own;
    std::vector<Sign> signs(static_cast<std::size_t>(residual_.base.cols()), Sign::kAny);
    signs.insert(signs.end(), own_signs.begin(), own_signs.end());
    return energy_left(free, signs, residual_.error, rows_);
  }

  auto energy_with_output(const CatalogueTerm& term, const Shapes& shapes) const -> double {
    const Eigen::MatrixXd exact = exact_columns(term, shapes);
    const std::vector<Sign> signs(static_cast<std::size_t>(exact.cols() - 1), Sign::kAny);
    return energy_left(exact.rightCols(exact.cols() - 1), signs, residual_.error - exact.col(0), rows_);
  }

  const Preparation& p_;
  const LawForm& law_;
  const LawResidual& residual_;
  Blocks rows_;
};

}  // namespace

auto catalogue_candidates(const Preparation& p, const LawForm& law, const LawResidual& residual)
    -> std::vector<Candidate> {
  const Builder builder(p, law, residual);
  std::vector<Form> forms;
  for (const auto& term : *law.catalogue) {
    if (!law.has(term.name) && !term.placed) {
      forms.push_back({&term, false});
      if (term.name == "spring") {
        forms.push_back({&term, true});
      }
    }
  }
  std::vector<Candidate> candidates(forms.size());
  two_at_a_time(forms.size(), [&](std::size_t i) { candidates[i] = builder.build(forms[i]); });
  // A term of the torque shows nothing where no torque was logged.
  std::erase_if(candidates, [](const auto& candidate) { return candidate.variants.empty(); });
  return candidates;
}

auto brings_offset(const LawForm& law, const std::string& effect) -> bool {
  return effect == "spring" && !law.has("offset");
}

auto parameter_count(const Candidate& candidate) -> std::size_t {
  if (!candidate.in_catalogue) {
    return candidate.signs.size() + (candidate.variants.size() > 1 ? 1 : 0);
  }
  return candidate.signs.size() + candidate.searched;
}

}  // namespace capstan::tools
