// SPDX-License-Identifier: Apache-2.0
// Any text as a log file: it is refused with a sentence, or every number of it is finite and its time runs forward.
#include <cstdlib>

#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/support/errors.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace capstan::tools;
  const auto require = [](bool holds) {
    if (!holds) {
      std::abort();
    }
  };
  constexpr std::size_t kLongest = 16 * 1024;
  const std::string text(reinterpret_cast<const char*>(data), std::min(size, kLongest));
  try {
    const CsvLog csv = CsvLog::parse(text, "fuzz.csv", parse_mappings({"axis0/q2_rad=camera*0.5"}));
    for (const std::string& name : csv.column_names()) {
      try {
        require(csv.column(name).allFinite());
      } catch (const BadInput& refusal) {
        require(!std::string(refusal.what()).empty());
      }
    }
    AxisRequest request;
    request.needs_target = false;
    const AxisLog log = read_axis(csv, request);
    require(log.samples() > 0 && log.period_s > 0.0 && log.q1_rad.allFinite() && log.tau_nm.allFinite());
    for (Eigen::Index i = 1; i < log.samples(); ++i) {
      require(log.time_s[i] > log.time_s[i - 1]);
    }
  } catch (const BadInput& refusal) {
    require(!std::string(refusal.what()).empty());
  }
  return 0;
}
