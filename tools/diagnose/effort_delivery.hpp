// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// Whether the law that is delivered is grown for what it predicts: that of an effort, or of the torque behind a gear
/// unless its hysteresis was asked for. Names are found beside it.
auto has_effort_law(const std::vector<AxisLog>& logs, const Diagnosis& d) -> bool;

/// Where the search for names ended with a law whose effects are certain, or that errs no more than the grown one, or
/// with nothing missing and no law that errs clearly less, that law is delivered in a form that runs over logs. Else
/// the law that predicts unseen rows best is chosen and takes its place: law, base, errors before and after on the rows
/// that chose nothing, traces, and logs that took no part. A force law that is certain or complete stays in the
/// diagnosis, and the file holds the law of the torque behind the gear. @pre has_effort_law()
void deliver_effort_law(const std::vector<AxisLog>& logs, const DiagnoseOptions& options, Diagnosis& d);

}  // namespace capstan::tools
