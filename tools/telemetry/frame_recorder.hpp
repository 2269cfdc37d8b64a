// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/tools/telemetry/log_sink.hpp"

namespace capstan::tools {

/// Takes what a board sends apart: text for the operator, and frames (firmware/telemetry/telemetry_frames.hpp) as a log
/// by the contract. A frame that was damaged on its way is dropped and counted, and the next one is read again.
class FrameRecorder {
 public:
  /// @param log  outlives this object
  explicit FrameRecorder(LogSink& log) : log_(log) {}

  /// Returns the text among the bytes.
  auto feed(std::string_view bytes) -> std::string;

  [[nodiscard]] auto rows() const -> std::uint64_t { return rows_; }
  /// Samples that the board took and that did not arrive.
  [[nodiscard]] auto lost() const -> std::uint64_t { return lost_; }
  /// Frames that were no use: damaged, or of signals that the log has no columns for.
  [[nodiscard]] auto damaged() const -> std::uint64_t { return damaged_; }
  [[nodiscard]] auto foreign() const -> std::uint64_t { return foreign_; }
  /// Frames since the board started anew, which belong into another log.
  [[nodiscard]] auto after_restart() const -> std::uint64_t { return after_restart_; }

 private:
  struct Channel {
    bool real = false;
    std::string column;
  };
  auto take_frame() -> bool;
  auto take_schema(std::string_view packet) -> bool;
  auto take_data(std::string_view packet) -> bool;

  LogSink& log_;
  bool in_frame_ = false;
  std::string frame_;
  std::vector<Channel> channels_;
  std::uint32_t every_ = 0;
  std::uint16_t schema_ = 0;
  std::int64_t time_ms_ = 0;  // of the last row
  std::uint32_t tick_ = 0;
  std::uint64_t rows_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t damaged_ = 0;
  std::uint64_t foreign_ = 0;
  std::uint64_t after_restart_ = 0;
};

}  // namespace capstan::tools
