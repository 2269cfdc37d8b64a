// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tests/tools/machines/machine_joint.hpp"

namespace capstan::tools::machines {

/// What running a law of an effort causally costs: for every effort of the logs in a folder the error of the law of the
/// joint alone on rows that it has not seen, noncausally and as a board runs it, % of the effort's rms. Prints a
/// table.
/// @param share  of the rows, the first, that choose and fit
void board_efforts(const std::vector<Joint>& joints, double share);

}  // namespace capstan::tools::machines
