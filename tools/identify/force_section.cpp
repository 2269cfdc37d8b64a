// SPDX-License-Identifier: Apache-2.0
#include "tools/identify/force_section.hpp"

#include <cmath>
#include <sstream>

#include "tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto quantity(const ForceParameter& p) -> std::string {
  return p.name + " = { value = " + exact(p.value) + ", unit = \"" + p.unit + "\", ci95 = [" +
         exact(p.value - p.half_interval) + ", " + exact(p.value + p.half_interval) + "] }\n";
}

auto fit_line(const ForceFit& fit) -> std::string {
  return "rmse = { value = " + exact(fit.rmse_nm) + ", unit = \"Nm\" }\nsamples = " + std::to_string(fit.samples) +
         "\n";
}

auto array_of(const std::vector<double>& values) -> std::string {
  std::vector<std::string> words;
  for (const double value : values) {
    words.push_back(exact(value));
  }
  return "[" + joined(words) + "]";
}

}  // namespace

auto force_section(const PullPushFit& fit) -> std::string {
  std::string text =
      "\n# Motor torque to joint torque, tip held: pull-push law (2.17)-(2.21). Pretension is I r1, stiffness r1^2 Kn, "
      "ratio r2 / r1;\n"
      "# friction and offset are the motor's, in the logged torque.\n[force]\nmodel = \"pull_push\"\n";
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
  text += "inputs = " + array_of({fit.table.inputs.begin(), fit.table.inputs.end()}) + "\n";
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
