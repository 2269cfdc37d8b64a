// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

namespace capstan::tools {

/// `capstan diagnose` over a log that a page brings, as a process of its own: a page that waits keeps its board.
class DiagnosisJob {
 public:
  /// Makes a folder for logs and reports, which goes with this object. Throws std::exception.
  explicit DiagnosisJob(boost::asio::io_context& io);
  DiagnosisJob(const DiagnosisJob&) = delete;
  auto operator=(const DiagnosisJob&) -> DiagnosisJob& = delete;
  ~DiagnosisJob();

  /// @param target  column to explain; empty: the joint's angle   @param done  is told the answer as JSON:
  ///   {"status": 0, "said": "...", "diagnosis": {...}, "lines": ["begin", ...], "not_applied": "why there are none"}
  /// False if a job is under way.
  auto start(std::string_view log, const std::string& target, std::function<void(std::string)> done) -> bool;
  /// The last report, a page of its own; nothing if there is none.
  [[nodiscard]] auto report() const -> std::optional<std::string>;

 private:
  [[nodiscard]] auto answer(int status) const -> std::string;

  boost::asio::io_context& io_;
  std::filesystem::path folder_;
  std::thread waiting_;
  int process_ = 0;  // 0: none
};

}  // namespace capstan::tools
