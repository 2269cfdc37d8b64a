// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_catalogue.hpp"

#include <map>

#include "capstan/tools/identify/term_words.hpp"
#include "capstan/tools/select/arm_terms.hpp"

namespace capstan::tools {
namespace {

template <typename Term>
auto term_of() -> CatalogueTerm {
  CatalogueTerm term = words_of_term<Term>();
  term.columns = columns_of_term<Term>;
  return term;
}

template <typename List>
void add_terms(std::vector<CatalogueTerm>& terms) {
  List::template for_each<double>([&]<typename Term>() { terms.push_back(term_of<Term>()); });
}

/// A regressor and its unit per rad/s2 instead of the firmware's krad/s2.
void take_si_acceleration(CatalogueTerm& term, Eigen::Index column) {
  term.columns = [columns = term.columns, column](const Samples& samples, double period_s, const Shapes& shapes) {
    constexpr double kPerThousand = 1000.0;
    Eigen::MatrixXd result = columns(samples, period_s, shapes);
    result.col(column) *= kPerThousand;
    return result;
  };
  auto& coefficient = term.coefficients[static_cast<std::size_t>(column)];
  coefficient.unit = "kgm2";
  coefficient.doc = "effort per acceleration";
}

void add_couplings(std::vector<CatalogueTerm>& terms) {
  constexpr Eigen::Index kAcceleration = 3;
  for (int axis = 0; axis < kMostCouplingAxes; ++axis) {
    terms.push_back(term_of<effort::MotionCoupling<double>>());
    terms.back().name += "_axis" + std::to_string(axis);
    terms.back().of_axis = axis;
    take_si_acceleration(terms.back(), kAcceleration);
  }
}

/// What is the other axis's by its angle or way, for each that there may be.
void add_arm_terms(AxisKind axis, std::vector<CatalogueTerm>& terms) {
  const bool linear = axis == AxisKind::kLinear;
  for (int other = 0; other < kMostCouplingAxes; ++other) {
    std::vector<CatalogueTerm> own = {posture_coupling(linear)};
    if (!linear) {
      own.push_back(reach_coupling());
    }
    for (auto& term : own) {
      term.name += "_axis" + std::to_string(other);
      term.of_axis = other;
      terms.push_back(std::move(term));
    }
  }
}

/// A second and third place for terms that a law may hold with several shapes.
void add_places(std::vector<CatalogueTerm>& terms) {
  static const std::map<std::string, int> kPlaces = {{"angle_periodic", 3}, {"play_friction", 2}, {"load_friction", 2}};
  std::vector<CatalogueTerm> more;
  for (const auto& term : terms) {
    const auto found = kPlaces.find(term.name);
    for (int place = 2; found != kPlaces.end() && place <= found->second; ++place) {
      more.push_back(term);
      more.back().name += "_" + std::to_string(place);
    }
  }
  terms.insert(terms.end(), more.begin(), more.end());
}

/// Newtons and metres.
void make_linear_effort(std::vector<CatalogueTerm>& terms) {
  static const std::map<std::string, const char*> kLinear = {{"rad", "m"},      {"rad/s", "m/s"},    {"Nm", "N"},
                                                             {"Nm/rad", "N/m"}, {"Nms/rad", "Ns/m"}, {"Nm/K", "N/K"},
                                                             {"kgm2", "kg"}};
  const auto in_metres = [](const char* unit) {
    const auto found = kLinear.find(unit);
    return found == kLinear.end() ? unit : found->second;
  };
  for (auto& term : terms) {
    for (auto& coefficient : term.coefficients) {
      coefficient.unit = in_metres(coefficient.unit);
    }
    for (auto& shape : term.shapes) {
      shape.unit = in_metres(shape.unit);
    }
  }
}

/// Those of which a law may hold more than a name is asked of.
auto is_of_machines(const std::string& term) -> bool {
  bool found = false;
  MachineEffortTerms::for_each<double>([&]<typename Term>() { found = found || term == Term::kInfo.name; });
  return found;
}

/// The other terms of effort_catalogue(), its output terms taken out of the way.
auto known_terms(AxisKind axis, std::vector<CatalogueTerm>& output) -> std::vector<CatalogueTerm> {
  std::vector<CatalogueTerm> terms;
  for (const auto& term : effort_catalogue(axis)) {
    if (!is_of_machines(term.name)) {
      (term.acts_on_output ? output : terms).push_back(term);
    }
  }
  return terms;
}

auto grown_efforts(AxisKind axis) -> Catalogue {
  std::vector<CatalogueTerm> output;
  std::vector<CatalogueTerm> terms = known_terms(axis, output);
  std::vector<CatalogueTerm> own;
  add_terms<MachineEffortTerms>(own);
  add_couplings(own);
  if (axis == AxisKind::kLinear) {
    make_linear_effort(own);
  }
  add_arm_terms(axis, own);
  terms.insert(terms.end(), own.begin(), own.end());
  add_places(terms);
  terms.insert(terms.end(), output.begin(), output.end());
  const bool linear = axis == AxisKind::kLinear;
  return {TargetKind::kEffort, linear ? "N" : "Nm", linear ? "m" : "rad", std::move(terms)};
}

auto gears() -> Catalogue {
  std::vector<CatalogueTerm> terms;
  add_terms<GearTerms>(terms);
  std::vector<CatalogueTerm> output;
  for (auto& term : known_terms(AxisKind::kRotary, output)) {
    terms.push_back(std::move(term));
  }
  add_terms<TermList<effort::PowerLawFriction, effort::Spring>>(terms);
  for (auto& term : terms) {
    for (auto& coefficient : term.coefficients) {
      coefficient.sign = Sign::kAny;
    }
  }
  return {TargetKind::kForce, "Nm", "rad", std::move(terms)};
}

}  // namespace

auto effort_law_catalogue(AxisKind axis) -> const Catalogue& {
  static const Catalogue kRotary = grown_efforts(AxisKind::kRotary);
  static const Catalogue kLinear = grown_efforts(AxisKind::kLinear);
  return axis == AxisKind::kLinear ? kLinear : kRotary;
}

auto gear_law_catalogue() -> const Catalogue& {
  static const Catalogue kGears = gears();
  return kGears;
}

auto effect_name(const std::string& term) -> std::string {
  const auto end = term.find_last_of('_');
  if (end == std::string::npos || end + 1 == term.size()) {
    return term;
  }
  const std::string last = term.substr(end + 1);
  const std::string digits = last.rfind("axis", 0) == 0 ? last.substr(4) : last;
  const bool numbered = !digits.empty() && digits.find_first_not_of("0123456789") == std::string::npos;
  return numbered ? term.substr(0, end) : term;
}

}  // namespace capstan::tools
