// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/diagnose/search.hpp"

namespace capstan::tools {

/// Whether a search named what the friction along tendons looks like where nobody asks the torque.
auto may_be_tendons(const Search& search) -> bool;

/// A base law as the search begins with it: tendons whose numbers are known keep them, others are fitted, with the
/// rate's filter that serves them.
auto settled_base(Preparation& p, LawForm base) -> LawForm;

/// A base law, and what it may leave beside noise because tendons are never quite what it says, in the target's unit.
struct BaseChoice {
  LawForm law;
  double form_error = 0.0;
  double rate_filter_s = 0.0;  ///< of the motor's rate, where the law is one of tendons
};

/// The law of two tendons, fitted to the rows to learn from, where it does on the rows to choose by what the usual law
/// can not: leave next to nothing but noise where that one leaves several times as much; or clearly less than the usual
/// law with the effects that a search found. Nothing otherwise.
auto better_base(const Preparation& p, const LawForm& usual, const Search& search) -> std::optional<BaseChoice>;

/// The answer of a search that began with tendons: what they explain themselves is no effect. Nothing where they leave
/// next to nothing but noise and what their law errs by as they are; `pretension_offset` where they do with another
/// pretension; else the effects that were found, up to the one behind which that holds.
auto without_form_error(const Preparation& p, const BaseChoice& tendons, Search search) -> Search;

}  // namespace capstan::tools
