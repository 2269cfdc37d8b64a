// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/tools/select/angle_laws.hpp"
#include "capstan/tools/select/confidence_set.hpp"

namespace capstan::tools {

/// A law that was compared.
struct JudgedLaw {
  LawCandidate law;
  double score = 0.0;    ///< mean squared error on unseen parts
  double p_value = 0.0;  ///< of the model confidence set
  bool in_set = false;
  std::array<double, 2> halves = {};  ///< the score on the first and the second half of the unseen parts
};

/// Which law predicts unseen rows best.
struct Selection {
  std::vector<JudgedLaw> laws;  ///< in the order given, then those that were grown
  std::size_t best = 0;         ///< the one that errs least
};

/// Judges the laws given, of a joint angle, beside those grown from a vocabulary. No law is judged twice.
auto select_law(ForwardScore& forward, const std::vector<LawCandidate>& given, const Vocabulary& vocabulary)
    -> Selection;

/// A law fitted to the rows, as a file: its plays are the input stage.
auto joint_of(SelectionData& data, const Blocks& rows, const LawCandidate& law,
              const ConditionerShape<double>& conditioner) -> JointFile;

}  // namespace capstan::tools
