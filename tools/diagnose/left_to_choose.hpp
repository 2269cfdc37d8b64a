// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"

namespace capstan::tools {

/// What a law leaves, rms, of the rows to choose by, its coefficients fitted to the rows to fit.
auto left_to_choose(const Preparation& p, const LawForm& law) -> double;

/// Noise of the target: of repeated cycles, else at most what the law that a search found leaves of the rows to choose.
auto noise_of(const Preparation& p, const Search& search, double left_by_found) -> double;

}  // namespace capstan::tools
