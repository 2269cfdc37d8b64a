// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/round.hpp"
#include "capstan/tools/identify/loop.hpp"

namespace capstan::tools {

/// The effects found must explain more than this of what can be explained, for certain, or none of them is named.
inline constexpr double kNamedShare = 0.5;

/// What the search for effects came to, before anything is reported.
struct Search {
  LawForm law;  ///< the base with the effects found
  std::vector<AddedEffect> effects;
  std::vector<RoundSummary> rounds;
  /// The law found still leaves more than noise; or a probe, and nothing listed, explains what the base leaves.
  bool lacks_something = false;
  bool by_torque = false;  ///< the effects are told by the motor's torque, whatever they do for the angle
  std::string unlisted;    ///< the probe that fits best what is left; empty if none does
  ExplainedShare share;    ///< of all that can be explained, by the effects found
  double noise_floor = 0.0;
  double base_reducible = 0.0;               ///< share of the base law's residual energy that is no noise
  std::vector<std::string> sizes;            ///< sentences on how large what came is
  std::optional<Loop> loop = {};             ///< of these logs, where it was compared with a healthy joint's
  std::vector<DetectableEffect> detectable;  ///< smallest effects that would have shown in the last round
};

/// Adds effects to the base law one by one, or two where only two explain anything, until the first refusal; then
/// checks backward that none has become superfluous.
auto search_effects(const Preparation& p, const LawForm& base, const std::function<void(const std::string&)>& progress)
    -> Search;

}  // namespace capstan::tools
