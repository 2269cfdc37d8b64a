// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/tools/console_server/self_process.hpp"

namespace capstan::tools {

/// `capstan diagnose`, `capstan identify` or `capstan tune` over a log that a page brings, one at a time.
class LogJob {
 public:
  /// Is told the answer as JSON:
  ///   {"status": 0, "said": "...", "diagnosis": {...}, "lines": ["begin", ...], "not_applied": "why there are none"}
  using Done = std::function<void(std::string)>;

  /// Makes a folder for logs and reports, which goes with this object. Throws std::exception.
  explicit LogJob(boost::asio::io_context& io) : process_(io) {}

  /// @param options  "AXIS", where the joint's angle is to be explained, or "AXIS/COLUMN"
  /// False if a job is under way.
  auto diagnose(std::string_view log, std::string_view options, Done done) -> bool;
  /// Fits a law anew. @param options  "AXIS/MODEL", as `capstan identify --model` names it
  /// False if a job is under way.
  auto identify(std::string_view log, std::string_view options, Done done) -> bool;
  /// @param log  the answer to `dump`, and below it that of the experiment   @param options  "AXIS" or "AXIS/BANDWIDTH"
  /// False if a job is under way.
  auto tune(std::string_view log, std::string_view options, Done done) -> bool;
  /// The last report, a page of its own; nothing if there is none.
  [[nodiscard]] auto report() const -> std::optional<std::string>;

 private:
  /// @param second  the option that is what stands behind the axis
  auto start(std::string_view log, std::vector<std::string> words, std::string_view options, const std::string& second,
             bool lines_on_stdout, Done done) -> bool;
  /// Throws std::exception where the folder takes no files.
  void begin(std::string_view log, std::vector<std::string> words, std::string_view options, const std::string& second,
             bool lines_on_stdout, const Done& done);
  [[nodiscard]] auto answer(int status) const -> std::string;

  TemporaryFolder folder_;
  SelfProcess process_;
  int axis_ = 0;
};

}  // namespace capstan::tools
