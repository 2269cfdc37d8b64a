// SPDX-License-Identifier: Apache-2.0
// Any bytes as an MCAP file: it is refused with a sentence, or it is a log that can be read. What it unpacks to is
// bounded by what a chunk may claim.
#include <cstdlib>

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/log/mcap_format.hpp"
#include "capstan/tools/log/mcap_log.hpp"
#include "capstan/tools/support/errors.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace capstan::tools;
  const auto require = [](bool holds) {
    if (!holds) {
      std::abort();
    }
  };
  std::string bytes(mcap::kMagic);
  bytes.append(reinterpret_cast<const char*>(data), size);
  try {
    const CsvLog log = CsvLog::parse(bytes, "fuzz.mcap");
    require(log.rows() > 0 && log.column_names().size() > 1 && log.column_names().front() == "time_s");
    for (const std::string& name : log.column_names()) {
      require(log.column_with_gaps(name).size() == static_cast<Eigen::Index>(log.rows()));
    }
  } catch (const BadInput& refusal) {
    require(!std::string(refusal.what()).empty());
  }
  return 0;
}
