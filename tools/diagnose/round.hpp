// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/diagnose/adequacy.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/trials.hpp"

namespace capstan::tools {

/// The law so far, what it leaves, and how every candidate does on that.
struct Round {
  LawResidual residual;
  Evidence evidence;
  Adequacy adequacy;
  std::vector<CandidateTrial> trials;
};

auto hold_round(const Preparation& p, const LawForm& law) -> Round;

/// What a law leaves over, noncausally, its coefficients fitted to the rows that may be learned from.
auto residual_of(const Preparation& p, const LawForm& law) -> LawResidual;

/// Of those that pass, that leave no more than half as much energy again as the one that leaves least, and that no
/// evidence puts behind the most likely of these: the one that explains most in the measured quantity. nullptr if none
/// passes.
auto best_passing(const Round& round, bool catalogue_only) -> const CandidateTrial*;
/// The trial of a candidate by name; nullptr if it does not take part.
auto trial_of(const Round& round, const std::string& name) -> const CandidateTrial*;

/// The round for the report. `chosen` is the trial that won, or nullptr.
auto summary_of(const Round& round, const CandidateTrial* chosen, const std::vector<std::size_t>& confusable)
    -> RoundSummary;
auto names_of(const Round& round, const std::vector<std::size_t>& candidates) -> std::vector<std::string>;

}  // namespace capstan::tools
