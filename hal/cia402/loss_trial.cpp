// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/loss_trial.hpp"

namespace capstan::cia402 {

void LossTrial::enter(Part part, Time now) {
  part_ = part;
  since_ = now;
  written_ = false;
}

auto LossTrial::write(std::uint16_t controlword, Time now) -> Frame {
  asked_ = true;
  written_ = true;
  return sdo_.write(object::kControlword, controlword, now);
}

auto LossTrial::next(Time now) -> std::optional<Frame> {
  since_ = since_.value_or(now);
  const bool present = part_ == Part::kReady || part_ == Part::kSwitchedOn;
  if (present && (!heartbeat_ || now - *heartbeat_ >= kHeartbeatPeriod)) {
    heartbeat_ = now;
    return heartbeat_frame(kMasterNode, NmtState::kOperational);
  }
  if (const auto segment = sdo_.follow_up(now)) {
    return segment;
  }
  if (done_ || (asked_ && sdo_.poll(now) == SdoClient::State::kWaiting)) {
    return std::nullopt;
  }
  if (asked_) {
    asked_ = false;
    judge(now);
  }
  return done_ ? std::nullopt : request(now);
}

auto LossTrial::request(Time now) -> std::optional<Frame> {
  switch (part_) {
    case Part::kReady:
    case Part::kSwitchedOn:
      if (!written_) {
        return write(part_ == Part::kReady ? controlword::kShutdown : controlword::kSwitchOn, now);
      }
      break;
    case Part::kSilent:
      if (now - *since_ < kSilence) {
        return std::nullopt;
      }
      enter(Part::kLook, now);
      break;
    case Part::kLook:
      break;
    case Part::kOff:
    case Part::kOffAgain:
      return write(controlword::kDisableVoltage, now);
    case Part::kReset:
      return write(controlword::kFaultReset, now);
  }
  asked_ = true;
  return sdo_.read(object::kStatusword, now);
}

// What an answer means, be it to a controlword or to the question for the state.
void LossTrial::judge(Time now) {
  const bool answered = sdo_.state() == SdoClient::State::kDone;
  const DriveState state = answered ? drive_state(static_cast<std::uint16_t>(sdo_.value())) : DriveState::kUnknown;
  switch (part_) {
    case Part::kReady:
    case Part::kSwitchedOn: {
      const bool first = part_ == Part::kReady;
      if (answered && written_ && state == (first ? DriveState::kReadyToSwitchOn : DriveState::kSwitchedOn)) {
        enter(first ? Part::kSwitchedOn : Part::kSilent, now);
      } else if (!answered || now - *since_ > kPatience) {
        enter(Part::kOff, now);
      }
      break;
    }
    case Part::kSilent:
      break;
    case Part::kLook:
      if (answered) {
        const bool still =
            state == DriveState::kSwitchedOn || state == DriveState::kOperationEnabled || state == DriveState::kUnknown;
        verdict_ = still ? Verdict::kGoesOn : Verdict::kStops;
      }
      enter(Part::kOff, now);
      break;
    case Part::kOff:
      enter(Part::kReset, now);
      break;
    case Part::kReset:
      enter(Part::kOffAgain, now);
      break;
    case Part::kOffAgain:
      done_ = true;
      break;
  }
}

}  // namespace capstan::cia402
