// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/term_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <type_traits>

#include "capstan/tools/identify/noncausal_samples.hpp"
#include "capstan/tools/identify/term_words.hpp"

namespace capstan::tools {
namespace {

template <typename Term>
auto describe() -> CatalogueTerm {
  CatalogueTerm term = words_of_term<Term>();
  term.reads_input = reads_input<Term>();
  const TermRelations& relations = Term::kInfo.relations;
  term.doubles.assign(relations.doubles.begin(), relations.doubles.end());
  term.builds_on.assign(relations.builds_on.begin(), relations.builds_on.end());
  term.special_cases.assign(relations.special_cases.begin(), relations.special_cases.end());
  term.shown_by = relations.shown_by;
  term.shapes_are_open = relations.open_shapes;
  term.slots = relations.slots;
  term.form_free = relations.form_free;
  term.placed = relations.placed;
  return term;
}

template <typename Term>
auto pass_through(const Eigen::VectorXd& signal, double period_s, const Shapes& shapes) -> Eigen::VectorXd {
  Eigen::VectorXd result(signal.size());
  Term term = make_term<Term>(period_s, shapes);
  for (Eigen::Index row = 0; row < signal.size(); ++row) {
    result[row] = term.update(signal[row]);
  }
  return result;
}

/// By an input stage with the one term alone, so that h and its rate come out as the firmware has them.
template <typename Term>
auto pass_input(const Samples& samples, double period_s, double rate_time_constant_s, const Shapes& shapes) -> Samples {
  std::array<double, kShapeCount> all{};
  std::size_t next = 0;
  InputTerms::for_each<double>([&]<typename Other>() {
    for (std::size_t i = 0; i < kShapesOf<Other>; ++i, ++next) {
      all[next] = std::is_same_v<Other, Term> ? shapes.at(i) : 0.0;
    }
  });
  const SamplePeriod<double> dt(period_s);
  InputStage<double> stage(dt, all, dt.filter_gain(rate_time_constant_s));
  Samples result = samples;
  for (auto& sample : result) {
    stage.update(sample);
  }
  return result;
}

template <typename Term>
auto input_term() -> CatalogueTerm {
  CatalogueTerm term = describe<Term>();
  term.acts_on_input = true;
  term.input = pass_input<Term>;
  return term;
}

template <typename Term>
auto sum_term() -> CatalogueTerm {
  CatalogueTerm term = describe<Term>();
  term.columns = columns_of_term<Term>;
  return term;
}

template <typename Term>
auto output_term() -> CatalogueTerm {
  CatalogueTerm term = describe<Term>();
  term.acts_on_output = true;
  term.apply = pass_through<Term>;
  return term;
}

template <typename List>
void add_sum_terms(std::vector<CatalogueTerm>& terms) {
  List::template for_each<double>([&]<typename Term>() { terms.push_back(sum_term<Term>()); });
}

void add_output_terms(std::vector<CatalogueTerm>& terms) {
  OutputTerms::for_each<double>([&]<typename Term>() { terms.push_back(output_term<Term>()); });
}

using UnitTable = std::map<std::string, const char*>;

/// Units that are not in the table stay.
auto unit_by(const UnitTable& table, const char* unit) -> const char* {
  const auto found = table.find(unit);
  return found == table.end() ? unit : found->second;
}

/// Terms of the joint angle as parts of an effort: the same regressors, so a coefficient's unit changes from angle to
/// effort per regressor.
void add_shared_terms(std::vector<CatalogueTerm>& terms) {
  static const UnitTable kPerEffort = {{"rad", "Nm"}, {"rad/K", "Nm/K"}, {"1", "Nm/rad"}, {"rad/Nm", "1"}};
  std::vector<CatalogueTerm> shared;
  add_sum_terms<SharedTerms>(shared);
  for (auto& term : shared) {
    for (auto& coefficient : term.coefficients) {
      coefficient.unit = unit_by(kPerEffort, coefficient.unit);
    }
    terms.push_back(std::move(term));
  }
}

/// Inertia per rad/s2 instead of the firmware's krad/s2.
void take_si_inertia(CatalogueTerm& term) {
  static constexpr double kPerThousand = 1000.0;
  term.columns = [columns = term.columns](const Samples& samples, double period_s, const Shapes& shapes) {
    return Eigen::MatrixXd(kPerThousand * columns(samples, period_s, shapes));
  };
  term.coefficients[0].unit = "kgm2";
  term.coefficients[0].doc = "effort per acceleration";
}

/// Which terms of an effort are others with one coefficient at nothing.
template <typename List>
void take_special_cases_of_effort(std::vector<CatalogueTerm>& terms) {
  List::template for_each<double>([&]<typename Term>() {
    const Names& names = Term::kInfo.relations.special_cases_of_effort;
    for (auto& term : terms) {
      if (term.name == Term::kInfo.name) {
        term.special_cases.assign(names.begin(), names.end());
      }
    }
  });
}

/// What terms of the joint angle are taken for where they are parts of an effort: its own terms.
void take_words_of_effort(std::vector<CatalogueTerm>& terms) {
  static const std::map<std::string, const char*> kConfusableWith = {
      {"gravity", "spring where the angle changes little, offset, angle_periodic of a low order"},
      {"angle_periodic", "gravity where N is near 1, quantisation"},
      {"thermal_drift", "offset"},
      {"transport_delay", "inertia, viscous_friction"}};
  for (auto& term : terms) {
    if (const auto found = kConfusableWith.find(term.name); found != kConfusableWith.end()) {
      term.confusable_with = found->second;
    }
  }
}

/// What another axis's motion asks of this motor, beside its angle and torque: a cable that it drags along, mass that
/// both move. Samples hold no rate of it.
void add_rates_of_other(std::vector<CatalogueTerm>& terms) {
  const auto found =
      std::find_if(terms.begin(), terms.end(), [](const auto& term) { return term.name == "axis_coupling"; });
  found->equation = "b q1o + J_o a_t tau_o + (1 - J_o) a_b tau_o + d q1o' + m q1o'', o the other axis";
  found->coefficients.push_back({"drag", "Nms/rad", Sign::kAny, "effort per speed of the other axis"});
  found->coefficients.push_back({"inertia", "kgm2", Sign::kAny, "effort per acceleration of the other axis"});
  found->columns = [columns = found->columns](const Samples& samples, double period_s, const Shapes& shapes) {
    // Half a window: a motion of 5 Hz loses 1 % of its speed. Chosen on no log.
    constexpr double kHalfWindowS = 0.01;
    Eigen::MatrixXd result = columns(samples, period_s, shapes);
    Eigen::VectorXd angle(result.rows());
    std::transform(samples.begin(), samples.end(), angle.begin(), [](const auto& s) { return s.others[0].q1; });
    const auto half = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(kHalfWindowS / period_s)));
    result.conservativeResize(Eigen::NoChange, result.cols() + 2);
    const Eigen::VectorXd speed = local_slope(angle, half, period_s);
    result.rightCols(2) << speed, local_slope(speed, half, period_s);
    return result;
  };
}

