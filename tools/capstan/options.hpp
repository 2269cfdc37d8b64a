// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// Options shared by every command that reads logs.
struct LogOptions {
  std::vector<std::string> files;
  std::vector<std::string> maps;
  int axis = 0;
  std::vector<int> coupled_to;  ///< axes that may pull at this one, by slots

  void add_to(CLI::App& command, bool many);
  /// Reads every file. Warnings go to stderr.
  [[nodiscard]] auto read(const AxisRequest& request) const -> std::vector<AxisLog>;
};

/// "value [low, high] unit" lines of a law, one per parameter, for people.
auto law_table(const struct JointFile& joint, const std::vector<std::string>& left_out) -> std::string;

/// "0.01 rad (0.573 deg)", "3.2 N".
auto error_text(double rmse, const std::string& unit) -> std::string;

/// Makes the request one for an effort where the target or the model asks for that. Throws Refusal for a current or a
/// voltage, which is no effort yet.
void request_target(const std::string& target, const std::string& model, AxisRequest& request);

}  // namespace capstan::tools
