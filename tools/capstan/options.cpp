// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto table_row(const std::string& name, double value, const std::string& interval, const std::string& unit)
    -> std::string {
  char line[160];
  std::snprintf(line, sizeof(line), "  %-34s %12s  %-26s %s\n", name.c_str(), rounded(value, 6).c_str(),
                interval.c_str(), unit.c_str());
  return line;
}

/// @param otherwise  what it means that there is none
auto interval_text(const std::optional<Interval>& ci95, const char* otherwise) -> std::string {
  return ci95 ? "[" + rounded((*ci95)[0], 5) + ", " + rounded((*ci95)[1], 5) + "]" : otherwise;
}

/// A table in a line: its values are in the file.
auto table_line(const JointFile& joint, const CatalogueTerm& term) -> std::string {
  const double* shapes = &joint.parameters.shapes[term.first_shape];
  return "  " + term.name + "  " + std::to_string(std::lround(shapes[1])) + " knots over " + described_table(shapes) +
         ", from " + rounded(shapes[2]) + " to " + rounded(shapes[3]) + "\n";
}

}  // namespace

void LogOptions::add_to(CLI::App& command, bool many) {
  auto* files_option =
      command.add_option("LOG", files, many ? "log files (CSV) of one joint" : "log file (CSV)")->required();
  if (!many) {
    files_option->expected(1);
  }
  command
      .add_option("--map", maps,
                  "WANTED=COLUMN or \"WANTED=COLUMN*FACTOR\", for logs with other names or units; repeatable")
      ->allow_extra_args(false);
  command.add_option("--axis", axis, "axis to look at")->capture_default_str()->check(CLI::Range(0, 999));
  if (many) {
    command
        .add_option("--coupled-to", coupled_to,
                    "axis of the log that may pull at this one, repeatable; else those that move")
        ->allow_extra_args(false)
        ->check(CLI::Range(0, kMostAxes - 1));
  }
}

auto LogOptions::job_logs() const -> JobLogs {
  return {.files = read_logs(files, maps), .axis = axis, .coupled_to = coupled_to};
}

void warn(const std::string& warning) {
  std::cerr << "warning: " << warning << "\n";
}

void add_drawing(CLI::App& command, TendonDrawing& drawing) {
  command
      .add_option("--radius", drawing.radius_m,
                  "radius of the motor's pulley in m, behind its gear: gives the tendons' pretension in newtons")
      ->check(CLI::Range(1e-5, 10.0));
  command
      .add_option("--stiffness", drawing.stiffness_n_per_m,
                  "or, if the radius is unknown, stiffness E A / L of one tendon in N/m")
      ->check(CLI::Range(1e-3, 1e12));
}

auto law_table(const JointFile& joint, const std::vector<std::string>& left_out) -> std::string {
  std::string table;
  auto add = [&](const std::string& name, double value, const std::string& interval, const char* unit) {
    if (std::find(left_out.begin(), left_out.end(), name) == left_out.end()) {
      table += table_row(name, value, interval, unit);
    }
  };
  for (const auto& term : *joint.catalogue) {
    if (!joint.has(term.name)) {
      continue;
    }
    if (term.form_free) {
      table += table_line(joint, term);
      continue;
    }
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const std::size_t at = term.first_coefficient + i;
      const double value = joint.parameters.coefficients[at];
      if (joint.left_out(term, i)) {
        continue;
      }
      const char* without = value == 0.0 ? "held at its bound" : "no interval";
      add(term.name + "." + term.coefficients[i].name, value, interval_text(joint.coefficient_ci95[at], without),
          term.coefficients[i].unit);
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const auto& info = term.shapes[i];
      const std::size_t at = term.first_shape + i;
      const bool idle = info.idle_without >= 0 &&
                        joint.parameters.shapes[term.first_shape + static_cast<std::size_t>(info.idle_without)] == 0.0;
      if (!idle) {
        add(term.name + "." + info.name, joint.parameters.shapes[at],
            interval_text(joint.shape_ci95[at], "any near this one"), info.unit);
      }
    }
  }
  return table;
}

auto error_text(double rmse, const std::string& unit) -> std::string {
  const std::string text = rounded(rmse) + " " + unit;
  return unit == "rad" ? text + " (" + rounded(rmse * 180.0 / std::numbers::pi, 3) + " deg)" : text;
}

}  // namespace capstan::tools
