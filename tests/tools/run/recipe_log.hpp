// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/run/run.hpp"

namespace capstan::tools::test {

/// What `capstan run` records of a scenario in tools/scenarios.
inline auto record(const std::string& scenario) -> ForceLog {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  const std::string path = CAPSTAN_SOURCE_DIR "/tools/scenarios/" + scenario;
  static_cast<void>(run_scenario(sim::load_scenario(path), {}, banks, &text));
  return read_force_log(CsvLog::parse(text.str(), scenario), 0);
}

}  // namespace capstan::tools::test
