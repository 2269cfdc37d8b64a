// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// The number that fills `text` completely (blanks around it allowed), or nothing. "nan" and "inf" parse: whoever needs
/// a finite value asks for it. Independent of the locale.
auto parse_number(std::string_view text) -> std::optional<double>;

/// Shortest text that reads back as the same number.
auto exact(double value) -> std::string;

/// `digits` significant digits, for people.
auto rounded(double value, int digits = 4) -> std::string;
/// "value [low, high]", the ends with three digits.
auto with_interval(double value, double low, double high, int digits = 4) -> std::string;

/// "a, b, c"
auto joined(const std::vector<std::string>& words, std::string_view separator = ", ") -> std::string;

auto trimmed(std::string_view text) -> std::string_view;

auto is_one_of(const auto& words, std::string_view word) -> bool {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// Whether both names are of one file, links followed; also of one that is not there yet. No device or folder is one.
auto same_file(const std::string& a, const std::string& b) -> bool;

/// Makes a folder unless it is there. Throws BadInput.
void make_folder(const std::string& path);

/// Whole file. Throws BadInput if it can not be read.
auto read_text_file(const std::string& path) -> std::string;

/// Throws BadInput where open_to_write() would. Makes and changes nothing.
void expect_writable(const std::string& path);
/// A file that is written bit by bit, as a log is. Throws BadInput.
auto open_to_write(const std::string& path) -> std::ofstream;
/// Its end: only now is it certain that the disk took all of it. Throws BadInput.
void finish_writing(std::ofstream& file, const std::string& path);

/// Writes by way of a PendingFile, so that a failure leaves no half-written file. Throws BadInput.
void write_text_file(const std::string& path, std::string_view text);

}  // namespace capstan::tools
