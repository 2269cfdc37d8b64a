// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/force_section.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/support/toml_text.hpp"

namespace capstan::tools {
namespace {

auto quantity(const ForceParameter& p) -> std::string {
  return p.name + " = { value = " + exact(p.value) + ", unit = \"" + p.unit + "\", ci95 = [" +
         exact(p.value - p.half_interval) + ", " + exact(p.value + p.half_interval) + "] }\n";
}

auto fit_line(const ForceFit& fit) -> std::string {
  std::string text =
      "rmse = { value = " + exact(fit.rmse_nm) + ", unit = \"Nm\" }\nsamples = " + std::to_string(fit.samples) + "\n";
  if (fit.error_bar) {
    text +=
        "# 95 of 100 times the joint's torque was no further from the law than error_steady, or error_turning up to\n"
        "# error_turn of the motor's torque behind its reversal, with torques up to error_torque.\n";
    for (std::size_t i = 0; i < ForceErrorNumbers::kCount; ++i) {
      text += std::string(ForceErrorNumbers::kNames[i]) + " = { value = " + exact(fit.error_bar->values[i]) +
              ", unit = \"Nm\" }\n";
    }
  }
  return text;
}

auto array_of(const std::vector<double>& values) -> std::string {
  std::vector<std::string> words;
  for (const double value : values) {
    words.push_back(exact(value));
  }
  return "[" + joined(words) + "]";
}

auto parse(const std::string& joint_file, const std::string& name) -> toml::table {
  return parse_toml(joint_file, name, "repair the line or write the file again with capstan identify");
}

auto numbers(const toml::node_view<const toml::node>& node, const std::string& what) -> std::vector<double> {
  std::vector<double> values;
  if (const toml::array* array = node.as_array()) {
    for (const auto& value : *array) {
      values.push_back(value.value<double>().value_or(std::nan("")));
    }
  }
  if (values.empty() || !std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); })) {
    throw BadInput(what + " is not a list of numbers; identify the law again");
  }
  return values;
}

}  // namespace

auto is_of_tendons(const std::string& model) -> bool {
  return model == "pull_push" || model == "blend";
}

auto force_section(const PullPushFit& fit) -> std::string {
  const std::string law = fit.kind == ForceLawKind::kBlend ? "blend (2.27) of pull and pull-push law" : "pull-push law";
  std::string text = "\n# Motor torque to joint torque, tip held: " + law +
                     " (2.17)-(2.21). Pretension is I r1, stiffness r1^2 Kn, "
                     "ratio r2 / r1;\n"
                     "# friction and offset are the motor's, in the logged torque.\n[force]\nmodel = \"" +
                     (fit.kind == ForceLawKind::kBlend ? "blend" : "pull_push") + "\"\n";
  for (const auto& parameter : fit.parameters) {
    text += quantity(parameter);
  }
  return text + fit_line(fit);
}

auto force_section(const PreisachFit& fit) -> std::string {
  std::string text =
      "\n# Motor torque to joint torque, tip held: first-order reversal values f_ab (4.4), Nm, a row per level a, b up "
      "to a, and the half\n"
      "# widths of their 95 % intervals.\n[force]\nmodel = \"preisach\"\n";
  text += "inputs = " + array_of({fit.table.inputs.begin(), fit.table.inputs.begin() + fit.table.levels}) + "\n";
  std::string values;
  std::string halves;
  std::size_t next = 0;
  for (std::size_t row = 0; row < fit.table.levels; ++row) {
    const auto first = static_cast<std::ptrdiff_t>(next);
    next += row + 1;
    const auto last = static_cast<std::ptrdiff_t>(next);
    values += "  " + array_of({fit.table.forces.begin() + first, fit.table.forces.begin() + last}) + ",\n";
    halves += "  " + array_of({fit.half_intervals.begin() + first, fit.half_intervals.begin() + last}) + ",\n";
  }
  return text + "forces = [\n" + values + "]\nci95_half = [\n" + halves + "]\n" + fit_line(fit);
}

auto force_model(const std::string& joint_file, const std::string& name) -> std::string {
  return parse(joint_file, name)["force"]["model"].value<std::string>().value_or("");
}

auto is_force_alone(const std::string& joint_file, const std::string& name) -> bool {
  const toml::table file = parse(joint_file, name);
  return file.contains("force") && !file.contains("terms");
}

