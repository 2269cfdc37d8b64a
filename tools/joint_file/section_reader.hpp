// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/support/toml_text.hpp"

namespace capstan::tools {

struct NumberLimits {
  double low = -kLargestNumber;
  double high = kLargestNumber;
};
inline constexpr NumberLimits kAnyNumber{-std::numeric_limits<double>::infinity(),
                                         std::numeric_limits<double>::infinity()};

/// Walks the file and turns every surprise into a sentence with file and line.
class SectionReader {
 public:
  explicit SectionReader(std::string name) : name_(std::move(name)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& sentence) const {
    throw BadInput(place(name_, static_cast<std::size_t>(node.source().begin.line)) + sentence);
  }

  /// @param within  the parent's own name and a dot, where it has one
  auto table(const toml::table& parent, const std::string& key, const std::string& within = "") const
      -> const toml::table* {
    const toml::node* node = parent.get(key);
    if (node != nullptr && node->as_table() == nullptr) {
      fail(*node, within + key + " is not a table; write [" + within + key + "]");
    }
    return node == nullptr ? nullptr : node->as_table();
  }

  void only(const toml::table& table, const std::vector<std::string>& known, const std::string& where) const {
    for (const auto& [key, node] : table) {
      if (std::find(known.begin(), known.end(), key.str()) == known.end()) {
        throw BadInput(place(name_, static_cast<std::size_t>(key.source().begin.line)) + "unknown key " +
                       std::string(key.str()) + " in " + where + "; known are " + joined(known));
      }
    }
  }

  auto number(const toml::node& node, const std::string& what) const -> double {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) {
      fail(node, what + " is not a finite number; write one, for instance 1.08");
    }
    return *value;
  }

  /// { value = 1.08, unit = "1", ci95 = [1.07, 1.09] }
  auto quantity(const toml::table& parent, const std::string& key, const std::string& unit, const NumberLimits& limits,
                std::optional<Interval>* ci95 = nullptr) const -> double {
    const toml::node* node = parent.get(key);
    const std::string form = key + " = { value = ..., unit = \"" + unit + "\" }";
    if (node == nullptr) {
      fail(parent, key + " is missing; write " + form);
    }
    const toml::table* entry = node->as_table();
    if (entry == nullptr) {
      fail(*node, key + " has no unit; write " + form);
    }
    only(*entry, {"value", "unit", "ci95"}, key);
    const auto* given_unit = entry->get("unit");
    if (given_unit == nullptr || given_unit->value<std::string>() != unit) {
      fail(*node, key + " must be given in \"" + unit + "\"; convert the value and write " + form);
    }
    if (entry->get("value") == nullptr) {
      fail(*node, key + " has no value; write " + form);
    }
    const double value = number(*entry->get("value"), key);
    if (value < limits.low || value > limits.high) {
      fail(*node, key + " = " + rounded(value, 6) + (unit == "1" ? "" : " " + unit) +
                      " is out of range; it must be from " + rounded(limits.low, 6) + " to " + rounded(limits.high, 6));
    }
    if (ci95 != nullptr && entry->get("ci95") != nullptr) {
      *ci95 = interval(*entry->get("ci95"), "ci95 of " + key);
    }
    return value;
  }

  /// [terms], those of the joint's catalogue. Numbers of an angle's law have to fit into a board and the terms' ranges.
  void terms(const toml::table& all, JointFile& joint) const {
    std::vector<std::string> known;
    for (const auto& term : *joint.catalogue) {
      known.push_back(term.name);
    }
    only(all, known, "[terms]");
    for (const auto& term : *joint.catalogue) {
      if (const toml::table* entry = table(all, term.name, "terms.")) {
        joint.terms.push_back(term.name);
        read_term(*entry, term, joint);
      }
    }
  }

  auto interval(const toml::node& node, const std::string& key) const -> Interval {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 2) {
      fail(node, key + " is not a pair; write [low, high] or leave it out");
    }
    const Interval result = {number(*array->get(0), key), number(*array->get(1), key)};
    if (result[0] > result[1]) {
      fail(node, key + " runs from high to low; swap its ends");
    }
    return result;
  }

  [[nodiscard]] auto name() const -> const std::string& { return name_; }

 private:
  auto numbers(const toml::table& parent, const std::string& key) const -> std::vector<double> {
    const toml::node* node = parent.get(key);
    const toml::array* array = node == nullptr ? nullptr : node->as_array();
    if (array == nullptr) {
      fail(node == nullptr ? static_cast<const toml::node&>(parent) : *node,
           key + " is not a list of numbers; write " + key + " = [-1, 0, 1]");
    }
    std::vector<double> values;
    for (const auto& entry : *array) {
      values.push_back(number(entry, key));
      if (std::abs(values.back()) > kLargestNumber) {
        fail(entry, rounded(values.back(), 6) + " in " + key + " is out of range; it must be from " +
                        rounded(-kLargestNumber, 6) + " to " + rounded(kLargestNumber, 6));
      }
    }
    return values;
  }

  /// Place of a word among those that there are.
  auto choice(const toml::table& entry, const std::string& key, const std::vector<std::string>& words) const
      -> std::size_t {
    const auto word = entry[key].value<std::string>();
    const auto found = std::find(words.begin(), words.end(), word.value_or(""));
    if (found == words.end()) {
      fail(entry, "the table's " + key + " is none that there is; write one of " + joined(words));
    }
    return static_cast<std::size_t>(found - words.begin());
  }

  void read_table(const toml::table& entry, JointFile& joint) const {
    only(entry, {"signal", "knots", "forward", "backward", "factor"}, "[terms.table]");
    const std::size_t factor = entry.contains("factor") ? choice(entry, "factor", table_factor_words()) : 0;
    const TableLists lists{choice(entry, "signal", table_signal_words()), numbers(entry, "knots"),
                           numbers(entry, "forward"), numbers(entry, "backward"), factor};
    if (const std::string fault = fault_of(lists); !fault.empty()) {
      fail(entry, fault);
    }
    set_table(lists, joint);
  }

  void read_term(const toml::table& entry, const CatalogueTerm& term, JointFile& joint) const {
    if (term.name == kTableTerm) {
      return read_table(entry, joint);
    }
    const bool bounded = joint.catalogue->target() == TargetKind::kAngle;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const auto& info = term.coefficients[i];
      known.emplace_back(info.name);
      const NumberLimits limits{info.sign == Sign::kNonNegative ? 0.0 : -kLargestNumber,
                                info.sign == Sign::kNonPositive ? 0.0 : kLargestNumber};
      const std::size_t at = term.first_coefficient + i;
      joint.parameters.coefficients[at] =
          quantity(entry, info.name, info.unit, bounded ? limits : kAnyNumber, &joint.coefficient_ci95[at]);
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const auto& info = term.shapes[i];
      known.emplace_back(info.name);
      const std::size_t at = term.first_shape + i;
      if (info.idle_without >= 0 && entry.get(info.name) == nullptr) {
        continue;  // one of several alike, of which the law has fewer
      }
      const NumberLimits limits{info.minimum, info.maximum};
      joint.parameters.shapes[at] =
          quantity(entry, info.name, info.unit, bounded ? limits : kAnyNumber, &joint.shape_ci95[at]);
    }
    only(entry, known, "[terms." + term.name + "]");
  }

  std::string name_;
};

}  // namespace capstan::tools
