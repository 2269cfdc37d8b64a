// SPDX-License-Identifier: Apache-2.0
// The library asserts what a person can type ("[$x]"); without that its own error says so.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

// The library's tables of letters run into undefined behaviour outside ASCII (3.3.0, found by fuzzing), so such letters
// pass it as
// "~x" and two hexadecimal digits for each byte.
constexpr std::string_view kDigits = "0123456789ABCDEF";

auto to_ascii(const std::string& text) -> std::string {
  std::string ascii;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte > 0x7F || c == '~') {
      ascii += {'~', 'x', kDigits[byte >> 4U], kDigits[byte & 0xFU]};
    } else {
      ascii += c;
    }
  }
  return ascii;
}

auto from_ascii(const std::string& ascii) -> std::string {
  std::string text;
  for (std::size_t i = 0; i < ascii.size(); ++i) {
    const std::size_t high = i + 3 < ascii.size() ? kDigits.find(ascii[i + 2]) : std::string_view::npos;
    const std::size_t low = i + 3 < ascii.size() ? kDigits.find(ascii[i + 3]) : std::string_view::npos;
    if (ascii.compare(i, 2, "~x") == 0 && high != std::string_view::npos && low != std::string_view::npos) {
      text += static_cast<char>(static_cast<unsigned char>(high * kDigits.size() + low));
      i += 3;
    } else {
      text += ascii[i];
    }
  }
  return text;
}

/// Ends of the firmware's numbers; the largest value is one step below 128.
constexpr double kLargest = 127.999999;
/// Below this ratio the law could not be turned round for the feedforward within the range of numbers.
constexpr double kSmallestBeta = 0.01;

struct Limits {
  double low = -kLargest;
  double high = kLargest;
};

/// Walks the file and turns every surprise into a sentence with file and line.
class Reader {
 public:
  explicit Reader(std::string name) : name_(std::move(name)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& sentence) const {
    throw BadInput(place(name_, static_cast<std::size_t>(node.source().begin.line)) + sentence);
  }

  auto table(const toml::table& parent, const std::string& key) const -> const toml::table* {
    const toml::node* node = parent.get(key);
    if (node != nullptr && node->as_table() == nullptr) {
      fail(*node, key + " is not a table; write [" + key + "]");
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
  auto quantity(const toml::table& parent, const std::string& key, const std::string& unit, const Limits& limits,
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
      fail(*node, key + " = " + rounded(value, 6) + " " + unit + " is out of range; it must be from " +
                      rounded(limits.low, 6) + " to " + rounded(limits.high, 6));
    }
    if (ci95 != nullptr && entry->get("ci95") != nullptr) {
      *ci95 = interval(*entry->get("ci95"), "ci95 of " + key);
    }
    return value;
  }

  void terms(const toml::table& root, JointFile& joint) const {
    std::vector<std::string> known;
    for (const auto& term : term_catalogue()) {
      known.push_back(term.name);
    }
    const toml::table* all = table(root, "terms");
    if (all == nullptr || all->get("motor_angle") == nullptr) {
      fail(all == nullptr ? static_cast<const toml::node&>(root) : *all,
           "the law has no ratio; write [terms.motor_angle] with beta = { value = ..., unit = \"1\" }");
    }
    only(*all, known, "[terms]");
    for (const auto& term : term_catalogue()) {
      if (const toml::table* entry = table(*all, term.name)) {
        joint.terms.push_back(term.name);
        read_term(*entry, term, joint);
      }
    }
    const double beta = joint.parameters.coefficients[catalogue_term("motor_angle").first_coefficient];
    if (std::abs(beta) < kSmallestBeta) {
      fail(*all->get("motor_angle"), "beta = " + rounded(beta) + " is too near zero for the law to be turned round; " +
                                         "check the fit, the joint hardly moved");
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
      if (std::abs(values.back()) > kLargest) {
        fail(entry, rounded(values.back(), 6) + " in " + key + " is out of range; it must be from " +
                        rounded(-kLargest, 6) + " to " + rounded(kLargest, 6));
      }
    }
    return values;
  }

  void read_table(const toml::table& entry, JointFile& joint) const {
    only(entry, {"signal", "knots", "forward", "backward"}, "[terms.table]");
    const auto& words = table_signal_words();
    const auto word = entry["signal"].value<std::string>();
    const auto found = std::find(words.begin(), words.end(), word.value_or(""));
    if (found == words.end()) {
      fail(entry, "the table's signal is none that there is; write one of " + joined(words));
    }
    const TableLists lists{static_cast<std::size_t>(found - words.begin()), numbers(entry, "knots"),
                           numbers(entry, "forward"), numbers(entry, "backward")};
    if (const std::string fault = fault_of(lists); !fault.empty()) {
      fail(entry, fault);
    }
    set_table(lists, joint);
  }

  void read_term(const toml::table& entry, const CatalogueTerm& term, JointFile& joint) const {
    if (term.name == kTableTerm) {
      return read_table(entry, joint);
    }
    std::vector<std::string> known;
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const auto& info = term.coefficients[i];
      known.emplace_back(info.name);
      const Limits limits{info.sign == Sign::kNonNegative ? 0.0 : -kLargest,
                          info.sign == Sign::kNonPositive ? 0.0 : kLargest};
      const std::size_t at = term.first_coefficient + i;
      joint.parameters.coefficients[at] = quantity(entry, info.name, info.unit, limits, &joint.coefficient_ci95[at]);
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const auto& info = term.shapes[i];
      known.emplace_back(info.name);
      const std::size_t at = term.first_shape + i;
      if (info.idle_without >= 0 && entry.get(info.name) == nullptr) {
        continue;  // one of several alike, of which the law has fewer
      }
      joint.parameters.shapes[at] =
          quantity(entry, info.name, info.unit, {info.minimum, info.maximum}, &joint.shape_ci95[at]);
    }
    only(entry, known, "[terms." + term.name + "]");
  }