/// How what measured machines have beside friction and weight relates to the other effects of an effort. Their laws
/// hold more of each term (select/effort_catalogue.hpp); here stands what a name can be asked of.
auto terms_of_machines() -> std::vector<CatalogueTerm> {
  CatalogueTerm power = sum_term<effort::PowerLawFriction<double>>();
  power.coefficients[0].sign = Sign::kNonNegative;
  power.shapes[1].of = ShapeOf::kGiven;
  power.special_cases = {"coulomb_friction"};  // at no speed at all
  power.doubles = {"coulomb_friction", "stribeck_friction", "play_friction"};
  power.shown_by = Motion::kSpeeds;
  CatalogueTerm spring = sum_term<effort::Spring<double>>();
  spring.shapes[1].of = ShapeOf::kGiven;
  spring.special_cases = {"offset"};
  spring.doubles = {"offset", "gravity", "angle_periodic"};
  spring.shown_by = Motion::kTurns;
  CatalogueTerm load = sum_term<effort::LoadFriction<double>>();
  load.columns = [columns = load.columns](const Samples& samples, double period_s, const Shapes& shapes) {
    return Eigen::MatrixXd(columns(samples, period_s, shapes).leftCols(1));  // of the weight, as large either way
  };
  load.equation = "s W |sin(q1 - rest)|, s = 2J - 1";
  load.coefficients.resize(1);
  load.coefficients[0].sign = Sign::kNonNegative;
  load.shapes[1].of = ShapeOf::kGiven;
  load.builds_on = {"gravity"};
  load.special_cases = {"coulomb_friction"};  // where the load hardly changes
  load.doubles = {"coulomb_friction"};
  load.shown_by = Motion::kTurns;
  return {std::move(power), std::move(spring), std::move(load)};
}

