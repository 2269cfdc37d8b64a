// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/logs.hpp"

#include <iterator>

#include "capstan/tools/log/recordings.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

void refuse_repeats(const std::vector<std::string>& paths) {
  if (const auto path = first_repeat(paths, same_file); path != paths.end()) {
    throw BadInput(*path + " is given twice, and its rows would count as evidence twice; name it once");
  }
}

auto read_logs(const std::vector<std::string>& paths, const std::vector<std::string>& maps) -> std::vector<CsvLog> {
  const auto mappings = parse_mappings(maps);
  refuse_repeats(paths);
  std::vector<CsvLog> logs;
  for (const auto& path : paths) {
    logs.push_back(CsvLog::read(path, mappings));
  }
  return logs;
}

auto read_axes(const std::vector<CsvLog>& files, const AxisRequest& request, const Say& warn) -> std::vector<AxisLog> {
  std::vector<AxisLog> axes;
  for (const auto& file : files) {
    axes.push_back(read_axis(file, request));
    for (const auto& warning : axes.back().warnings) {
      warn(warning);
    }
  }
  return axes;
}

auto read_recordings(const std::vector<CsvLog>& files, const AxisRequest& request, const Say& warn)
    -> std::vector<AxisLog> {
  std::vector<AxisLog> all;
  for (auto& file : read_axes(files, request, warn)) {
    const std::size_t said = file.warnings.size();
    auto recordings = recordings_in(std::move(file));
    for (std::size_t i = said; i < recordings.front().warnings.size(); ++i) {
      warn(recordings.front().warnings[i]);
    }
    std::move(recordings.begin(), recordings.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace capstan::tools
