// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <sstream>
#include <string>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/run/run.hpp"

namespace capstan::tools::test {

/// The log that `capstan run` writes of a scenario in tools/scenarios. @param seed  in place of the scenario's
inline auto log_of(const std::string& scenario, std::optional<std::uint64_t> seed = {}) -> CsvLog {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  sim::Scenario run = sim::load_scenario(CAPSTAN_SOURCE_DIR "/tools/scenarios/" + scenario);
  run.seed = seed.value_or(run.seed);
  static_cast<void>(run_scenario(run, {}, banks, &text));
  return CsvLog::parse(text.str(), scenario);
}

inline auto record(const std::string& scenario) -> AxisLog {
  return read_force_log(log_of(scenario), 0);
}

}  // namespace capstan::tools::test
