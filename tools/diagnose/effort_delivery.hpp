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
/// that chose nothing, and traces; names that it has no term for are taken back. Of the torque behind a gear the
/// pull-push law is delivered as identify writes it, unless a grown law errs clearly less. Where the logs do not
/// determine all of it, the grown law is delivered if it is not certain to err more. @pre has_effort_law()
void deliver_effort_law(const std::vector<AxisLog>& logs, Diagnosis& d);

}  // namespace capstan::tools
