// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/board_effort_law.hpp"

#include <algorithm>
#include <string_view>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kPerThousand = 1000.0;  // files have kg m2, boards torque per krad/s2

auto term_names() -> std::vector<std::string> {
  std::vector<std::string> names;
  TorqueTerms::for_each<double>([&]<typename Term>() { names.emplace_back(kTorqueTermName<Term>.data()); });
  return names;
}

void check_kind(const EffortLaw& law, const std::string& name) {
  if (law.of_gear()) {
    throw BadInput(name + " is a law of the torque behind a gear, and a board runs laws of its motor's torque; " +
                   "diagnose the log with --target axis0/tau_Nm");
  }
  if (std::string_view(law.joint.catalogue->target_unit()) != "Nm") {
    throw BadInput(name + " is a law of a linear axis, in N and m, and a board's motors turn; " +
                   "map force and way to torque and angle of the motor, and diagnose the log again");
  }
  if (!law.target.ends_with("/tau_Nm")) {
    throw BadInput(name + " explains " + law.target + ", and a board measures its motor's torque, axis<N>/tau_Nm; " +
                   "map the column to that name in N m of the motor, and diagnose the log again");
  }
}

void check_terms(const EffortLaw& law, const std::string& name) {
  const std::vector<std::string> known = term_names();
  for (const auto& term : law.joint.terms) {
    const auto& described = law.joint.catalogue->term(term);
    if (described.of_axis) {
      throw BadInput(name + ": " + term + " is what the motion of axis " + std::to_string(*described.of_axis) +
                     " brings, and no board runs that yet; diagnose a log of this joint alone, the others at rest");
    }
    if (std::find(known.begin(), known.end(), term) == known.end()) {
      throw BadInput(name + ": no board runs the term " + term + "; take it out, or diagnose the log again");
    }
  }
}

/// @param term  as it is called in the law
auto checked(double value, double least, double most, const std::string& name, const std::string& term) -> double {
  if (!(value >= least && value <= most)) {
    throw BadInput(name + ": " + term + " is " + rounded(value) + ", and a board takes " + rounded(least, 3) + " to " +
                   rounded(most, 3) +
                   "; give angles in rad and torque in N m at the motor, and diagnose the log again");
  }
  return value;
}

}  // namespace

auto board_effort_law(const EffortLaw& law, const std::string& name, bool any_number) -> BoardEffortLaw {
  check_kind(law, name);
  check_terms(law, name);
  BoardEffortLaw board;
  const auto in_range = [&](double value, double least, double most, const std::string& term) {
    return any_number ? value : checked(value, least, most, name, term);
  };
  std::size_t coefficient = 0;
  std::size_t shape = 0;
  TorqueTerms::for_each<double>([&]<typename Term>() {
    const std::string term = kTorqueTermName<Term>.data();
    const bool on = law.joint.has(term);
    const CatalogueTerm& described = law.joint.catalogue->term(term);
    for (std::size_t i = 0; i < kCoefficientsOf<Term>; ++i, ++coefficient) {
      const double unit = std::string_view(described.coefficients[i].unit) == "kgm2" ? kPerThousand : 1.0;
      const double value = on ? unit * law.joint.parameters.coefficients[described.first_coefficient + i] : 0.0;
      board.law.coefficients[coefficient] = in_range(value, -kCoefficientLimit, kCoefficientLimit, term);
    }
    for (std::size_t i = 0; i < kShapesOf<Term>; ++i, ++shape) {
      const ShapeInfo& info = Term::kInfo.shapes[i];
      const double value = on ? law.joint.parameters.shapes[described.first_shape + i] : 0.0;
      board.law.shapes[shape] = in_range(value, std::min(0.0, info.minimum), info.maximum, term + "." + info.name);
    }
  });
  constexpr double kShortestS = 0.016;  // that a board looks through; a longer view is a smoother one, no other law
  constexpr double kLongestS = 0.12;
  board.view.window_s = std::clamp(law.view.window_s, kShortestS, kLongestS);
  board.view.standstill_rad_s = in_range(law.view.standstill, 0.0, 10.0, "standstill");
  board.view.letting_go_s = in_range(law.view.letting_go_s, 0.0, 10.0, "letting_go");
  return board;
}

}  // namespace capstan::tools
