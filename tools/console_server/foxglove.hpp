// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/tools/console_server/hub.hpp"
#include "capstan/tools/telemetry/frame_recorder.hpp"

namespace capstan::tools {

/// The signals that a board sends, by Foxglove's WebSocket protocol (foxglove.websocket.v1): a topic for each axis, a
/// JSON message per sample, as in our MCAP files. Who listens here only looks.
class FoxgloveFeed final : public Talk, private LogSink {
 public:
  static constexpr std::string_view kSubprotocol = "foxglove.websocket.v1";

  /// @param hub  outlives this object, which hears it from now on
  explicit FoxgloveFeed(Hub& hub);

  void join(Guest& guest, Hub::Clock::time_point now) override;
  void leave(Guest& guest) override;
  /// What Foxglove wants: subscriptions. Anything else is answered with a status.
  void word(Guest& guest, std::string_view text, Hub::Clock::time_point now) override;
  void bytes(Guest& guest, std::string_view bytes) override;
  /// To be called several times a second: asks the board for signals if no page does.
  void look(Hub::Clock::time_point now);

 private:
  struct Topic {
    std::uint32_t id = 0;
    std::string name;
    std::vector<std::pair<std::string, std::size_t>> fields;  // name in the message, column
  };
  using Subscriptions = std::map<std::uint32_t, std::uint32_t>;  // id of the listener's, topic

  void hear(std::string_view bytes);
  void begin(const std::vector<std::string>& columns) override;
  void row(std::int64_t time_ms, const std::vector<std::string>& values) override;
  void end() override {}
  void forget();
  [[nodiscard]] auto advertisement() const -> std::string;

  Hub& hub_;
  std::unique_ptr<FrameRecorder> recorder_;
  std::map<Guest*, Subscriptions> listeners_;
  std::vector<Topic> topics_;
  std::uint32_t next_id_ = 1;
  std::int64_t epoch_ns_ = 0;  // of the board's time 0
  Hub::Clock::time_point heard_{};
};

}  // namespace capstan::tools
