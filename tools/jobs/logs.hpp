// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capstan/tools/joint_file/joint_file.hpp"
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
auto read_axes(const JobLogs& logs, const AxisRequest& request, const Say& warn) -> std::vector<AxisLog>;

/// The same, where several recordings in one file are a log each.
auto read_recordings(const JobLogs& logs, const AxisRequest& request, const Say& warn) -> std::vector<AxisLog>;

/// A file's law that a fit starts from. Throws BadInput with what to give in place of a law of an effort.
auto read_start_law(const std::string& path) -> JointFile;

/// Makes the request one for an effort where the target or the model asks for that. Throws Refusal for a current or a
/// voltage, which is no effort yet.
void request_target(const std::string& target, const std::string& model, AxisRequest& request);

}  // namespace capstan::tools
