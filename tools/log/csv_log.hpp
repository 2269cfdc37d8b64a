// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/log/column_map.hpp"

namespace capstan::tools {

/// A log file by the contract: CSV, one header row, SI units in the names, time_s strictly increasing.
/// Cells are kept as text until a column is asked for, so what nobody uses is neither parsed nor judged.
class CsvLog {
 public:
  /// Throws BadInput with file, line and cure. A last line that was cut off is dropped with a warning.
  static auto read(const std::string& path, std::vector<ColumnMapping> mappings = {}) -> CsvLog;
  static auto parse(std::string text, std::string name, std::vector<ColumnMapping> mappings = {}) -> CsvLog;

  [[nodiscard]] auto name() const -> const std::string& { return name_; }
  [[nodiscard]] auto rows() const -> std::size_t { return lines_.size(); }
  [[nodiscard]] auto warnings() const -> const std::vector<std::string>& { return warnings_; }
  [[nodiscard]] auto column_names() const -> const std::vector<std::string>& { return names_; }

  /// True if column(wanted) would find its cells, under its own name or by a mapping.
  [[nodiscard]] auto has(const std::string& wanted) const -> bool;
  /// Name in the file of the column that wanted is read from as it is; `wanted` itself where a factor changes the unit.
  [[nodiscard]] auto source_name(const std::string& wanted) const -> std::string;
  /// Every cell as a finite number, the mapping's factor applied. Throws BadInput: missing column, or a cell that is
  /// not a number.
  [[nodiscard]] auto column(const std::string& wanted) const -> Eigen::VectorXd;
  /// time_s. Throws BadInput if it repeats or runs backward.
  [[nodiscard]] auto time() const -> Eigen::VectorXd;

  /// Line number in the file of a row, counted from 1.
  [[nodiscard]] auto line_of(std::size_t row) const -> std::size_t { return lines_[row].number; }
  /// The log as text again with columns appended; a column that is there already under that name is replaced.
  /// @pre every column has rows() values
  [[nodiscard]] auto text_with(const std::vector<std::string>& names, const std::vector<Eigen::VectorXd>& columns) const
      -> std::string;

 private:
  struct Line {
    std::size_t begin, end;  // in text_
    std::size_t number;
  };
  struct Source {
    std::size_t index;
    double factor;
  };

  void read_header(std::string_view line);
  /// From a place in the text on, which is the line of that number.
  void read_rows(std::size_t begin, std::size_t number);
  [[nodiscard]] auto line_text(const Line& line) const -> std::string_view;
  [[nodiscard]] auto find(const std::string& wanted) const -> std::optional<Source>;
  [[nodiscard]] auto missing(const std::string& wanted) const -> std::string;

  std::string name_, text_;
  std::vector<ColumnMapping> mappings_;
  std::vector<std::string> names_;
  std::vector<Line> lines_;
  std::vector<std::string> warnings_;
};

/// Numbers with at least nine decimals and enough digits to read back exactly.
auto log_number(double value) -> std::string;

}  // namespace capstan::tools
