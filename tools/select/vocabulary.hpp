// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/selection_data.hpp"

namespace capstan::tools {

/// A term that a law may be given, with the settings of its shapes that are tried, neighbours beside each other.
struct TermGrid {
  std::string term;
  std::vector<Shapes> settings;
};

/// What laws of a joint angle may consist of.
struct Vocabulary {
  LawCandidate start;           ///< the smallest law; what it has stays
  std::vector<TermGrid> terms;  ///< at most one setting of each
  std::vector<double> plays;    ///< half widths of plays in front of the ratio
};

/// Laws of a joint angle: hysteresis, ratio, tension, other joints.
auto angle_vocabulary(const SelectionData& data) -> Vocabulary;

}  // namespace capstan::tools