  std::string name_;
};

void read_conditioner(const Reader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* table = reader.table(root, "conditioner");
  if (table == nullptr) {
    reader.fail(root, "[conditioner] is missing; write it with direction_threshold and rate_time_constant");
  }
  reader.only(*table, {"direction_threshold", "rate_time_constant"}, "[conditioner]");
  auto& conditioner = joint.parameters.conditioner;
  conditioner.direction_threshold_rad = reader.quantity(*table, "direction_threshold", "rad", {0.0, 1.0});
  conditioner.rate_time_constant_s = reader.quantity(*table, "rate_time_constant", "s", {0.0, 1.0});
}

void read_steady_torque(const Reader& reader, const toml::table& root, JointFile& joint) {
  if (const toml::table* table = reader.table(root, "feedforward")) {
    reader.only(*table, {"torque_forward", "torque_backward"}, "[feedforward]");
    joint.steady_torque = SteadyTorque{reader.quantity(*table, "torque_forward", "Nm", {}),
                                       reader.quantity(*table, "torque_backward", "Nm", {})};
  }
}

void read_coupling(const Reader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* table = reader.table(root, "coupling");
  if (table == nullptr) {
    return;
  }
  reader.only(*table, {"joint", "joints"}, "[coupling]");
  std::vector<const toml::node*> nodes;
  if (const toml::array* several = (*table)["joints"].as_array()) {
    for (const auto& node : *several) {
      nodes.push_back(&node);
    }
  } else {
    nodes.push_back(table->get("joint"));
  }
  constexpr double kLastAxis = 15.0;
  for (const toml::node* node : nodes) {
    const double number = node != nullptr ? reader.number(*node, "the axis in [coupling]") : -1.0;
    const bool twice = std::find(joint.coupled_to.begin(), joint.coupled_to.end(), number) != joint.coupled_to.end();
    if (number < 0.0 || number > kLastAxis || number != std::floor(number) || twice ||
        joint.coupled_to.size() == kMostOthers) {
      reader.fail(*table,
                  "[coupling] does not name axes; write joint = N, or joints = [N, M] for up to three different ones, "
                  "those whose motors pull");
    }
    joint.coupled_to.push_back(static_cast<int>(number));
  }
}

/// Every slot that a term reads has its axis.
void check_coupling(const Reader& reader, const toml::table& root, const JointFile& joint) {
  const std::size_t used = slots_used(joint);
  if (used > joint.coupled_to.size() && used > 1) {
    reader.fail(root, "the law reads " + std::to_string(used) + " coupled axes and [coupling] names " +
                          std::to_string(joint.coupled_to.size()) + "; write joints = [...] with all of them");
  }
}

void read_status(const Reader& reader, const toml::table& root, JointFile& joint) {
  const toml::node* node = root.get("status");
  if (node == nullptr) {
    return;  // written before there was one, by a fit of a model that was asked for
  }
  for (const auto status : {LawStatus::kConfirmed, LawStatus::kProvisional, LawStatus::kBase}) {
    if (node->value<std::string>() == word_of(status)) {
      joint.status = status;
      return;
    }
  }
  reader.fail(*node, "the status is none that there is; write \"confirmed\", \"provisional\" or \"base\"");
}

/// "capstan.joint/2" and beyond: what this version can not know.
auto is_newer(const std::optional<std::string>& schema) -> bool {
  const std::string stem = "capstan.joint/";
  return schema && schema->starts_with(stem) && *schema != kJointSchema &&
         schema->find_first_not_of("0123456789", stem.size()) == std::string::npos && schema->size() > stem.size();
}

