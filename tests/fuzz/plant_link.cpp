// SPDX-License-Identifier: Apache-2.0
// Any bytes on the plant's line, as they are or with the framing and checksum made right: no sensor is good unless a
// good frame said so, and what is taken for a frame is sent again as the same frame.
#include <cstdlib>
#include <vector>

#include "capstan/hal/plant_link/plant_link_io.hpp"

namespace {

using namespace capstan;
using namespace capstan::plant_link;

constexpr std::size_t kAxes = 2;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

struct Port {
  auto read(std::uint8_t& byte) noexcept -> bool {
    if (at == data.size()) {
      return false;
    }
    byte = data[at++];
    return true;
  }
  auto write_free() noexcept -> std::size_t { return 256; }
  auto write(std::span<const std::uint8_t> bytes) noexcept -> std::size_t { return bytes.size(); }
  std::vector<std::uint8_t> data;
  std::size_t at = 0;
};
struct Counter {
  [[nodiscard]] auto now() const noexcept -> std::uint32_t { return ++looks; }
  mutable std::uint32_t looks = 0;
};

/// Gives the bytes what a fuzzer can not guess: checksum and framing, in portions of one sensor frame.
auto framed(std::span<const std::uint8_t> bytes) -> std::vector<std::uint8_t> {
  std::vector<std::uint8_t> line;
  constexpr std::size_t kBody = kSensedSize<kAxes> - 2;
  for (; bytes.size() >= kBody; bytes = bytes.subspan(kBody)) {
    std::vector<std::uint8_t> packet(bytes.begin(), bytes.begin() + kBody);
    const std::uint16_t crc = crc16(packet);
    packet.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
    packet.push_back(static_cast<std::uint8_t>(crc >> 8U));
    std::array<std::uint8_t, cobs_max_size(kSensedSize<kAxes>)> coded{};
    const std::size_t size = cobs_encode(packet, coded);
    line.insert(line.end(), coded.begin(), coded.begin() + static_cast<std::ptrdiff_t>(size));
    line.push_back(kFrameEnd);
  }
  return line;
}

void sent_again_is_the_same(std::span<const std::uint8_t> line) {
  FrameReader<kSensedSize<kAxes>> reader;
  for (const std::uint8_t byte : line) {
    SensedFrame<kAxes> frame;
    if (!reader.take(byte) || !decode(reader.packet(), frame)) {
      continue;
    }
    FrameReader<kSensedSize<kAxes>> second;
    SensedFrame<kAxes> again;
    bool whole = false;
    const auto wire = encode(frame);
    for (const std::uint8_t sent : wire.view()) {
      whole = second.take(sent);
    }
    require(whole && decode(second.packet(), again));
    require(again.sequence == frame.sequence && again.estop == frame.estop);
    for (std::size_t i = 0; i < kAxes; ++i) {
      require(again.axis[i].encoder_counts == frame.axis[i].encoder_counts &&
              again.axis[i].current_a == frame.axis[i].current_a && again.axis[i].encoder == frame.axis[i].encoder &&
              again.axis[i].current == frame.axis[i].current);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  Port port{data[0] % 2 == 0 ? std::vector<std::uint8_t>(bytes.begin(), bytes.end()) : framed(bytes)};
  sent_again_is_the_same(port.data);
  Counter counter;
  PlantLinkIo<Port, Counter, kAxes> link(port, counter, 50);
  link.start();
  for (int i = 0; i < 100 && port.at < port.data.size(); ++i) {
    Sensed<kAxes> sensed;
    const Status status = link.read(sensed);
    for (const AxisSensed& axis : sensed.axis) {
      require(axis.encoder <= Quality::kOk && axis.current <= Quality::kOk);
      require(status == Status::kOk || (axis.encoder != Quality::kOk && axis.current != Quality::kOk));
    }
    static_cast<void>(link.write({}));
  }
  return 0;
}
