// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "capstan/firmware/loop/cycle.hpp"
#include "capstan/firmware/telemetry/signals.hpp"

namespace capstan {

/// One fault that took the torque away.
struct FaultEntry {
  std::uint32_t start = 0;         ///< of the firmware, counted from 1 since the memory last lost power
  std::uint32_t tick = 0;          ///< cycle of that start
  Fault fault = Fault::kNone;      ///< kNone: the firmware ended while there was torque, by a reset or a crash
  State state = State::kDisarmed;  ///< before
  std::uint8_t joints = 0;         ///< that showed it, bit N for joint N
  FaultSet conditions = 0;         ///< all that was present
};

/// The last faults, the last second under torque before one of them, and the windings' heat, in memory that outlives a
/// reset. A second that nobody has fetched is kept: later faults are listed only. The cycle writes the samples while it
/// runs, and the background reads them while they are frozen; neither waits.
class FaultLog {
 public:
  static constexpr std::size_t kEntries = 8;
  static constexpr std::uint32_t kEvery = 10;  ///< cycles from sample to sample; the last one is the fault's own
  static constexpr std::size_t kSamples = 100;
  static constexpr std::size_t kSignals = 4;  ///< of each joint, kept to 2^-16 in 24 bits
  static constexpr auto words_for(std::size_t axes) -> std::size_t { return heat_word(axes, axes); }
  /// What is recorded of each joint, in the order of the samples.
  static auto signals() -> std::array<const SignalInfo*, kSignals>;

  /// @param memory  words_for(axes) words that nothing touched since the last run, or whatever power-on left there;
  /// empty: there is no log, and every function does nothing
  FaultLog(std::span<std::uint32_t> memory, std::size_t axes);

  /// Of all time; the newest min(count, kEntries) are there.
  [[nodiscard]] auto count() const -> std::uint32_t;
  /// @param age  0: the newest
  [[nodiscard]] auto entry(std::uint32_t age) const -> FaultEntry;
  /// Samples that are kept; 0 if there are none.
  [[nodiscard]] auto kept() const -> std::size_t;
  /// Which fault they belong to.
  [[nodiscard]] auto kept_entry() const -> FaultEntry;
  /// Cycles from the fault to a sample, 0 or below. @pre sample < kept()
  [[nodiscard]] auto cycles_from_fault(std::size_t sample) const -> std::int32_t;
  /// @pre sample < kept(), a joint of the log's, signal < kSignals
  [[nodiscard]] auto raw(std::size_t sample, std::size_t axis, std::size_t signal) const -> std::int32_t;
  /// The kept second may be written over from the next arming on.
  void release();
  /// Heat of a joint's winding (Gate) when the last run ended, rounded up to a sixteenth; at least 1 where that was
  /// under torque, and 1 where nothing whole was kept (power was off). A restart cools nothing.
  [[nodiscard]] auto heat(std::size_t axis) const -> Q24;

  /// Called by the cycle with what it publishes.
  void rt_step(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes);
  /// Called by the cycle, now and then while there is no torque.
  void rt_keep_heat(std::size_t axis, Q24 heat);

 private:
  static constexpr std::size_t kHeadWords = 8;
  static constexpr std::size_t kEntryWords = 4;
  static constexpr std::size_t kWordsOfJoint = 3;
  static constexpr auto sample_words(std::size_t axes) -> std::size_t { return 1 + axes * kWordsOfJoint; }
  /// Behind everything else.
  static constexpr auto heat_word(std::size_t axis, std::size_t axes) -> std::size_t {
    return kHeadWords + kEntries * kEntryWords + kSamples * sample_words(axes) + axis;
  }
  enum Head : std::size_t { kMagic, kStarts, kFaults, kPhase, kKept, kNext, kStored, kLastTick };
  enum Phase : std::uint32_t { kFree, kRunning, kFrozen };

  [[nodiscard]] auto phase() const -> std::uint32_t;
  void set_phase(std::uint32_t phase);
  [[nodiscard]] auto place_of(std::size_t sample) const -> std::size_t;
  [[nodiscard]] auto unpack(std::uint32_t number) const -> FaultEntry;
  void rt_store(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes);
  void rt_add(const FaultEntry& entry);

  std::span<std::uint32_t> memory_;
  std::size_t axes_;
  State last_ = State::kDisarmed;
};

}  // namespace capstan
