// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/diagnose/round.hpp"

namespace capstan::tools {

/// An effect on its way into the law.
struct Proposal {
  std::string name;
  Shapes shapes;
  bool held = false;  ///< the shapes stay as they are
};

auto proposal(const Round& round, std::size_t candidate, std::size_t variant) -> Proposal;

/// The law with the proposals added, shapes refined on the measured quantity; empty if one of them does not hold in the
/// joint fit: its shape runs to the end of its range, or its coefficients to the bound of their signs.
auto law_with(const Preparation& p, LawForm law, const std::vector<Proposal>& added) -> std::optional<LawForm>;
auto law_without(LawForm law, const std::string& name) -> LawForm;

/// What a round says of an effect that is taken into the law, and of those that the log can not tell from it.
auto added_effect(const Round& round, const CandidateTrial& trial, const std::vector<std::size_t>& confusable)
    -> AddedEffect;

}  // namespace capstan::tools
