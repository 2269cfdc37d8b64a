// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// What is wrong with an expression. The message has neither the expression nor the cure.
class BadExpression : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A column's name in an expression: between ' ' where it is no word.
auto as_operand(const std::string& name) -> std::string;

/// Arithmetic on the columns of a log: "0.5*(left + right)", "deg(elbow [deg])", "(a - b)*0.0369".
/// Numbers, column names, + - * / ^ ( ), deg(x) (degrees to radians), rad(x) (radians to degrees), sin, cos, abs, sqrt,
/// sign; the constants pi and deg (radians per degree). A column's name is taken as long as it goes, whatever
/// characters are in it; one that could be something else is put between ' '.
class ColumnExpression {
 public:
  /// @param names  columns of the log
  /// Throws BadExpression.
  ColumnExpression(std::string_view text, const std::vector<std::string>& names);

  /// Indices of the columns used, each once.
  [[nodiscard]] auto columns() const -> const std::vector<std::size_t>& { return columns_; }
  /// @param values  of each of columns(), equally long
  /// Row by row; what can not be worked out is NaN. Throws BadExpression if the library refuses.
  [[nodiscard]] auto evaluate(const std::vector<Eigen::VectorXd>& values) const -> Eigen::VectorXd;

 private:
  // Each adds what the text begins with to the program; the latter return its length.
  void take_name(std::size_t index);
  auto take_quoted(std::string_view left, const std::vector<std::string>& names) -> std::size_t;
  auto take_number(std::string_view left, std::size_t length) -> std::size_t;
  auto take_word(std::string_view left) -> std::size_t;

  std::vector<std::size_t> columns_;
  std::string program_;  // with v0, v1, ... for the columns
};

}  // namespace capstan::tools
