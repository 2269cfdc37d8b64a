// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/hal/cia402/drive_state.hpp"
#include "capstan/hal/cia402/sdo_client.hpp"

namespace capstan::cia402 {

/// Tries whether a drive gives up when its master falls silent, where no object says so: brings it to switched on,
/// which gives no torque, sends heartbeats, stops sending them, and looks whether it is still switched on. @pre
/// operational
class LossTrial {
 public:
  enum class Verdict : std::uint8_t { kRunning, kStops, kGoesOn, kNotTried };
  /// The longest heartbeat time that the set-up asks for, and half as much again.
  static constexpr std::chrono::milliseconds kSilence{300};

  explicit LossTrial(SdoClient& sdo) : sdo_(sdo) {}

  /// What to send now, if anything; call it at least every 10 ms. Answers go to the SdoClient.
  auto next(Time now) -> std::optional<Frame>;
  /// Voltage is off again once there is one.
  [[nodiscard]] auto verdict() const -> Verdict { return done_ ? verdict_ : Verdict::kRunning; }

 private:
  enum class Part : std::uint8_t { kReady, kSwitchedOn, kSilent, kLook, kOff, kReset, kOffAgain };
  static constexpr std::chrono::milliseconds kPatience{2000};  ///< with a drive on its way to switched on

  void enter(Part part, Time now);
  auto request(Time now) -> std::optional<Frame>;
  void judge(Time now);
  auto write(std::uint16_t controlword, Time now) -> Frame;

  SdoClient& sdo_;
  Part part_ = Part::kReady;
  Verdict verdict_ = Verdict::kNotTried;
  bool done_ = false;
  bool asked_ = false;
  bool written_ = false;
  std::optional<Time> since_;      // of the part
  std::optional<Time> heartbeat_;  // the last one
};

}  // namespace capstan::cia402
