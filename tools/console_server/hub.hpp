// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// The board's side of the bridge.
class BoardLine {
 public:
  BoardLine() = default;
  BoardLine(const BoardLine&) = delete;
  auto operator=(const BoardLine&) -> BoardLine& = delete;
  virtual ~BoardLine() = default;

  virtual void send(std::string_view bytes) = 0;
  /// Takes the torque away before anything else that waits to be sent.
  virtual void disarm() = 0;
  /// Who commanded is gone: the torque goes as on any board whose console leaves.
  virtual void peer_left() = 0;
  /// Milliseconds from sample to sample that the line can carry for eight signals.
  [[nodiscard]] virtual auto every_ms() const -> int = 0;
  /// True where the joint is a simulator of this program.
  [[nodiscard]] virtual auto starts_anew() const -> bool { return false; }
  /// Starts it anew, without torque. @param effect  that the firmware is not told of, "play=0.03"; empty: none
  /// Throws std::exception with a sentence; the board goes on then.
  virtual void start_anew(std::string_view effect);
};

/// One page.
class Guest {
 public:
  Guest() = default;
  Guest(const Guest&) = delete;
  auto operator=(const Guest&) -> Guest& = delete;
  virtual ~Guest() = default;

  virtual void bytes(std::string_view bytes) = 0;
  /// What the server itself has to say: "command EVERY_MS", "look EVERY_MS" (and " anew" where the board can be started
  /// so), "anew SENTENCE" (why it was not; nothing if it was), "cancel", "remark TEXT", "lost SENTENCE".
  virtual void say(std::string_view words) = 0;
  /// True while so much of what the board said still waits that the board had better be heard later (Backlog).
  [[nodiscard]] virtual auto behind() const -> bool { return false; }
};

/// What a WebSocket talks with.
class Talk {
 public:
  using Clock = std::chrono::steady_clock;
  Talk() = default;
  Talk(const Talk&) = delete;
  auto operator=(const Talk&) -> Talk& = delete;
  virtual ~Talk() = default;

  virtual void join(Guest& guest, Clock::time_point now) = 0;
  virtual void leave(Guest& guest) = 0;
  virtual void bytes(Guest& guest, std::string_view bytes) = 0;
  virtual void word(Guest& guest, std::string_view word, Clock::time_point now) = 0;
};

/// Joins one board and its pages: what the board says goes to all, what one page says goes to the board. Whoever came
/// first commands; the others look, and may take the torque away. The torque goes when the commanding page leaves or
/// falls silent.
class Hub final : public Talk {
 public:
  struct Listener {
    std::function<void(std::string_view)> bytes;
    std::function<void(std::string)> lost;  ///< with a sentence
    std::function<bool()> behind;           ///< somebody who listens does not keep up
  };
  /// Opens the board's line. Throws std::exception with a sentence.
  using Open = std::function<std::unique_ptr<BoardLine>(Listener)>;

  /// A page says "alive" five times within this; one that hangs or sleeps for longer has lost its line.
  static constexpr std::chrono::milliseconds kAliveWithin{1000};

  /// Opens the line; throws what it throws.
  explicit Hub(Open open);

  /// Whoever joins after the board was lost makes the hub try the line again.
  void join(Guest& guest, Clock::time_point now) override;
  void leave(Guest& guest) override;
  /// What a page sends to the board; only the commanding one is heard.
  void bytes(Guest& guest, std::string_view bytes) override;
  /// What a page says to the hub: "alive", "leave" (nobody watches any more), "disarm", "take" (wants to command),
  /// "anew EFFECT" (starts the simulated board anew).
  void word(Guest& guest, std::string_view word, Clock::time_point now) override;
  /// To be called several times a second.
  void look(Clock::time_point now);
  /// Lets go of the board, whose torque goes.
  void close();

  /// Hears everything that the board says, besides the pages.
  std::function<void(std::string_view)> overhear;
  /// Sends a line for the server itself, if no page commands.
  void send_unattended(std::string_view line);
  [[nodiscard]] auto commands(const Guest& guest) const -> bool { return commander_ == &guest; }
  [[nodiscard]] auto connected() const -> bool { return line_ != nullptr; }

 private:
  void open_line();
  void lost(const std::string& why);
  void command(Guest* guest, Clock::time_point now);
  void start_anew(Guest& guest, std::string_view effect, Clock::time_point now);
  [[nodiscard]] auto role_of(const Guest& guest) const -> std::string;
  void everyone(std::string_view words);

  Open open_;
  std::unique_ptr<BoardLine> line_;
  std::unique_ptr<BoardLine> broken_;  // its own callback said so: it ends later
  std::string why_lost_;
  std::vector<Guest*> guests_;
  Guest* commander_ = nullptr;
  bool attended_ = false;
  Clock::time_point alive_{};
};

}  // namespace capstan::tools