auto torque_of(const Reader& reader, const toml::table& table) -> TorqueParts {
  reader.only(table, {TorqueParts::kNames.begin(), TorqueParts::kNames.end()}, "[fit.torque]");
  TorqueParts parts;
  for (std::size_t i = 0; i < TorqueParts::kCount; ++i) {
    parts.values[i] = reader.quantity(table, TorqueParts::kNames[i], TorqueParts::kUnits[i], {-kLargest, kLargest});
  }
  return parts;
}

void read_fit(const Reader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* table = reader.table(root, "fit");
  if (table == nullptr) {
    return;
  }
  reader.only(*table,
              {"rmse", "gof_percent", "samples", "motor_range", "joint_range", "loop_half_width", "loop_torque", "logs",
               "torque"},
              "[fit]");
  FitSummary fit;
  fit.rmse = reader.quantity(*table, "rmse", "rad", {0.0, kLargest});
  const auto number = [&](const char* key) {
    return table->contains(key) ? reader.number(*table->get(key), key) : 0.0;
  };
  fit.gof_percent = number("gof_percent");
  fit.samples = std::lround(number("samples"));
  fit.joint_range = number("joint_range");
  if (const auto* range = table->get("motor_range")) {
    fit.motor_range = reader.interval(*range, "motor_range");
  }
  const auto if_there = [&](const char* key, const char* unit) {
    return table->contains(key) ? std::optional(reader.quantity(*table, key, unit, {0.0, kLargest})) : std::nullopt;
  };
  fit.loop_half_width = if_there("loop_half_width", "rad");
  fit.loop_torque = if_there("loop_torque", "Nm");
  if (const toml::table* torque = reader.table(*table, "torque")) {
    fit.torque = torque_of(reader, *torque);
  }
  if (const auto* logs = table->get("logs"); logs != nullptr && logs->as_array() != nullptr) {
    for (const auto& log : *logs->as_array()) {
      fit.logs.push_back(from_ascii(log.value_or(std::string{})));
    }
  }
  joint.fit = fit;
}

/// TOML allows no control characters, and the library relies on it.
void require_text(const std::string& text, const std::string& name) {
  const auto bad = std::find_if(text.begin(), text.end(), [](char c) {
    return (c >= 0 && c < ' ' && c != '\t' && c != '\n' && c != '\r') || c == '\x7F';
  });
  if (bad != text.end()) {
    const auto line = static_cast<std::size_t>(std::count(text.begin(), bad, '\n')) + 1;
    throw BadInput(place(name, line) +
                   "there are bytes that are no text; give a joint.toml, or write it anew with "
                   "capstan identify");
  }
}

/// @param text  as to_ascii gives it
auto parse_ascii(const std::string& text, const std::string& name) -> JointFile {
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw BadInput(place(name, static_cast<std::size_t>(error.source().begin.line)) + "this is not TOML: " +
                   std::string(error.description()) + "; repair the line or write the file anew with capstan identify");
  }
  const Reader reader(name);
  const auto schema = root["schema"].value<std::string>();
  if (schema == kEffortSchema) {
    throw BadInput(place(name, 1) +
                   "this is a law of an effort, and one of the joint angle is wanted here; make it with " +
                   "capstan identify --model pseudo_kinematic");
  }
  if (is_newer(schema)) {
    throw BadInput(place(name, 1) + "the law is of a newer version, " + *schema + ", and this program reads " +
                   kJointSchema + "; update capstan, or write the file anew with this version");
  }
  if (schema != kJointSchema) {
    throw BadInput(place(name, 1) +
                   "the schema is not capstan.joint/1; write schema = \"capstan.joint/1\" or make the file " +
                   "with capstan identify");
  }
  reader.only(root, {"schema", "status", "conditioner", "terms", "feedforward", "coupling", "fit", "force"},
              "the file");
  JointFile joint;
  read_conditioner(reader, root, joint);
  reader.terms(root, joint);
  read_steady_torque(reader, root, joint);
  read_coupling(reader, root, joint);
  check_coupling(reader, root, joint);
  read_status(reader, root, joint);
  read_fit(reader, root, joint);
  return joint;
}

}  // namespace

auto parse_joint_file(const std::string& text, const std::string& name) -> JointFile {
  require_text(text, name);
  try {
    return parse_ascii(to_ascii(text), name);
  } catch (const BadInput& refusal) {
    throw BadInput(from_ascii(refusal.what()));
  }
}

auto read_joint_file(const std::string& path) -> JointFile {
  return parse_joint_file(read_text_file(path), path);
}

}  // namespace capstan::tools
