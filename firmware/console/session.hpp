// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "capstan/firmware/console/line_editor.hpp"
#include "capstan/firmware/console/parts.hpp"
#include "capstan/firmware/console/stream.hpp"
#include "capstan/firmware/loop/board.hpp"
#include "capstan/firmware/loop/expect.hpp"
#include "capstan/firmware/loop/machine.hpp"
#include "capstan/firmware/parameters/parameter_text.hpp"
#include "capstan/firmware/safety/maintenance.hpp"
#include "capstan/firmware/safety/motor_commissioning.hpp"

namespace capstan {

/// What a command sees of the console: what it may ask, where it prints, and how its answer ends, at once or as a
/// stream. Every command ends in exactly one of ok(), error() and refused(), or begins a stream that will.
class Session {
 public:
  static constexpr std::size_t kMaxAxes = 4;
  static constexpr std::size_t kLineLength = LineEditor::kLength;
  /// joint number and group.name of "joint0.control.kp"
  struct Name {
    std::size_t axis = 0;
    const ParameterInfo* parameter = nullptr;
  };

  Session(const Session&) = delete;
  auto operator=(const Session&) -> Session& = delete;

  [[nodiscard]] auto machine() -> Machine& { return machine_; }
  [[nodiscard]] auto board() -> Board& { return board_; }
  [[nodiscard]] auto out() -> Print& { return out_; }
  [[nodiscard]] auto maintenance() -> Maintenance& { return maintenance_; }
  /// What the scope is to do, as typed so far.
  [[nodiscard]] auto scope_setup() -> ScopeSetup& { return scope_; }
  [[nodiscard]] auto characters_dropped() const -> std::uint32_t { return lines_.dropped(); }
  /// A `disarm` overtook and is under way to the cycle.
  [[nodiscard]] auto disarming() const -> bool { return disarming_; }

  void ok();
  void error(const char* name, const char* sentence, const char* cure);
  /// As error(), of one that is already printed.
  void refused();
  /// The error of a request that found the last one still under way.
  void busy_cycle();

  /// Room for the answer that goes on; begin() makes it go on. @pre no other is under way
  template <typename T>
  auto make() -> T& {
    CAPSTAN_EXPECT(stream_ == nullptr);
    return room_.template make<T>();
  }
  void begin(Stream& stream) { stream_ = &stream; }
  /// The same, with its first step taken at once.
  void answer(PartsStream& stream) {
    begin(stream);
    stream.step(*this);
  }
  /// The answer is ok() once the cycle has taken what it was given. The last act of an answer under way: its room goes.
  void answer_when_taken();
  /// Hands a request to the cycle, whose consent T answers; or says why not.
  template <typename T>
  void post(const Request& request) {
    if (machine_.post(request)) {
      begin(make<T>());
    } else {
      busy_cycle();
    }
  }

  /// One stream that answers nothing goes on beside the answers.
  template <typename T>
  auto make_beside() -> T& {
    return room_beside_.template make<T>();
  }
  void begin_beside(Stream& stream) { beside_ = &stream; }
  void end_beside();
  [[nodiscard]] auto has_beside() const -> bool { return beside_ != nullptr; }

  /// Takes "jointN" off the text.
  auto parse_axis(std::string_view& text, std::size_t& axis) -> bool;
  auto parse_name(std::string_view text, Name& name) -> bool;

  /// Takes the machine's room for a new set, with the one in force in it. False: another console has it, and that was
  /// answered.
  auto take_staging_room() -> bool;
  [[nodiscard]] auto staged() -> std::span<AxisConfig> { return staged_; }
  /// Gives the room back, and forgets what is in it.
  void abandon();
  /// `set` changes nothing until `commit`.
  void keep_staging() { staging_ = true; }
  [[nodiscard]] auto staging() const -> bool { return staging_; }

 protected:
  Session(Machine& machine, TextSink& sink, Board& board, bool echo)
      : machine_(machine), lines_(sink), out_(lines_), board_(board), editor_(out_, echo) {}
  ~Session() = default;

  Machine& machine_;
  LineSink lines_;  ///< flushed whenever the shell has had its turn
  Print out_;
  Board& board_;
  LineEditor editor_;
  Stream* stream_ = nullptr;
  Stream* beside_ = nullptr;
  Maintenance maintenance_;
  bool disarming_ = false;  ///< disarm_now() until the cycle has carried it out

 private:
  std::span<AxisConfig> staged_;  ///< the machine's room for it, while this console has it
  bool staging_ = false;
  ScopeSetup scope_;
  StreamRoom<(MotorCommissioning::kAvailable ? 1024 : 412)> room_;  // of the largest; make() tells
  StreamRoom<sizeof(RecorderSetup) + 3 * sizeof(void*)> room_beside_;
};

}  // namespace capstan
