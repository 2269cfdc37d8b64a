// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/board_effort_law.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <type_traits>

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

/// "axis0/"
auto axis_of(const EffortLaw& law) -> std::string {
  return law.target.substr(0, law.target.find('/') + 1);
}

void check_kind(const EffortLaw& law, const std::string& name) {
  if (law.of_gear()) {
    throw BadInput(name + " is a law of the torque behind a gear, and a board runs laws of its motor's torque; " +
                   "diagnose the log with --target axis0/tau_Nm");
  }
  if (std::string_view(law.joint.catalogue->target_unit()) != "Nm") {
    const std::string axis = axis_of(law);
    throw BadInput(name + " is a law of a linear axis, in N and m, and a board's motors turn; map force and way to " +
                   "torque and angle of the motor (with a drum of radius R in m: --map \"" + axis + "q1_rad=" + axis +
                   "q1_m/R\" --map \"" + axis + "tau_Nm=" + axis + "tau_N*R\"), and diagnose the log again");
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
                     " brings, and no board runs that yet; diagnose the log again with --alone, for the best law " +
                     "that needs no other joint, or a log of this joint with the others at rest");
    }
    if (std::find(known.begin(), known.end(), term) == known.end()) {
      throw BadInput(name + ": no board runs the term " + term + "; " +
                     (described.acts_on_output
                          ? "take its section out of the file, as the feedforward needs none, or correct the log's "
                            "time stamps and diagnose it again"
                          : "diagnose the log again with --alone"));
    }
  }
}

/// The map that brings numbers of a law into a board's range, on the other side of a gear.
auto other_side(const EffortLaw& law, bool before_gear) -> std::string {
  const std::string angle = axis_of(law) + "q1_rad";
  const std::string torque = axis_of(law) + "tau_Nm";
  std::string cure = "map angle and torque to the shaft ";
  cure.append(before_gear ? "before" : "behind").append(" the gear (of ratio N: --map \"");
  cure.append(angle).append("=").append(angle).append(before_gear ? "*" : "/").append("N\" --map \"");
  cure.append(torque).append("=").append(torque).append(before_gear ? "/" : "*");
  return cure.append("N\"), let the board count the same angle, and diagnose the log again");
}

void check(double value, const Interval& range, const std::string& what, const std::string& cure) {
  if (!(value >= range[0] && value <= range[1])) {
    throw BadInput(what + " is " + rounded(value) + ", and a board takes " + rounded(range[0], 3) + " to " +
                   rounded(range[1], 3) + "; " + cure);
  }
}

/// A term's numbers and where they stand among the board's.
template <typename Term>
struct PlacedNumbers {
  static constexpr auto kName = kTorqueTermName<Term>;
  std::size_t coefficient, shape;

  void take(const EffortLaw& law, BoardEffortLaw& board) const {
    const CatalogueTerm& term = law.joint.catalogue->term(kName.data());
    const bool on = law.joint.has(term.name);
    for (std::size_t i = 0; i < kCoefficientsOf<Term>; ++i) {
      const double unit = std::string_view(term.coefficients[i].unit) == "kgm2" ? kPerThousand : 1.0;
      board.law.coefficients[coefficient + i] =
          on ? unit * law.joint.parameters.coefficients[term.first_coefficient + i] : 0.0;
    }
    for (std::size_t i = 0; i < kShapesOf<Term>; ++i) {
      board.law.shapes[shape + i] = on ? law.joint.parameters.shapes[term.first_shape + i] : 0.0;
    }
  }
  void check_range(const EffortLaw& law, const std::string& name, const BoardEffortLaw& board) const {
    for (std::size_t i = 0; i < kCoefficientsOf<Term>; ++i) {
      check(board.law.coefficients[coefficient + i], {-kCoefficientLimit, kCoefficientLimit},
            name + ": " + kName.data(), other_side(law, true));
    }
    for (std::size_t i = 0; i < kShapesOf<Term>; ++i) {
      const ShapeInfo& info = Term::kInfo.shapes[i];
      check(board.law.shapes[shape + i], {std::min(0.0, info.minimum), info.maximum},
            name + ": " + kName.data() + "." + info.name,
            other_side(law, std::string_view(info.unit) == "1"));  // periods in an angle
    }
  }
  /// The same friction by a slower reference: the term stays as it is above twice that, and no board's numbers pass
  /// twice this.
  void slow_reference(BoardEffortLaw& board) const {
    constexpr double kFastest = 64.0;
    double& speed = board.law.shapes[shape + 1];
    if (speed > kFastest) {
      board.law.coefficients[coefficient] *= std::pow(kFastest / speed, board.law.shapes[shape]);
      speed = kFastest;
    }
  }
};

void check_view(const EffortLaw& law, const std::string& name) {
  constexpr Interval kRange = {0.0, 10.0};
  check(law.view.standstill, kRange, name + ": standstill", other_side(law, false));
  check(law.view.letting_go_s, kRange, name + ": letting_go", "write a time within that into the file");
}

}  // namespace

auto board_effort_law(const EffortLaw& law, const std::string& name, bool any_number) -> BoardEffortLaw {
  check_kind(law, name);
  check_terms(law, name);
  BoardEffortLaw board;
  std::size_t coefficient = 0;
  std::size_t shape = 0;
  TorqueTerms::for_each<double>([&]<typename Term>() {
    const PlacedNumbers<Term> numbers{coefficient, shape};
    numbers.take(law, board);
    if constexpr (std::is_same_v<Term, effort::PowerLawFriction<double>>) {
      if (!any_number) {
        numbers.slow_reference(board);
      }
    }
    if (!any_number) {
      numbers.check_range(law, name, board);
    }
    coefficient += kCoefficientsOf<Term>;
    shape += kShapesOf<Term>;
  });
  if (!any_number) {
    check_view(law, name);
  }
  constexpr double kShortestS = 0.016;  // that a board looks through; a longer view is a smoother one, no other law
  constexpr double kLongestS = 0.12;
  board.view.window_s = std::clamp(law.view.window_s, kShortestS, kLongestS);
  board.view.standstill_rad_s = law.view.standstill;
  board.view.letting_go_s = law.view.letting_go_s;
  return board;
}

}  // namespace capstan::tools
