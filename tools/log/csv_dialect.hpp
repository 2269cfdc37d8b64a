// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// The same table by the contract: one comma between cells, points in numbers, no quotes, one header row. Line k stays
/// line k; what stands before the header, and a row of units, become remarks, and the units go into the names as
/// "name [unit]". A text that is by the contract already comes back as it is.
/// Throws BadInput with the true cause and the command that cures it where that would be a guess.
auto canonical_csv(std::string text, const std::string& name, std::vector<std::string>& notes) -> std::string;

}  // namespace capstan::tools
