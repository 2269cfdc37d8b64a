// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/column_expression.hpp"

#include <muParser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Longer than any that somebody types; keeps what the library has to nest small.
constexpr std::size_t kLongestExpression = 1000;
constexpr std::array kFunctions = {"deg", "rad", "sin", "cos", "abs", "sqrt", "sign"};

auto is_word_character(char c) -> bool {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

/// Whether a name at the start of the text ends where a word ends.
auto begins_with_name(std::string_view text, std::string_view name) -> bool {
  return !name.empty() && text.starts_with(name) &&
         (text.size() == name.size() || !is_word_character(name.back()) || !is_word_character(text[name.size()]));
}

/// Whether a name is found without quotes: no number, nor nothing but marks.
auto is_word(const std::string& name) -> bool {
  return std::any_of(name.begin(), name.end(), is_word_character) && !parse_number(name);
}

/// The longest column name that the text begins with.
auto longest_name(std::string_view text, const std::vector<std::string>& names) -> std::optional<std::size_t> {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    if (is_word(name) && begins_with_name(text, name) && (!best || name.size() > names[*best].size())) {
      best = i;
    }
  }
  return best;
}

/// Length of the number that the text begins with.
auto number_length(std::string_view text) -> std::size_t {
  std::size_t end = 0;
  const auto digits = [&] {
    const std::size_t begin = end;
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])) != 0) {
      ++end;
    }
    return end > begin;
  };
  bool any = digits();
  if (end < text.size() && text[end] == '.') {
    ++end;
    any = digits() || any;
  }
  if (!any) {
    return 0;
  }
  const std::size_t mantissa = end;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    end += end + 1 < text.size() && (text[end + 1] == '-' || text[end + 1] == '+') ? 2 : 1;
    end = digits() ? end : mantissa;
  }
  return end;
}

auto word_at(std::string_view text) -> std::string_view {
  const auto end = std::find_if_not(text.begin(), text.end(), is_word_character);
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

/// In the parser's words: a function where a bracket follows, else a constant.
auto translated(std::string_view word, std::string_view behind) -> std::optional<std::string> {
  const bool call = trimmed(behind).starts_with('(');
  const bool known = std::find(kFunctions.begin(), kFunctions.end(), word) != kFunctions.end();
  if (call) {
    return known ? std::optional("f_" + std::string(word)) : std::nullopt;
  }
  if (word == "deg") {
    return exact(std::numbers::pi / 180.0);
  }
  return word == "pi" ? std::optional(exact(std::numbers::pi)) : std::nullopt;
}

void define_functions(mu::Parser& parser) {
  parser.DefineFun("f_deg", [](double x) { return x * std::numbers::pi / 180.0; });
  parser.DefineFun("f_rad", [](double x) { return x * 180.0 / std::numbers::pi; });
  parser.DefineFun("f_sin", [](double x) { return std::sin(x); });
  parser.DefineFun("f_cos", [](double x) { return std::cos(x); });
  parser.DefineFun("f_abs", [](double x) { return std::abs(x); });
  parser.DefineFun("f_sqrt", [](double x) { return std::sqrt(x); });
  parser.DefineFun("f_sign", [](double x) { return static_cast<double>((x > 0.0) - (x < 0.0)); });
}

}  // namespace

auto as_operand(const std::string& name) -> std::string {
  return is_word(name) ? name : "'" + name + "'";
}

void ColumnExpression::take_name(std::size_t index) {
  const auto found = std::find(columns_.begin(), columns_.end(), index);
  program_ += "v" + std::to_string(found - columns_.begin()) + " ";
  if (found == columns_.end()) {
    columns_.push_back(index);
  }
}

auto ColumnExpression::take_quoted(std::string_view left, const std::vector<std::string>& names) -> std::size_t {
  const auto end = left.find('\'', 1);
  const auto name = left.substr(1, end == std::string_view::npos ? end : end - 1);
  const auto found = std::find(names.begin(), names.end(), name);
  if (end == std::string_view::npos || found == names.end()) {
    throw BadExpression("there is no column '" + std::string(name) + "'");
  }
  take_name(static_cast<std::size_t>(found - names.begin()));
  return end + 1;
}

auto ColumnExpression::take_number(std::string_view left, std::size_t length) -> std::size_t {
  const auto number = parse_number(left.substr(0, length));
  if (!number || !std::isfinite(*number) || (length < left.size() && is_word_character(left[length]))) {
    throw BadExpression("'" + std::string(word_at(left)) + "' is neither a number nor a column");
  }
  program_ += std::string(left.substr(0, length)) + " ";
  return length;
}

auto ColumnExpression::take_word(std::string_view left) -> std::size_t {
  const std::string_view word = word_at(left);
  const auto meaning = translated(word, left.substr(word.size()));
  if (word.empty()) {
    throw BadExpression("'" + std::string(1, left.front()) + "' has no meaning here");
  }
  if (!meaning) {
    throw BadExpression("there is no column " + std::string(word));
  }
  program_ += *meaning;
  return word.size();
}

ColumnExpression::ColumnExpression(std::string_view text, const std::vector<std::string>& names) {
  if (text.size() > kLongestExpression) {
    throw BadExpression("it is longer than " + std::to_string(kLongestExpression) + " characters");
  }
  for (std::string_view left = trimmed(text); !left.empty(); left = trimmed(left)) {
    if (left.front() == '\'') {
      left.remove_prefix(take_quoted(left, names));
    } else if (const auto index = longest_name(left, names)) {
      take_name(*index);
      left.remove_prefix(names[*index].size());
    } else if (const std::size_t length = number_length(left); length > 0) {
      left.remove_prefix(take_number(left, length));
    } else if (std::string_view("+-*/^()").find(left.front()) != std::string_view::npos) {
      program_ += left.front();
      left.remove_prefix(1);
    } else {
      left.remove_prefix(take_word(left));
    }
  }
  if (columns_.empty()) {
    throw BadExpression("it names no column");
  }
}

auto ColumnExpression::evaluate(const std::vector<Eigen::VectorXd>& values) const -> Eigen::VectorXd {
  Eigen::VectorXd result(values.front().size());
  std::vector<double> row(values.size());
  try {
    mu::Parser parser;
    parser.ClearFun();
    parser.ClearConst();
    define_functions(parser);
    for (std::size_t i = 0; i < row.size(); ++i) {
      parser.DefineVar("v" + std::to_string(i), &row[i]);
    }
    parser.SetExpr(program_);
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        row[k] = values[k][i];
      }
      result[i] = parser.Eval();
    }
  } catch (const mu::Parser::exception_type& why) {
    throw BadExpression(why.GetCode() == mu::ecUNEXPECTED_EOF || why.GetCode() == mu::ecMISSING_PARENS
                            ? "it ends too early"
                            : "operators, brackets and columns do not fit together");
  }
  return result;
}

}  // namespace capstan::tools
