// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capstan/hal/cia402/loss_trial.hpp"
#include "capstan/hal/cia402/setup_steps.hpp"

namespace capstan::cia402 {

/// Where a drive stands, and what is known besides it.
struct SetupTask {
  std::uint8_t node = 0;
  PdoLayout layout = PdoLayout::kSeparate;
  std::size_t place = 0;  ///< of this drive among the `drives` of its bus, from 0
  std::size_t drives = 1;
  bool watchdog = false;                        ///< a line outside the bus takes torque away when this firmware stops
  std::span<const DriveProfile> profiles = {};  ///< the first that fits is used; they outlive the set-up
};

/// Takes one drive from whatever state to operational, over its SDO: what it has is used, what is lost is said, and
/// only what safety needs is refused. For the time before the cycle: it allocates. No clock, no socket: frames and
/// moments are handed in.
class DriveSetup {
 public:
  enum class Phase : std::uint8_t { kRestarting, kConfiguring, kTrying, kReady, kStarting, kDone, kFailed };

  /// @param source  the drive's number in the journal, from 1
  DriveSetup(const SetupTask& task, Journal& journal, std::size_t source);

  /// What to send now, if anything; call it at least every 10 ms.
  auto next(Time now) -> std::optional<Frame>;
  /// Any frame from the bus.
  void receive(const Frame& frame);
  /// Makes it operational. Not before all drives of its bus are ready: a trial with one would stop the others.
  /// @pre phase() is kReady
  void start();

  [[nodiscard]] auto phase() const -> Phase { return phase_; }
  /// "sentence; cure", once failed.
  [[nodiscard]] auto problem() const -> const std::string& { return problem_; }
  /// Sentences: what was found otherwise than wanted, and what is lost by it.
  [[nodiscard]] auto notes() const -> const std::vector<std::string>& { return notes_; }
  /// Once done.
  [[nodiscard]] auto setting() const -> const DriveSetting& { return setting_; }

 private:
  enum class Stage : std::uint8_t { kReading, kWriting, kReadingBack };
  /// After a boot-up, in case it was the one of switching on and that of our reset is still to come.
  static constexpr std::chrono::milliseconds kSettling{50};
  static constexpr std::chrono::seconds kBootPatience{10};  ///< drives with a large memory to look through take 4 s
  static constexpr std::chrono::seconds kStartPatience{3};

  auto next_restarting(Time now) -> std::optional<Frame>;
  auto next_request(Time now) -> std::optional<Frame>;
  auto next_trial(Time now) -> std::optional<Frame>;
  auto next_starting(Time now) -> std::optional<Frame>;
  auto begin(Time now) -> Frame;
  void finish_request();
  void finish_reading(bool aborted);
  void try_value();
  void settle(std::size_t rank);
  void lack(const std::string& what);
  void learn();
  void learn_limit();
  void finish_step();
  void use_profile();
  void replan();
  void end_configuring();
  void enter(Phase phase);
  void note(const std::string& what);
  void fail(const std::string& problem);
  [[nodiscard]] auto step() const -> const SetupStep& { return steps_[step_]; }

  SetupTask task_;
  DriveProfile profile_;
  std::vector<SetupStep> steps_;
  SdoClient sdo_;
  std::optional<LossTrial> trial_;
  DriveSetting setting_;
  Phase phase_ = Phase::kRestarting;
  std::size_t step_ = 0;
  std::size_t first_own_step_ = 0;  // behind the identity's
  Stage stage_ = Stage::kReading;
  std::vector<std::uint32_t> candidates_;  // of this step
  std::size_t candidate_ = 0;
  std::uint32_t found_ = 0;    // what the object had before
  std::uint32_t present_ = 0;  // what it has
  std::uint32_t refusal_ = 0;  // the last abort code of this step
  std::optional<std::uint32_t> vendor_;
  std::optional<std::uint32_t> product_;
  std::string doubt_;          // why its torque might stay when this firmware is gone
  std::optional<Time> since_;  // of the phase
  bool booted_ = false;
  bool operational_ = false;
  std::optional<Time> ready_;
  std::vector<std::string> notes_;
  std::string problem_;
};

}  // namespace capstan::cia402
