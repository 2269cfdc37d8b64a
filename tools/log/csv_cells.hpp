// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// Begins a line that is no row.
inline constexpr char kRemark = '#';
/// Whether a line is no row: MATLAB's remarks begin with a '%'.
auto is_remark(std::string_view line) -> bool;

/// Between the cells of a line.
enum class Separator { kTab, kSemicolon, kComma, kBar, kWideBlanks, kBlanks };

/// The cells of a line, without quotes and blanks around them. kWideBlanks: two blanks or more, so that names may have
/// single ones in them.
/// @throws Unclosed if a quote is opened and not closed
struct Unclosed {};
auto cells_of(std::string_view line, Separator separator) -> std::vector<std::string>;

/// "1,5" as "1.5"; nothing if the cell is no number with one decimal comma.
auto with_decimal_point(std::string_view cell) -> std::optional<std::string>;

/// "1.234,5" or "1,234.5": one mark for the decimals, the other between thousands.
auto has_thousands(std::string_view cell) -> bool;

/// Half of the cells that say something are numbers.
auto is_data(const std::vector<std::string>& cells) -> bool;

/// Whether a word is a unit as a units row has it: "rad", "[Nm]", "deg/s", "-".
auto is_unit_word(std::string_view word) -> bool;
auto is_units_row(const std::vector<std::string>& cells) -> bool;
/// "double,double,string"
auto is_types_row(const std::vector<std::string>& cells) -> bool;

/// What to say behind a cell that should be a number: what it is instead, and the cure.
/// @param may_be_empty  what was not measured may be an empty cell
auto no_number(std::string_view cell, bool may_be_empty, const std::string& log) -> std::string;

}  // namespace capstan::tools
