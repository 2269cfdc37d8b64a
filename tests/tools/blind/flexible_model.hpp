// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools::blind {

/// What could be taken away of what a base law leaves of one log, as shares of the error energy on the rows that the
/// diagnosis set aside. Below zero where learning did harm.
struct FlexibleModel {
  double by_signals = 0.0;  ///< by what a joint's law may read
  double with_time = 0.0;   ///< by a model that knows the time since the log began, too: no law of a joint does
};

/// A flexible model of the base law's residual, in no common code with laws and diagnosis: a ridge regression on a row
/// of hats over each signal, for each direction of the motor, and on the products of every signal's hats with every
/// other signal. Fitted to the means of short stretches of the rows that the delivered law was learned from; its ridge
/// is chosen there too, by stretches left out in turn. Judged on every row that was set aside.
/// @pre the base law was the usual one of logs with torque
auto flexible_model_of(const AxisLog& log, const Diagnosis& diagnosis) -> FlexibleModel;

}  // namespace capstan::tools::blind
