// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/identify/pretension.hpp"
#include "capstan/tools/jobs/logs.hpp"

namespace capstan::tools {

/// Options shared by every command that reads logs.
struct LogOptions {
  std::vector<std::string> files;
  std::vector<std::string> maps;
  int axis = 0;
  std::vector<int> coupled_to;  ///< axes that may pull at this one, by slots

  void add_to(CLI::App& command, bool many);
  /// The files and what is said about them. Throws BadInput.
  [[nodiscard]] auto job_logs() const -> JobLogs;
};

/// Adds what the joint's drawing says of its tendons.
void add_drawing(CLI::App& command, TendonDrawing& drawing);

/// "value [low, high] unit" lines of a law, one per parameter, for people.
auto law_table(const struct JointFile& joint, const std::vector<std::string>& left_out) -> std::string;

/// "0.01 rad (0.573 deg)", "3.2 N".
auto error_text(double rmse, const std::string& unit) -> std::string;

/// Says a warning to stderr.
void warn(const std::string& warning);

}  // namespace capstan::tools
