// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"
#include "capstan/tools/select/choice.hpp"

namespace capstan::tools {

/// The law with the effects that were found, or the base law.
auto as_searched(const Diagnosis& d, bool named) -> LawChoice;

/// Nothing is left to choose where the law that the search ended with leaves no more than the noise: any other law that
/// did better there would fit it. Only repeated cycles say so alone, for without them a residual is its own floor, and
/// a flexible model may miss as much as the law does. The law of two tendons stays where no grown law leaves less by
/// more than a floor may be off. Where something is left for certain, be it the form of a term alone, there is
/// something to choose.
auto chosen_law(const Preparation& p, const Search& search, const Diagnosis& d) -> LawChoice;

/// Says of a law without a name, which was chosen by what it predicts of other rows, that those set aside do not show
/// its gain for certain.
void warn_of_uncertain_gain(Diagnosis& d);

/// The floor is the noise, or what a law leaves of the same rows where that is less.
void bound_floor(Diagnosis& d);

}  // namespace capstan::tools
