// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace capstan::tools {

/// Where the rows of a recording go.
class LogSink {
 public:
  LogSink() = default;
  LogSink(const LogSink&) = delete;
  auto operator=(const LogSink&) -> LogSink& = delete;
  virtual ~LogSink() = default;

  /// Once, before the first row. @param columns  by the contract, without time_s
  virtual void begin(const std::vector<std::string>& columns) = 0;
  /// @param values  as decimal numbers, one per column
  virtual void row(std::int64_t time_ms, const std::vector<std::string>& values) = 0;
  /// Once, after the last row; the log is complete then.
  virtual void end() = 0;
};

/// A log by the contract, as CSV, flushed every second of its time. @param out  outlives the sink
auto csv_sink(std::ostream& out) -> std::unique_ptr<LogSink>;
/// As MCAP: a topic for each axis ("axis0"), one for what belongs to none ("log"), a JSON message per row and topic.
auto mcap_sink(std::ostream& out) -> std::unique_ptr<LogSink>;
/// A file, MCAP for a path that ends in ".mcap", CSV for others. It is made, or emptied, with the first row: who
/// records nothing leaves an older log as it was. Throws BadInput if no file can be written there, and from end() if
/// the disk did not take all of it.
auto file_sink(const std::string& path) -> std::unique_ptr<LogSink>;

}  // namespace capstan::tools