/// A linear axis: metres and newtons. Its weight does not turn with it, so that is part of the offset.
void make_linear(std::vector<CatalogueTerm>& terms) {
  static const UnitTable kLinear = {{"rad", "m"},        {"rad/s", "m/s"}, {"Nm", "N"},   {"Nm/rad", "N/m"},
                                    {"Nms/rad", "Ns/m"}, {"Nm/K", "N/K"},  {"kgm2", "kg"}};
  std::erase_if(terms, [](const auto& term) { return term.name == "gravity" || term.name == "load_friction"; });
  for (auto& term : terms) {
    for (auto& coefficient : term.coefficients) {
      coefficient.unit = unit_by(kLinear, coefficient.unit);
    }
    for (auto& shape : term.shapes) {
      shape.unit = unit_by(kLinear, shape.unit);
    }
  }
}

auto transmission() -> Catalogue {
  std::vector<CatalogueTerm> terms;
  InputTerms::for_each<double>([&]<typename Term>() { terms.push_back(input_term<Term>()); });
  add_sum_terms<SumTerms>(terms);
  add_output_terms(terms);
  return {TargetKind::kAngle, "rad", "rad", std::move(terms)};
}

auto efforts(AxisKind axis) -> Catalogue {
  std::vector<CatalogueTerm> terms;
  add_sum_terms<EffortTerms>(terms);
  take_si_inertia(terms.front());
  for (auto& term : terms_of_machines()) {
    terms.push_back(std::move(term));
  }
  add_shared_terms(terms);
  add_rates_of_other(terms);
  add_output_terms(terms);
  take_special_cases_of_effort<EffortTerms>(terms);
  take_special_cases_of_effort<SharedTerms>(terms);
  take_words_of_effort(terms);
  if (axis == AxisKind::kLinear) {
    make_linear(terms);
    return {TargetKind::kEffort, "N", "m", std::move(terms)};
  }
  return {TargetKind::kEffort, "Nm", "rad", std::move(terms)};
}

}  // namespace

auto CatalogueTerm::initial_shapes() const -> Shapes {
  Shapes initial;
  for (const auto& shape : shapes) {
    initial.push_back(shape.initial);
  }
  return initial;
}

Catalogue::Catalogue(TargetKind target, std::string target_unit, std::string motion_unit,
                     std::vector<CatalogueTerm> terms)
    : target_(target),
      target_unit_(std::move(target_unit)),
      motion_unit_(std::move(motion_unit)),
      terms_(std::move(terms)) {
  std::size_t shape = 0;
  for (auto& term : terms_) {
    term.first_coefficient = coefficient_count_;
    term.first_shape = shape;
    coefficient_count_ += term.coefficients.size();
    shape += term.shapes.size();
  }
}

auto Catalogue::has(const std::string& name) const -> bool {
  return std::any_of(begin(), end(), [&](const auto& term) { return term.name == name; });
}

auto Catalogue::term(const std::string& name) const -> const CatalogueTerm& {
  const auto found = std::find_if(begin(), end(), [&](const auto& term) { return term.name == name; });
  if (found == end()) {
    throw std::logic_error("no term " + name + " in the catalogue");
  }
  return *found;
}

auto Catalogue::initial_shapes() const -> Shapes {
  Shapes initial;
  for (const auto& term : terms_) {
    const Shapes own = term.initial_shapes();
    initial.insert(initial.end(), own.begin(), own.end());
  }
  return initial;
}

auto fine_tendon_catalogue() -> const Catalogue& {
  static const Catalogue kCatalogue = [] {
    constexpr std::size_t kPlaces = 32;
    std::vector<CatalogueTerm> terms(term_catalogue().begin(), term_catalogue().end());
    for (auto& term : terms) {
      if (term.name == Tendons<double>::kInfo.name) {
        term.columns = columns_of_term<TendonsOf<double, kPlaces>>;
      }
    }
    return Catalogue(TargetKind::kAngle, "rad", "rad", std::move(terms));
  }();
  return kCatalogue;
}

auto term_catalogue() -> const Catalogue& {
  static const Catalogue kTransmission = transmission();
  return kTransmission;
}

auto effort_catalogue(AxisKind axis) -> const Catalogue& {
  static const Catalogue kRotary = efforts(AxisKind::kRotary);
  static const Catalogue kLinear = efforts(AxisKind::kLinear);
  return axis == AxisKind::kLinear ? kLinear : kRotary;
}

auto catalogue_term(const std::string& name) -> const CatalogueTerm& {
  return term_catalogue().term(name);
}

auto is_offset(const std::string& term) -> bool {
  return term == "joint_offset" || term == "offset";
}

}  // namespace capstan::tools
