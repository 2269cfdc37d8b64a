// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/tools/log/column_expression.hpp"
#include "capstan/tools/log/column_map.hpp"

namespace capstan::tools {

/// A log file by the contract: CSV, one header row, SI units in the names, time_s strictly increasing. What people have
/// instead (other separators, decimal commas, packed files, MCAP: docs/logs.md) is brought into that form first.
/// Cells are kept as text until a column is asked for, so what nobody uses is neither parsed nor judged.
class CsvLog {
 public:
  /// Throws BadInput with file, line and cure. A last line that was cut off is dropped with a warning.
  static auto read(const std::string& path, std::vector<ColumnMapping> mappings = {}) -> CsvLog;
  /// @param bytes  of the file, whatever form it has
  static auto parse(std::string bytes, std::string name, std::vector<ColumnMapping> mappings = {}) -> CsvLog;

  [[nodiscard]] auto name() const -> const std::string& { return name_; }
  [[nodiscard]] auto rows() const -> std::size_t { return lines_.size(); }
  [[nodiscard]] auto warnings() const -> const std::vector<std::string>& { return warnings_; }
  [[nodiscard]] auto column_names() const -> const std::vector<std::string>& { return names_; }

  /// True if column(wanted) would find its cells, given by with_rows(), under its own name or by a mapping. A mapping
  /// counts whether its columns are there or not: column() says what is wrong.
  [[nodiscard]] auto has(const std::string& wanted) const -> bool;
  /// Name in the file of the column that wanted is read from as it is; `wanted` itself where a factor changes the unit.
  [[nodiscard]] auto source_name(const std::string& wanted) const -> std::string;
  /// What wanted is read from, as a part of another --map.
  [[nodiscard]] auto expression_of(const std::string& wanted) const -> std::string;
  /// Every cell as a finite number, the mapping worked out. Throws BadInput: missing column, or a cell that is
  /// not a number.
  [[nodiscard]] auto column(const std::string& wanted) const -> Eigen::VectorXd;
  /// The same with NaN where a cell that it needs is empty, as in logs of several rates.
  [[nodiscard]] auto column_with_gaps(const std::string& wanted) const -> Eigen::VectorXd;
  /// time_s; times of day as seconds since the first row. Throws BadInput if it repeats or runs backward.
  [[nodiscard]] auto time() const -> Eigen::VectorXd;
  /// Whether the command line says where time comes from, or a unit that the log itself gives.
  [[nodiscard]] auto time_is_mapped() const -> bool;
  /// The same log with these rows only, and with these columns in place of its own or beside them. Line numbers stay
  /// the file's.
  /// @pre each column has as many values as there are rows
  [[nodiscard]] auto with_rows(const std::vector<std::size_t>& rows,
                               std::map<std::string, Eigen::VectorXd> columns) const -> CsvLog;

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
    std::vector<std::size_t> indices;
    double factor = 1.0;
    std::optional<ColumnExpression> expression;  // of the columns at `indices`, in place of the factor
  };

  void read_header(std::string_view line);
  /// From a place in the text on, which is the line of that number.
  void read_rows(std::size_t begin, std::size_t number);
  [[nodiscard]] auto line_text(const Line& line) const -> std::string_view;
  [[nodiscard]] auto index_of(const std::string& name) const -> std::optional<std::size_t>;
  /// Of the mapping's columns; throws BadInput where there is none of that name, or the expression is none.
  [[nodiscard]] auto mapped(const ColumnMapping& mapping) const -> Source;
  [[nodiscard]] auto mapping_of(const std::string& wanted) const -> const ColumnMapping*;
  /// Throws BadInput if the log has no such column.
  [[nodiscard]] auto source_of(const std::string& wanted) const -> Source;
  [[nodiscard]] auto missing(const std::string& wanted, const std::string& source) const -> std::string;
  [[nodiscard]] auto cells(std::size_t index, bool gaps) const -> Eigen::VectorXd;
  [[nodiscard]] auto values(const std::string& wanted, bool gaps) const -> Eigen::VectorXd;
  [[nodiscard]] auto clock_column() const -> std::optional<Eigen::VectorXd>;

  std::string name_, text_;
  std::vector<ColumnMapping> mappings_;
  std::vector<std::string> names_;
  std::vector<Line> lines_;
  std::vector<std::string> warnings_;
  std::map<std::string, Eigen::VectorXd> replaced_;  // columns that are not the file's any more
};

/// Twelve decimals: steps of 2^-24, the firmware's, read back exactly once they are rounded to such steps.
auto log_number(double value) -> std::string;

}  // namespace capstan::tools
