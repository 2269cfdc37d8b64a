// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/selection_data.hpp"

namespace capstan::tools {

/// A term that a law may be given, with the settings of its shapes that are tried, neighbours beside each other.
struct TermGrid {
  std::string term;
  std::vector<Shapes> settings;
  bool by_direction = false;  ///< of tables: see TermChoice
};

/// What laws of a joint angle may consist of.
struct Vocabulary {
  LawCandidate start;                ///< the smallest law; what it has stays
  std::vector<LawCandidate> starts;  ///< laws to grow from; what they have beyond it may go
  std::vector<TermGrid> terms;       ///< at most one setting of each
  std::vector<double> plays;         ///< half widths of plays in front of the ratio
};

/// Laws of a joint angle: hysteresis, ratio, tension, other joints.
auto angle_vocabulary(const SelectionData& data) -> Vocabulary;
/// The same with tables over every signal of the log, by direction and not, alone and times torque, rate or angle, to
/// grow from other laws: for logs whose base law lacks something for certain.
auto wider_vocabulary(const SelectionData& data, std::vector<LawCandidate> starts) -> Vocabulary;

}  // namespace capstan::tools
