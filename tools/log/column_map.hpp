// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// One `--map WANTED=EXPRESSION`: the contract's column and where a foreign log has it. What the expression means
/// depends on the log's columns, whose names may hold any character.
struct ColumnMapping {
  std::string wanted;
  std::string expression;  ///< as given: "current*0.0369", "deg(left - right)"

  /// "NAME*FACTOR" taken apart at the last '*'; nothing if what follows it is no finite number.
  [[nodiscard]] auto scaled() const -> std::optional<std::pair<std::string, double>>;
};

/// Reads "axis0/tau_Nm=current*0.0369". Throws BadInput with the form expected.
auto parse_mapping(const std::string& text) -> ColumnMapping;
auto parse_mappings(const std::vector<std::string>& texts) -> std::vector<ColumnMapping>;

/// Throws BadInput if a mapping makes a column that nothing reads. @param targets  columns that are read beside those
void expect_read(const std::vector<ColumnMapping>& mappings, const std::vector<std::string>& targets);

/// "; write it as --map ...": the cure of every bad mapping.
auto mapping_form() -> std::string;

}  // namespace capstan::tools
