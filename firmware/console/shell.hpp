// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/console/session.hpp"

namespace capstan {

/// The operator's console: one line in, one answer out, ending in "ok" or "error <name>: <sentence>; <cure>". It never
/// touches the cycle's data: it reads what the cycle publishes and hands it requests.
class Shell final : public Session {
 public:
  /// @param echo  true on a terminal: characters are echoed and the line can be edited
  Shell(Machine& machine, TextSink& sink, Board& board, bool echo) : Session(machine, sink, board, echo), echo_(echo) {}

  /// Feeds one received character.
  void receive(char c);
  /// Somebody has come: says what this is, how it stands and what to type, in lines that begin with '#', then prompts.
  void print_banner();
  /// Lets long answers go on; call it in the background loop.
  void poll();
  /// True while an answer is still under way: a line sent now would be refused. A `watch` takes one, and ends with it.
  [[nodiscard]] auto busy() const -> bool {
    return (stream_ != nullptr && !streams(Stream::Manner::kYields)) || disarming();
  }
  /// True while an answer goes on and a joint has torque, or an arming waits for its drives: who stops it must be
  /// heard, whatever waits before him.
  [[nodiscard]] auto must_listen() const -> bool {
    const State state = machine_.telemetry().state;
    return streams(Stream::Manner::kGoesOn) ? energised(state)
                                            : streams(Stream::Manner::kWaits) && state == State::kArmed;
  }
  /// The operator wants torque off although an answer is under way: takes it away at once and ends what streams. The
  /// `disarm` itself is still to be received and answered in its turn.
  void disarm_now();
  /// Whoever was there has gone: the next one does not find maintenance open.
  void peer_left() {
    maintenance_.close();
    end_beside();
    abandon();
  }

 private:
  /// Tab.
  void complete();
  void execute(std::string_view line);
  /// Whether a command that acts is not to be trusted as it came; says why.
  auto refuses_to_act(bool after_damage) -> bool;
  void cancel_stream();
  [[nodiscard]] auto streams(Stream::Manner manner) const -> bool {
    return stream_ != nullptr && stream_->manner() == manner;
  }

  bool echo_;
  bool last_damaged_ = false;  ///< the line before had characters that are no text
};

}  // namespace capstan
