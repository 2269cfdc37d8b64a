// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/loop/exchange.hpp"
#include "capstan/firmware/telemetry/signals.hpp"

namespace capstan {

/// Signals of one cycle, raw.
struct SignalSample {
  std::uint32_t tick = 0;
  std::uint32_t run = 0;  ///< which start() it belongs to
  std::array<std::int32_t, kMostSignals> raw{};
};

struct RecorderSetup {
  std::array<Signal, kMostSignals> signals{};
  std::size_t count = 0;
  std::uint32_t every = 1;  ///< in cycles whose number divides by this
  std::uint32_t run = 0;    ///< set by start()
};

/// Those of these names of one joint, and behind them whether an experiment runs.
void choose_signals(RecorderSetup& setup, std::size_t axis, std::span<const std::string_view> names);

/// Hands signals of every Nth cycle to the background, in order, as long as that keeps up; what finds no room is
/// dropped and counted. One side belongs to the cycle, the other to the background.
class Recorder {
 public:
  /// Begins anew. False, and nothing changed: the cycle has not taken the last setup yet, or somebody else records.
  /// @param owner  who records, until he stops; a board may have two consoles
  auto start(const void* owner, const RecorderSetup& setup) -> bool;
  void stop(const void* owner);
  [[nodiscard]] auto requests_taken() const -> bool { return box_.empty(); }
  /// The next sample of the last start(); older ones are passed over. For the owner.
  auto next(SignalSample& sample) -> bool;
  /// Of all runs.
  [[nodiscard]] auto dropped() const -> std::uint32_t { return samples_.dropped(); }

  /// Called by the cycle with what it has just published.
  void rt_step(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes);

 private:
  static constexpr std::size_t kRoom = 32;
  Mailbox<RecorderSetup> box_;
  std::atomic<bool> on_ = false;
  RecorderSetup setup_;    // the cycle's
  std::uint32_t run_ = 0;  // the background's
  const void* owner_ = nullptr;
  SpscRing<SignalSample, kRoom> samples_;
};

}  // namespace capstan
