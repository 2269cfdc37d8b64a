// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// One term of a law with its shapes set.
struct TermChoice {
  std::string term;
  Shapes shapes;
  bool by_direction = false;  ///< of a table: values of its own for each direction of the motor, else one for both
  auto operator==(const TermChoice&) const -> bool = default;
};

/// A law to be judged by how well it predicts: terms with their shapes, and the half widths of plays that act on the
/// motor angle in front of all others. Those are linear in their coefficients while laws are compared,
///   beta q1 + sum c_i (P_i - q1) = beta h,
/// and become the input term `hysteresis` with weights c_i / beta in the end.
struct LawCandidate {
  std::vector<TermChoice> terms;  ///< in the order of the catalogue
  std::vector<double> plays;      ///< ascending

  auto operator==(const LawCandidate&) const -> bool = default;
  [[nodiscard]] auto find(const std::string& term) const -> const TermChoice*;
  [[nodiscard]] auto has(const std::string& term) const -> bool { return find(term) != nullptr; }
  /// Its term that acts on the finished sum, if there is one.
  [[nodiscard]] auto output(const Catalogue& catalogue) const -> const TermChoice*;
};

/// The candidate with a term added, or in the place of the same term with other shapes.
auto with_term(const Catalogue& catalogue, LawCandidate law, TermChoice choice) -> LawCandidate;
auto without_term(LawCandidate law, const std::string& term) -> LawCandidate;
auto with_play(LawCandidate law, double half_width) -> LawCandidate;
auto without_play(LawCandidate law, std::size_t place) -> LawCandidate;

/// A law as a candidate, its shapes where they are.
auto candidate_of(const LawForm& form) -> LawCandidate;

/// One text per law, for looking it up.
auto key_of(const TermChoice& choice) -> std::string;
auto key_of(const LawCandidate& law) -> std::string;

/// The candidate in short words, for people: "motor_angle + joint_offset + 2 plays + presliding".
auto described(const LawCandidate& law) -> std::string;

}  // namespace capstan::tools
