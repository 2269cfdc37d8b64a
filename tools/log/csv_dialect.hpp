// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// Begins a line that is no row.
inline constexpr char kRemark = '#';

/// Between the cells of a line.
enum class Separator { kTab, kSemicolon, kComma, kWideBlanks, kBlanks };

/// The cells of a line, without quotes and blanks around them. kWideBlanks: two blanks or more, so that names may have
/// single ones in them.
/// @throws Unclosed if a quote is opened and not closed
struct Unclosed {};
auto cells_of(std::string_view line, Separator separator) -> std::vector<std::string>;

/// The same table by the contract: one comma between cells, points in numbers, no quotes, one header row. Line k stays
/// line k; what stands before the header, and a row of units, become remarks, and the units go into the names as
/// "name [unit]". A text that is by the contract already comes back as it is.
/// Throws BadInput with the true cause and the command that cures it where that would be a guess.
auto canonical_csv(std::string text, const std::string& name, std::vector<std::string>& notes) -> std::string;

/// Whether a word is a unit as a units row has it: "rad", "[Nm]", "deg/s", "-".
auto is_unit_word(std::string_view word) -> bool;

}  // namespace capstan::tools
