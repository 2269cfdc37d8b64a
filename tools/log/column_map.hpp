// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// One `--map WANTED=SOURCE[*FACTOR]`: the contract's column and where a foreign log has it.
struct ColumnMapping {
  std::string wanted;
  std::string source;
  double factor = 1.0;
};

/// Reads "axis0/tau_Nm=current*0.0369". Throws BadInput with the form expected.
auto parse_mapping(const std::string& text) -> ColumnMapping;
auto parse_mappings(const std::vector<std::string>& texts) -> std::vector<ColumnMapping>;

}  // namespace capstan::tools
