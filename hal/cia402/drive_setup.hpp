// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capstan/hal/cia402/drive_link.hpp"
#include "capstan/hal/cia402/sdo_client.hpp"

namespace capstan::cia402 {

/// One thing to be made sure of in a drive's object dictionary.
struct SetupStep {
  enum class Action : std::uint8_t {
    kExpect,      ///< must be so
    kLearn,       ///< the rated current
    kWrite,       ///< written, then read back: a drive that keeps another value is refused
    kWriteIfAny,  ///< the same if the drive has the object at all
  };
  Action action = Action::kWrite;
  Object object;
  std::uint32_t value = 0;
  std::uint32_t mask = 0xFFFFFFFF;  ///< bits that are compared
};

/// Everything a drive needs before it may be enabled: that it is one with the mode we use, what it does when it loses
/// us (1016, 6007, 605A, 605E: torque off), the mode, and which objects travel in its messages.
auto setup_steps(const DriveMaps& maps) -> std::vector<SetupStep>;

/// Takes one drive from whatever state to operational, over its SDO. For the time before the cycle: it allocates. No
/// clock, no socket: frames and moments are handed in.
class DriveSetup {
 public:
  enum class Phase : std::uint8_t { kRestarting, kConfiguring, kStarting, kDone, kFailed };

  /// @param source  the drive's number in the journal, from 1
  DriveSetup(std::uint8_t node, const DriveMaps& maps, Journal& journal, std::size_t source);

  /// What to send now, if anything; call it at least every 10 ms.
  auto next(Time now) -> std::optional<Frame>;
  /// Any frame from the bus.
  void receive(const Frame& frame);

  [[nodiscard]] auto phase() const -> Phase { return phase_; }
  /// "sentence; cure", once failed.
  [[nodiscard]] auto problem() const -> const std::string& { return problem_; }
  /// Once done.
  [[nodiscard]] auto setting() const -> DriveSetting { return {node_, rated_current_ma_, maps_}; }

 private:
  static constexpr std::chrono::seconds kPatience{3};  ///< with a drive that starts
  /// After a boot-up, in case it was the one of switching on and that of our reset is still to come.
  static constexpr std::chrono::milliseconds kSettling{50};

  auto begin(Time now) -> Frame;
  auto next_request(Time now) -> std::optional<Frame>;
  void finish_request();
  void check(std::uint32_t value);
  void fail(const std::string& problem);
  void fail_object(const Object& object, const std::string& what, const std::string& cure);

  std::uint8_t node_;
  DriveMaps maps_;
  std::vector<SetupStep> steps_;
  SdoClient sdo_;
  Phase phase_ = Phase::kRestarting;
  std::size_t step_ = 0;
  bool reading_back_ = false;
  std::optional<Time> since_;  // of the phase
  bool booted_ = false;
  std::optional<Time> ready_;
  std::int32_t rated_current_ma_ = 0;
  std::string problem_;
};

}  // namespace capstan::cia402
