// SPDX-License-Identifier: Apache-2.0
// Any bytes from a board's line: what is no frame comes out as text or not at all, and every row of the log has as many
// cells as its header.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "capstan/tools/telemetry/frame_recorder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::ostringstream log;
  const auto sink = capstan::tools::csv_sink(log);
  capstan::tools::FrameRecorder recorder(*sink);
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = size / 3;
  const std::string text = recorder.feed(bytes.substr(0, cut)) + recorder.feed(bytes.substr(cut));
  const auto require = [](bool holds) {
    if (!holds) {
      std::abort();
    }
  };
  require(text.size() <= size && text.find('\0') == std::string::npos);
  std::istringstream lines(log.str());
  std::string line;
  std::uint64_t rows = 0;
  for (; std::getline(lines, line); ++rows) {
    require(line.find('\0') == std::string::npos);
  }
  require(rows <= recorder.rows() + 1);
  return 0;
}
