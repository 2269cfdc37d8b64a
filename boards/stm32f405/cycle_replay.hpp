// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/firmware/loop/cycle.hpp"
#include "capstan/firmware/parameters/parameters.hpp"

/// A recorded run, played through the firmware's cycle. The same code reads it on the host and on the target, so equal
/// output files mean that estimator, supervisor, controller and limits agree to the last bit. All numbers are little
/// endian.
///
///   input:  "CRP5", axes u32, number of parameters u32, for each axis their raw values i32 | records of kInputSize
///   bytes output: records of kOutputSize bytes, one for each input record
namespace capstan::stm32f405 {

inline constexpr std::uint32_t kReplayMagic = 0x35505243;  // "CRP5"
template <std::size_t Axes>
inline constexpr std::size_t kInputSize = 6 + 38 * Axes;
template <std::size_t Axes>
inline constexpr std::size_t kOutputSize = 6 + 43 * Axes;

enum class ReplayResult : std::uint8_t { kOk = 0, kBadHeader = 10, kTruncated = 11, kWriteFailed = 12 };

/// What one cycle is given.
template <std::size_t Axes>
struct ReplayInput {
  Sensed<Axes> sensed;
  Command<Axes> command;
};

namespace detail {

class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> bytes) : bytes_(bytes) {}
  void u8(std::uint8_t value) { bytes_[at_++] = value; }
  void u32(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
      u8(static_cast<std::uint8_t>((value >> shift) & 0xFFU));
    }
  }
  void q24(Q24 value) { u32(static_cast<std::uint32_t>(value.raw())); }

 private:
  std::span<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  auto u8() -> std::uint8_t { return bytes_[at_++]; }
  auto u32() -> std::uint32_t {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 8) {
      value |= static_cast<std::uint32_t>(u8()) << shift;
    }
    return value;
  }
  auto q24() -> Q24 { return Q24::from_raw(static_cast<std::int32_t>(u32())); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace detail

/// One input record.
template <std::size_t Axes>
void encode(const ReplayInput<Axes>& input, std::span<std::uint8_t, kInputSize<Axes>> bytes) {
  detail::ByteWriter out(bytes);
  out.u8(static_cast<std::uint8_t>((input.sensed.estop ? 1U : 0U) | (input.command.arm ? 2U : 0U) |
                                   (input.command.disarm ? 4U : 0U) | (input.command.experiment ? 8U : 0U) |
                                   (input.command.rest ? 16U : 0U)));
  out.u8(input.command.cautious);
  out.u32(input.sensed.overruns);
  for (std::size_t i = 0; i < Axes; ++i) {
    const AxisSensed& sensed = input.sensed.axis[i];
    const Request& command = input.command.axis[i];
    out.u32(static_cast<std::uint32_t>(sensed.encoder_counts));
    out.q24(sensed.current_a);
    out.u8(
        static_cast<std::uint8_t>(static_cast<unsigned>(sensed.encoder) | static_cast<unsigned>(sensed.current) << 4U));
    out.u8(static_cast<std::uint8_t>(command.kind));
    for (const Q24 value : {command.position_rad, command.speed_rad_s, command.torque_nm, command.joint_torque_nm,
                            command.torque_rate_nm_s, command.corridor_rad, command.dither_nm}) {
      out.q24(value);
    }
  }
}

template <std::size_t Axes>
auto decode(std::span<const std::uint8_t, kInputSize<Axes>> bytes) -> ReplayInput<Axes> {
  detail::ByteReader in(bytes);
  ReplayInput<Axes> input;
  const std::uint8_t flags = in.u8();
  input.sensed.estop = (flags & 1U) != 0;
  input.command.arm = (flags & 2U) != 0;
  input.command.disarm = (flags & 4U) != 0;
  input.command.experiment = (flags & 8U) != 0;
  input.command.rest = (flags & 16U) != 0;
  input.command.cautious = in.u8();
  input.sensed.overruns = in.u32();
  for (std::size_t i = 0; i < Axes; ++i) {
    AxisSensed& sensed = input.sensed.axis[i];
    Request& command = input.command.axis[i];
    sensed.encoder_counts = static_cast<std::int32_t>(in.u32());
    sensed.current_a = in.q24();
    const std::uint8_t qualities = in.u8();
    sensed.encoder = static_cast<Quality>(qualities & 0xFU);
    sensed.current = static_cast<Quality>(qualities >> 4U);
    command.kind = static_cast<Request::Kind>(in.u8());
    for (Q24* const value : {&command.position_rad, &command.speed_rad_s, &command.torque_nm, &command.joint_torque_nm,
                             &command.torque_rate_nm_s, &command.corridor_rad, &command.dither_nm}) {
      *value = in.q24();
    }
  }
  return input;
}

/// One output record: the set values and everything the cycle reports.
template <std::size_t Axes>
void encode(const Drive<Axes>& drive, const CycleState<Axes>& state, std::span<std::uint8_t, kOutputSize<Axes>> bytes) {
  detail::ByteWriter out(bytes);
  out.u8(static_cast<std::uint8_t>(state.telemetry.state));
  out.u8(static_cast<std::uint8_t>(state.telemetry.first_fault));
  out.u32(state.telemetry.conditions);
  for (std::size_t i = 0; i < Axes; ++i) {
    const AxisTelemetry& axis = state.axis[i].telemetry();
    out.q24(drive.axis[i].current_a);
    out.u8(drive.axis[i].enabled ? 1 : 0);
    out.u8(axis.limits);
    for (const Q24 value : {axis.q1_rad, axis.tau_nm, axis.q2_rad, axis.q2_reported_rad, axis.q2_reference_rad,
                            axis.joint_torque_nm, axis.law_torque_nm, axis.disturbance_nm, axis.misfit}) {
      out.q24(value);
    }
    out.u8(axis.estimate_valid ? 1 : 0);
  }
}

/// Plays a whole run. Source: read(bytes) -> how many, fewer only at the end. Sink: write(bytes) -> done.
/// Meter: begin() and end() are called around each cycle, to time it where that means something.
template <std::size_t Axes, typename Source, typename Sink, typename Meter>
[[nodiscard]] auto replay(Source& source, Sink& sink, Meter& meter) -> ReplayResult {
  std::array<std::uint8_t, 12> head{};
  detail::ByteReader header(head);
  if (source.read(head) != head.size() || header.u32() != kReplayMagic || header.u32() != Axes ||
      header.u32() != parameters().size()) {
    return ReplayResult::kBadHeader;  // of another firmware
  }
  static Config<Axes> config;  // as large as half of the stack
  config.fill(kDefaultAxis);
  for (AxisConfig& axis : config) {
    for (const ParameterInfo& parameter : parameters()) {
      std::array<std::uint8_t, 4> word{};
      if (source.read(word) != word.size()) {
        return ReplayResult::kTruncated;
      }
      set_raw_value(axis, parameter, static_cast<std::int32_t>(detail::ByteReader(word).u32()));
    }
  }
  static CycleState<Axes> state(config);  // once per run, and too large for the target's stack
  std::array<std::uint8_t, kInputSize<Axes>> in{};
  std::array<std::uint8_t, kOutputSize<Axes>> out{};
  for (std::size_t got = source.read(in); got != 0; got = source.read(in)) {
    if (got != in.size()) {
      return ReplayResult::kTruncated;
    }
    const ReplayInput<Axes> input = decode<Axes>(in);
    meter.begin();
    const Drive<Axes> drive = cycle(state, input.sensed, input.command);
    meter.end();
    encode<Axes>(drive, state, out);
    if (!sink.write(out)) {
      return ReplayResult::kWriteFailed;
    }
  }
  return ReplayResult::kOk;
}

}  // namespace capstan::stm32f405
