// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnose/adequacy.hpp"
#include "tools/diagnose/diagnosis.hpp"
#include "tools/diagnose/trials.hpp"

namespace capstan::tools {

/// What the search for effects came to, before anything is reported.
struct Search {
  LawForm law;                       ///< the base with the effects found
  std::vector<AddedEffect> effects;
  std::vector<std::vector<RankedEffect>> rounds;
  bool lacks_something = false;      ///< the law found still leaves more than noise
  std::string unlisted;              ///< the probe that fits best what is left; empty if none does
  ExplainedShare share;              ///< of all that can be explained, by the effects found
  double noise_floor = 0.0;
  double base_reducible = 0.0;       ///< share of the base law's residual energy that is no noise
  std::vector<std::string> trace;
  std::vector<std::string> detectable;  ///< smallest effects that would have shown in the last round
};

/// Adds effects to the base law one by one, until the first refusal, then checks backward.
auto search_effects(const Preparation& p, const LawForm& base, const std::function<void(const std::string&)>& progress) -> Search;

/// What a law leaves over, in hindsight, its coefficients fitted to the rows that may be learned from.
auto residual_of(const Preparation& p, const LawForm& law) -> LawResidual;

}  // namespace capstan::tools
