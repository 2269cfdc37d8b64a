// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "capstan/firmware/console/line_editor.hpp"
#include "capstan/firmware/loop/board.hpp"
#include "capstan/firmware/loop/machine.hpp"
#include "capstan/firmware/parameters/parameter_text.hpp"
#include "capstan/firmware/safety/maintenance.hpp"
#include "capstan/firmware/safety/motor_commissioning.hpp"

namespace capstan {

/// The operator's console: one line in, one answer out, ending in "ok" or "error <name>: <sentence>; <cure>". It never
/// touches the cycle's data: it reads what the cycle publishes and hands it requests.
class Shell {
 public:
  static constexpr std::size_t kMaxAxes = 4;
  static constexpr std::size_t kLineLength = LineEditor::kLength;

  /// @param echo  true on a terminal: characters are echoed and the line can be edited
  Shell(Machine& machine, TextSink& sink, Board& board, bool echo);

  /// Feeds one received character.
  void receive(char c);
  /// Somebody has come: says what this is, how it stands and what to type, in lines that begin with '#', then prompts.
  void greet();
  /// Lets long answers go on; call it in the background loop.
  void poll();
  /// True while an answer is still under way: a line sent now would be refused. A `watch` takes one, and ends with it.
  [[nodiscard]] auto busy() const -> bool {
    return (activity_ != Activity::kIdle && activity_ != Activity::kWatching) || urgent_ != Urgent::kNone;
  }
  /// The operator wants torque off although an answer is under way: takes it away at once and ends what streams. The
  /// `disarm` itself is still to be received and answered in its turn.
  void disarm_now();
  /// Whoever was there has gone: the next one does not find maintenance open.
  void peer_left() {
    maintenance_.close();
    end_frames();
    abandon();
  }

 private:
  friend struct ShellCommands;
  enum class Activity : std::uint8_t {
    kIdle,
    kArming,
    kDisarming,
    kMoving,
    kApplying,
    kLogging,
    kDumping,
    kWatching,
    kDumpingFaults,
    kExperimenting,
    kCommissioning
  };
  enum class CommissioningStep : std::uint8_t { kMoves, kDither, kResting, kRising, kFastMoves, kTaking };
  /// joint number and group.name of "joint0.control.kp"
  struct Name {
    std::size_t axis = 0;
    const ParameterInfo* parameter = nullptr;
  };

  /// Tab.
  void complete();
  void execute(std::string_view line);
  /// Whether a command that acts is not to be trusted as it came; says why.
  auto refuses_to_act(bool after_damage) -> bool;
  void prompt();
  void ok();
  void error(const char* name, const char* sentence, const char* cure);
  void finish();
  void finish_arming();
  void print_fault(const char* what, const FaultInfo& entry);
  void print_warnings(WarningSet warnings);
  void print_tendons(const AxisTelemetry& joint);
  /// What is to be known about what was stored, each line behind `begin`; nothing if all is as it was saved.
  void print_load_report(const char* begin);
  void go_on_logging();
  void go_on_experimenting();
  void go_on_commissioning();
  auto begin_commissioning(CommissioningStep step) -> bool;
  void next_commissioning_step();
  void refuse_commissioning(const char* problem);
  void take_commissioned();
  auto begin_recording(std::size_t axis, std::uint32_t every) -> bool;
  auto begin_recording(std::uint32_t every) -> bool;
  auto end_recording() -> std::uint32_t;
  void print_row(const SignalSample& sample);
  void print_stiffness();
  void go_on_dumping();
  void go_on_dumping_faults();
  void go_on_watching();
  void go_on_framing();
  void send_schema();
  void send_sample(const SignalSample& sample);
  void end_frames();
  void end_stream();

  auto parse_name(std::string_view text, Name& name) -> bool;
  auto parse_axis(std::string_view& text, std::size_t& axis) -> bool;
  auto begin_staging() -> bool;
  void abandon();
  auto stage(std::string_view arguments) -> bool;
  void commit();
  void print_refusal(const SetAnswer& answer);

  Machine& machine_;
  TextSink& sink_;
  Print out_;
  Board& board_;
  bool echo_;

  LineEditor editor_;
  bool last_damaged_ = false;  ///< the line before had characters that are no text

  Activity activity_ = Activity::kIdle;
  std::span<AxisConfig> staged_;  ///< the machine's room for it, while this console has it
  bool staging_ = false;
  Maintenance maintenance_;
  RecorderSetup recorded_;  ///< by a log, an experiment or the frames; one of them at a time
  bool framing_ = false;
  std::uint16_t schema_ = 0;       ///< CRC of the schema that was sent last ...
  std::uint32_t schema_tick_ = 0;  ///< ... and when
  std::int32_t log_site_ = -1;     ///< the site that is palpated; -1: none
  bool palpating_ = false;         ///< with a law that tells stiffness
  std::uint32_t log_left_ = 0;     ///< rows; of an experiment 0 when it is to end
  std::uint32_t log_dropped_before_ = 0;
  MotorCommissioning commissioning_;
  CommissioningStep commissioning_step_ = CommissioningStep::kMoves;
  ExperimentSetup setup_;      ///< of an experiment or of commissioning: too large for the motor board's stack
  ScopeSetup scope_;           ///< as typed so far
  std::size_t dump_next_ = 0;  ///< sample
  std::array<Signal, ScopeSetup::kMostChannels> watched_{};
  std::size_t watched_count_ = 0;
  std::uint32_t watch_every_ = 0;  ///< ms
  std::uint32_t watch_last_ = 0;   ///< tick
  enum class Urgent : std::uint8_t { kNone, kWanted, kPosted };
  Urgent urgent_ = Urgent::kNone;  ///< disarm_now() until the cycle has carried it out
};

}  // namespace capstan
