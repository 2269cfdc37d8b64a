// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>

#include "capstan/firmware/loop/exchange.hpp"
#include "capstan/firmware/telemetry/signals.hpp"

namespace capstan {

/// What ends the waiting of a capture.
enum class ScopeTrigger : std::uint8_t {
  kNow,      ///< at once
  kFault,    ///< a fault is latched
  kRising,   ///< the signal passes the level upwards
  kFalling,  ///< the signal passes the level downwards
  kAbove,    ///< the signal is at the level or above
  kBelow,    ///< the signal is below the level
};

struct ScopeSetup {
  static constexpr std::size_t kMostChannels = kMostSignals;
  std::array<Signal, kMostChannels> channels{};
  std::size_t channel_count = 0;
  ScopeTrigger trigger = ScopeTrigger::kNow;
  Signal trigger_signal;    ///< of the last four triggers
  std::int32_t level = 0;   ///< raw, in the type of that signal
  std::size_t samples = 0;  ///< altogether; 0 stops a capture
  std::size_t before = 0;   ///< of these, before the trigger
  std::uint32_t every = 1;  ///< cycles from sample to sample
};

/// Records signals in every cycle around a moment that a trigger chooses. One side belongs to the cycle, the other to
/// the background; neither waits for the other. While a capture runs the cycle alone writes the memory, and from
/// kDone until the next start() the background alone reads it. A board may have two consoles, so who reads says so.
class Scope {
 public:
  static constexpr std::size_t kWords = 8 * 1000;  ///< samples times channels
  enum class Phase : std::uint8_t { kIdle, kWaiting, kFilling, kDone };

  /// Begins a capture, or ends one. False: the cycle has not taken the last setup yet, or the last capture is being
  /// read, and nothing changed.
  /// @pre 1 to 8 channels, samples * channels <= kWords, before < samples, every >= 1; or samples = 0
  auto start(const ScopeSetup& setup) -> bool;
  [[nodiscard]] auto requests_taken() const -> bool { return box_.empty(); }
  [[nodiscard]] auto phase() const -> Phase { return phase_.load(std::memory_order_acquire); }

  /// Takes a finished capture for reading: until end_reading() no start() succeeds. False: there is none.
  auto begin_reading() -> bool;
  void end_reading() { --readers_; }
  [[nodiscard]] auto reading() const -> bool { return readers_ > 0; }

  // Of who reads:
  [[nodiscard]] auto setup() const -> const ScopeSetup& { return setup_; }
  [[nodiscard]] auto size() const -> std::size_t { return stored_; }
  /// Cycles from the trigger to a sample; the trigger's own sample has 0.
  [[nodiscard]] auto cycles_from_trigger(std::size_t sample) const -> std::int32_t;
  /// @pre sample < size(), channel < setup().channel_count
  [[nodiscard]] auto raw(std::size_t sample, std::size_t channel) const -> std::int32_t;
  [[nodiscard]] auto trigger_tick() const -> std::uint32_t { return trigger_tick_; }
  /// Cycles that the board skipped while the capture ran: samples that are missing.
  [[nodiscard]] auto dropped() const -> std::uint32_t { return overruns_last_ - overruns_first_; }

  /// Called by the cycle with what it has just published.
  void rt_step(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes);

 private:
  void rt_take(const MachineTelemetry& machine);
  void rt_store(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes);
  [[nodiscard]] auto rt_triggered(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) -> bool;

  Mailbox<ScopeSetup> box_;
  std::uint32_t readers_ = 0;  // the background's
  std::atomic<Phase> phase_ = Phase::kIdle;
  ScopeSetup setup_;
  std::array<std::int32_t, kWords> words_{};
  std::size_t next_ = 0;    // where the next sample goes
  std::size_t stored_ = 0;  // samples in the memory
  std::size_t after_ = 0;   // samples stored since the trigger, its own included
  std::uint32_t skip_ = 0;  // cycles until the next sample
  std::int32_t last_ = 0;   // of the trigger's signal
  bool has_last_ = false;
  std::uint32_t trigger_tick_ = 0;
  std::uint32_t overruns_first_ = 0;
  std::uint32_t overruns_last_ = 0;
};

}  // namespace capstan
