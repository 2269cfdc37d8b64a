// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "capstan/model/fixed.hpp"

namespace capstan {

/// Outcome of a call to the hardware. A failed read leaves the fields it could not fill marked `kMissing`.
enum class [[nodiscard]] Status : std::uint8_t{kOk, kTimeout, kFailed};

/// What a backend knows about one value. Anything but kOk is a fault value, never a guess.
enum class Quality : std::uint8_t {
  kMissing,  ///< no new value arrived for this cycle
  kInvalid,  ///< a value arrived that is not a number or outside what the sensor can give
  kOk,
};

/// One joint's sensors, taken at one instant.
struct AxisSensed {
  std::int32_t encoder_counts = 0;  ///< free running, wraps modulo 2^32
  Q24 current_a{};                  ///< motor current, A
  Quality encoder = Quality::kMissing;
  Quality current = Quality::kMissing;
  Q24 joint_rad{};                     ///< joint angle, where the joint has a sensor
  Quality joint = Quality::kMissing;   ///< no joint needs one: missing is no fault
  Q24 supply_v{};                      ///< of the joint's amplifier, V, where it is measured
  Quality supply = Quality::kMissing;  ///< missing is a fault only where limits.supply_min is set
  bool follows = true;  ///< the amplifier follows its set value; false: enabled, but still on its way to torque
};

/// Everything the firmware knows about the world in one cycle.
template <std::size_t Axes>
struct Sensed {
  std::array<AxisSensed, Axes> axis{};
  Q24 temperature_c{};                      ///< of the transmission, where there is a thermometer
  Quality temperature = Quality::kMissing;  ///< missing is no fault
  std::uint32_t overruns = 0;  ///< cycles that began late or were skipped since start, counted by the board
  bool estop = false;          ///< emergency stop input is open
};

/// One joint's amplifier set value.
struct AxisDrive {
  Q24 current_a{};       ///< wanted motor current, A
  bool enabled = false;  ///< false: the bridge is off, whatever current_a says
};

template <std::size_t Axes>
struct Drive {
  std::array<AxisDrive, Axes> axis{};
};

/// The contract with hardware: three calls on whole snapshots, so recording and replay come free.
template <typename Io>
concept JointIo = requires(Io io, Sensed<Io::kAxes>& in, const Drive<Io::kAxes>& out) {
  { io.read(in) }
  noexcept->std::same_as<Status>;  // fills every field, or marks it missing
  { io.write(out) }
  noexcept->std::same_as<Status>;  // never blocks past the cycle's deadline
  { io.release() }
  noexcept->std::same_as<void>;  // de-energises; legal at any time, from any state
};

}  // namespace capstan
