// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// The design whose rows teach a law with a jump by direction: straight lines take the place of doubtful_rows(), in
/// columns and target alike. The running one where other laws are fitted, where many rows are in doubt, or where these
/// rows tell more than that the switch is late.
auto of_known_direction(const std::vector<AxisLog>& logs, const LawDesign& running, const LawForm& form,
                        const ConditionerShape<double>& conditioner) -> LawDesign;

}  // namespace capstan::tools
