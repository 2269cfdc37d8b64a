// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capstan/tools/log/axis_log.hpp"

/// What the commands do, for whoever asks: the command line and the Python module.
namespace capstan::tools {

/// One sentence for the person who asked.
using Say = std::function<void(const std::string&)>;

/// Logs of one joint, and which axis of them is meant.
struct JobLogs {
  std::vector<CsvLog> files;
  int axis = 0;
  std::vector<int> coupled_to;  ///< axes that may pull at this one, by slots
};

/// Throws BadInput if a file is among them twice.
void refuse_repeats(const std::vector<std::string>& paths);

/// Throws BadInput if a file is given twice. @param maps  texts of --map
auto read_logs(const std::vector<std::string>& paths, const std::vector<std::string>& maps) -> std::vector<CsvLog>;

/// The axis of every log. @param warn  is told what was done with the logs
auto read_axes(const std::vector<CsvLog>& files, const AxisRequest& request, const Say& warn) -> std::vector<AxisLog>;

/// The same, where several recordings in one file are a log each.
auto read_recordings(const std::vector<CsvLog>& files, const AxisRequest& request, const Say& warn)
    -> std::vector<AxisLog>;

}  // namespace capstan::tools
