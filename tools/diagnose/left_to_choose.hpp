// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"

namespace capstan::tools {

/// What a law leaves, rms, of the rows to choose by, its coefficients fitted to the rows to fit.
auto left_to_choose(const Preparation& p, const LawForm& law) -> double;

/// Noise of the target: of repeated cycles, else at most what the law that a search found leaves of the rows to choose.
auto noise_of(const Preparation& p, const Search& search, double left_by_found) -> double;

/// What a healthy law left of its own log, which no camera but a noisier one exceeds: that one shows it from sample to
/// sample. Infinite where nobody wrote it down.
auto noise_known(const Preparation& p, const JointFile& healthy) -> double;

}  // namespace capstan::tools
