// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/telemetry/frame_recorder.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>

#include "capstan/firmware/telemetry/telemetry_frames.hpp"

namespace capstan::tools {
namespace {

auto u16_at(std::string_view bytes, std::size_t at) -> std::uint16_t {
  return static_cast<std::uint16_t>(static_cast<unsigned char>(bytes[at]) | static_cast<unsigned char>(bytes[at + 1])
                                                                                << 8U);
}
auto u32_at(std::string_view bytes, std::size_t at) -> std::uint32_t {
  return u16_at(bytes, at) | static_cast<std::uint32_t>(u16_at(bytes, at + 2)) << 16U;
}
auto bytes_of(std::string_view text) -> std::span<const std::uint8_t> {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Exact: a Q24 has 24 binary places, so as many decimals.
auto decimal(std::int32_t raw, bool real) -> std::string {
  std::array<char, 48> text{};
  if (real) {
    std::snprintf(text.data(), text.size(), "%.9f", static_cast<double>(raw) / 16777216.0);
  } else {
    std::snprintf(text.data(), text.size(), "%u", static_cast<std::uint32_t>(raw));
  }
  return text.data();
}

}  // namespace

auto FrameRecorder::feed(std::string_view bytes) -> std::string {
  std::string text;
  for (const char c : bytes) {
    if (c != '\0') {
      (in_frame_ ? frame_ : text) += c;
      if (frame_.size() > telemetry::kMostWireBytes) {  // longer than any: its end was lost, and this is text
        ++damaged_;
        text += frame_;
        frame_.clear();
        in_frame_ = false;
      }
    } else if (!in_frame_ || frame_.empty()) {
      in_frame_ = true;
    } else {
      // Only a whole frame is followed by text. After a broken one the zero may as well have begun the next.
      in_frame_ = !take_frame();
      damaged_ += in_frame_ ? 1 : 0;
      frame_.clear();
    }
  }
  return text;
}

auto FrameRecorder::take_frame() -> bool {
  std::array<std::uint8_t, telemetry::kMostPacketBytes> packet{};
  const std::size_t size = plant_link::cobs_decode(bytes_of(frame_), packet);
  if (size < telemetry::kHeaderBytes + 2) {
    return false;
  }
  const std::string_view whole(reinterpret_cast<const char*>(packet.data()), size);
  const std::string_view body = whole.substr(0, size - 2);
  if (plant_link::crc16(bytes_of(body)) != u16_at(whole, size - 2) || packet[1] != telemetry::kVersion) {
    return false;
  }
  return packet[0] == telemetry::kSchemaTag ? take_schema(body) : packet[0] == telemetry::kDataTag && take_data(body);
}

auto FrameRecorder::take_schema(std::string_view packet) -> bool {
  const std::uint16_t schema = plant_link::crc16(bytes_of(packet));
  if (!channels_.empty()) {
    return true;  // the log has its columns; data of another schema are foreign to it
  }
  every_ = std::max<std::uint32_t>(u16_at(packet, 2), 1);
  std::size_t at = telemetry::kHeaderBytes + 1;
  std::vector<Channel> channels;
  for (int i = 0; i < packet[telemetry::kHeaderBytes] && at < packet.size(); ++i) {
    const std::size_t end = std::min(packet.find('\0', at + 1), packet.size());
    channels.push_back({packet[at] == 0, std::string(packet.substr(at + 1, end - at - 1))});
    const std::string& column = channels.back().column;
    if (std::any_of(column.begin(), column.end(), [](char c) { return c <= ' ' || c > '~' || c == ','; })) {
      return false;  // it would break the log's header
    }
    at = end + 1;
  }
  if (channels.empty()) {
    return false;
  }
  channels_ = channels;
  schema_ = schema;
  std::vector<std::string> columns;
  for (const Channel& channel : channels_) {
    columns.push_back(channel.column);
  }
  log_.begin(columns);
  return true;
}

auto FrameRecorder::take_data(std::string_view packet) -> bool {
  const std::size_t values = telemetry::kHeaderBytes + 4;
  if (packet.size() < values || (packet.size() - values) % 4 != 0) {
    return false;
  }
  if (channels_.empty() || u16_at(packet, 2) != schema_ || (packet.size() - values) / 4 != channels_.size()) {
    ++foreign_;
    return true;
  }
  const std::uint32_t tick = u32_at(packet, telemetry::kHeaderBytes);
  const auto passed = static_cast<std::int32_t>(tick - tick_);
  if (after_restart_ > 0 || (rows_ > 0 && passed <= 0)) {
    ++after_restart_;  // its time would run backward, and once it has caught up, be that of two runs
    return true;
  }
  time_ms_ = rows_ == 0 ? tick : time_ms_ + passed;
  lost_ += rows_ == 0 ? 0 : static_cast<std::uint32_t>(passed) / every_ - 1;
  tick_ = tick;
  ++rows_;
  std::vector<std::string> row;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    row.push_back(decimal(static_cast<std::int32_t>(u32_at(packet, values + 4 * i)), channels_[i].real));
  }
  log_.row(time_ms_, row);
  return true;
}

}  // namespace capstan::tools