auto read_pull_push(const std::string& joint_file, const std::string& name) -> PullPushFit {
  constexpr std::array kWritten = {"eta_top",  "eta_bottom", "pretension",    "ratio",
                                   "friction", "offset",     "stiffness_top", "stiffness_bottom"};
  constexpr std::array kWeights = {"pull_weight", "pull_push_weight"};
  const toml::table file = parse(joint_file, name);
  const auto section = file["force"];
  const std::string model = section["model"].value<std::string>().value_or("");
  if (!is_of_tendons(model)) {
    throw BadInput(name +
                   ": there is no pull-push law in it; record torque triangles with the tip locked and add it by "
                   "'capstan identify LOG --model pull_push -o " +
                   name + "'");
  }
  PullPushFit fit;
  fit.cure = "identify it again";
  const auto read = [&](const char* parameter) {
    const auto value = section[parameter]["value"].value<double>();
    if (!value || !std::isfinite(*value)) {
      throw BadInput(name + ": [force] has no number for " + parameter + "; write it as " + parameter +
                     " = { value = 1.0, unit = ... }, or identify the law again");
    }
    const auto above = section[parameter]["ci95"][1].value<double>();
    fit.parameters.push_back({parameter, section[parameter]["unit"].value<std::string>().value_or("1"), *value,
                              above ? *above - *value : 0.0});
  };
  std::for_each(kWritten.begin(), kWritten.end(), read);
  const auto value_of = [&fit](std::size_t i) { return fit.parameters[i].value; };
  fit.law = {.eta_top = value_of(0), .eta_bottom = value_of(1), .pretension_nm = value_of(2), .ratio = value_of(3)};
  fit.friction_nm = value_of(4);
  fit.offset_nm = value_of(5);
  if (model == "blend") {
    fit.kind = ForceLawKind::kBlend;
    std::for_each(kWeights.begin(), kWeights.end(), read);
    fit.law.pull_weight = value_of(kWritten.size());
    fit.law.pull_push_weight = value_of(kWritten.size() + 1);
  }
  return fit;
}

auto read_force_fit(const std::string& joint_file, const std::string& name) -> ForceFit {
  ForceFit fit;
  if (is_of_tendons(force_model(joint_file, name))) {
    fit = read_pull_push(joint_file, name);
  } else {
    const PreisachTable table = read_preisach(joint_file, name);
    const toml::table file = parse(joint_file, name);
    const auto halves = file["force"]["ci95_half"];
    const std::size_t last = table.levels - 1;
    fit.parameters = ends_of(table, halves[0][0].value_or(0.0), halves[last][last].value_or(0.0));
  }
  const toml::table file = parse(joint_file, name);
  fit.rmse_nm = file["force"]["rmse"]["value"].value_or(0.0);
  fit.samples = file["force"]["samples"].value_or(0L);
  return fit;
}

auto read_preisach(const std::string& joint_file, const std::string& name) -> PreisachTable {
  const toml::table file = parse(joint_file, name);
  const auto inputs = numbers(file["force"]["inputs"], name + ": [force] inputs");
  PreisachTable table;
  const toml::array* rows = file["force"]["forces"].as_array();
  if (inputs.size() < 2 || inputs.size() > kMostPreisachLevels || rows == nullptr || rows->size() != inputs.size()) {
    throw BadInput(name + ": [force] has not the same 2 to " + std::to_string(kMostPreisachLevels) +
                   " levels in inputs and forces; identify the law again");
  }
  table.levels = static_cast<std::uint32_t>(inputs.size());
  for (std::size_t row = 0; row < inputs.size(); ++row) {
    const auto values = numbers(file["force"]["forces"][row], name + ": row " + std::to_string(row) + " of forces");
    if (values.size() != row + 1) {
      throw BadInput(name + ": row " + std::to_string(row) + " of forces has not " + std::to_string(row + 1) +
                     " values; identify the law again");
    }
    table.inputs[row] = inputs[row];
    for (std::size_t column = 0; column <= row; ++column) {
      table.set_force(row, column, values[column]);
    }
  }
  if (const TableCheck problem = check(table, 1e-9); !problem.ok()) {
    throw BadInput(name + ": [force] row " + std::to_string(problem.row) + ", column " +
                   std::to_string(problem.column) + ": " + describe(problem.fault));
  }
  return table;
}

auto read_force_error(const std::string& joint_file, const std::string& name) -> std::optional<ForceErrorNumbers> {
  const toml::table file = parse(joint_file, name);
  ForceErrorNumbers numbers;
  for (std::size_t i = 0; i < ForceErrorNumbers::kCount; ++i) {
    const auto value = file["force"][ForceErrorNumbers::kNames[i]]["value"].value<double>();
    if (!value) {
      return std::nullopt;  // a file of an older version
    }
    if (!std::isfinite(*value) || *value < 0.0) {
      throw BadInput(name + ": [force] " + ForceErrorNumbers::kNames[i] +
                     " is no number of 0 or more; identify the law again");
    }
    numbers.values[i] = *value;
  }
  return numbers;
}

auto with_force_section(const std::string& joint_file, const std::string& section) -> std::string {
  if (joint_file.empty()) {
    return "schema = \"capstan.joint/1\"\n" + section;
  }
  std::istringstream lines(joint_file);
  std::string kept;
  std::string comments;  // they belong to what follows
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const auto text = trimmed(line);
    if (text.empty() || text.front() == '#') {
      comments += line + "\n";
      continue;
    }
    if (text.front() == '[' && text.back() == ']' && text.find('=') == std::string_view::npos &&
        text.find(',') == std::string_view::npos) {
      inside = text.substr(0, 6) == "[force";
    }
    kept += inside ? "" : comments + line + "\n";
    comments.clear();
  }
  return kept + section;
}

}  // namespace capstan::tools
