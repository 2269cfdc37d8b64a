// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/effort_file.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/support/toml_text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kEffortFamily = "effort";
constexpr const char* kGearFamily = "gear";

/// How a value is written.
auto form_of(const std::string& key, const std::string& unit) -> std::string {
  std::string form = key;
  form += " = { value = ..., unit = \"";
  form += unit;
  form += "\" }";
  return form;
}

/// Reads tables and turns every surprise into a sentence with file and line.
class EffortReader {
 public:
  explicit EffortReader(const std::string& name) : name_(name) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& sentence) const {
    throw BadInput(place(name_, static_cast<std::size_t>(node.source().begin.line)) + sentence);
  }

  [[nodiscard]] auto table(const toml::table& parent, const std::string& key) const -> const toml::table& {
    const toml::node* node = parent.get(key);
    if (node == nullptr || node->as_table() == nullptr) {
      fail(node == nullptr ? static_cast<const toml::node&>(parent) : *node,
           "[" + key + "] is missing; write the file again with capstan diagnose -o");
    }
    return *node->as_table();
  }

  /// The value of key = { value = ..., unit = "..." }.
  [[nodiscard]] auto value(const toml::table& parent, const std::string& key, const std::string& unit) const -> double {
    const toml::node* node = parent.get(key);
    const std::string form = form_of(key, unit);
    const toml::table* entry = node == nullptr ? nullptr : node->as_table();
    if (entry == nullptr) {
      fail(node == nullptr ? static_cast<const toml::node&>(parent) : *node, key + " is missing; write " + form);
    }
    if ((*entry)["unit"].value<std::string>() != unit) {
      fail(*entry, key + " must be given in \"" + unit + "\"; convert the value and write " + form);
    }
    const auto number = (*entry)["value"].value<double>();
    if (!number || !std::isfinite(*number)) {
      fail(*entry, key + " has no finite value; write " + form);
    }
    return *number;
  }

  [[nodiscard]] auto word(const toml::table& parent, const std::string& key) const -> std::string {
    const auto text = parent[key].value<std::string>();
    if (!text) {
      std::string sentence = key;
      sentence += " is missing; write it as text in quotes";
      fail(parent, sentence);
    }
    return as_written(*text);
  }

 private:
  const std::string& name_;
};

void read_terms(const EffortReader& reader, const toml::table& root, JointFile& joint) {
  const toml::table& all = reader.table(root, "terms");
  for (const auto& [key, node] : all) {
    if (!joint.catalogue->has(std::string(key.str()))) {
      reader.fail(node, "there is no term " + std::string(key.str()) + " of an effort; take it out, or check its name");
    }
  }
  for (const auto& term : *joint.catalogue) {
    if (!all.contains(term.name)) {
      continue;
    }
    const toml::table& entry = reader.table(all, term.name);
    joint.terms.push_back(term.name);
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      joint.parameters.coefficients[term.first_coefficient + i] =
          reader.value(entry, term.coefficients[i].name, term.coefficients[i].unit);
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      joint.parameters.shapes[term.first_shape + i] = reader.value(entry, term.shapes[i].name, term.shapes[i].unit);
    }
  }
}

auto catalogue_for(const EffortReader& reader, const toml::table& law) -> const Catalogue& {
  const std::string family = reader.word(law, "family");
  if (family != kEffortFamily && family != kGearFamily) {
    reader.fail(law, family + " is no family of laws; write effort or gear");
  }
  const auto speed = law["standstill"]["unit"].value<std::string>();  // the target may be a mapped column of any name
  const bool linear = reader.word(law, "target").ends_with("_N") || speed == "m/s";
  return family == kGearFamily ? gear_law_catalogue()
                               : effort_law_catalogue(linear ? AxisKind::kLinear : AxisKind::kRotary);
}

auto parse_table(const toml::table& root, const std::string& name) -> EffortLaw {
  const EffortReader reader(name);
  if (root["schema"].value<std::string>() != kEffortSchema) {
    throw BadInput(place(name, 1) + "the schema is not capstan.effort/1; write schema = \"capstan.effort/1\" or make " +
                   "the file with capstan diagnose -o");
  }
  const toml::table& table = reader.table(root, "law");
  EffortLaw law;
  law.joint = JointFile(catalogue_for(reader, table));
  law.target = reader.word(table, "target");
  law.status = reader.word(table, "status");
  const std::string motion = law.joint.catalogue->motion_unit();
  law.view.window_s = reader.value(table, "window", "s");
  law.view.standstill = reader.value(table, "standstill", motion + "/s");
  law.view.skew_s = reader.value(table, "skew", "s");
  law.view.letting_go_s = table.contains("letting_go") ? reader.value(table, "letting_go", "s") : 0.0;
  law.view.averaged = !law.of_gear();
  constexpr double kLongestS = 1.0;
  if (law.view.window_s <= 0.0 || law.view.window_s > kLongestS || std::abs(law.view.skew_s) > kLongestS ||
      law.view.letting_go_s < 0.0 || law.view.letting_go_s > kLongestS) {
    reader.fail(table,
                "window, skew and letting_go must be within a second, the window above nothing and letting_go not "
                "below; check their units");
  }
  read_terms(reader, root, law.joint);
  return law;
}

auto quantity(const std::string& key, double value, const std::string& unit) -> std::string {
  return key + " = { value = " + exact(value) + ", unit = \"" + unit + "\" }\n";
}

}  // namespace

auto effort_file_text(const EffortLaw& law) -> std::string {
  return joint_file_text(law.joint) +
         "\n# What it takes to run the law over a log. window: of the cubic that motion is taken from, and through "
         "which\n# law and effort are compared. standstill: speed below which the direction stays what it was. skew: "
         "how "
         "much\n# later than logged the motor's torque acts. letting_go: time constant with which dry friction lets go "
         "at a\n# standstill; 0: it holds.\n[law]\nfamily = \"" +
         (law.of_gear() ? kGearFamily : kEffortFamily) + "\"\ntarget = " + quoted(law.target) + "\nstatus = \"" +
         law.status + "\"\n" + quantity("window", law.view.window_s, "s") +
         quantity("standstill", law.view.standstill, law.joint.catalogue->motion_unit() + "/s") +
         quantity("skew", law.view.skew_s, "s") + quantity("letting_go", law.view.letting_go_s, "s");
}

void write_effort_file(const std::string& path, const EffortLaw& law) {
  write_text_file(path, effort_file_text(law));
}

auto parse_effort_file(const std::string& text, const std::string& name) -> EffortLaw {
  return read_toml(text, name, "repair the line or write the file again with capstan diagnose",
                   [&name](const toml::table& root) { return parse_table(root, name); });
}

auto read_effort_file(const std::string& path) -> EffortLaw {
  return parse_effort_file(read_text_file(path), path);
}

auto is_effort_file(const std::string& path) -> bool {
  return read_text_file(path).find(kEffortSchema) != std::string::npos;
}

}  // namespace capstan::tools
