// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/sim/sim_board.hpp"
#include "capstan/tools/apply/shell_client.hpp"

namespace capstan::tools {

/// The person wants it to end. No Refusal: nobody may take it for what a motor or a joint did.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped on request, torque is off") {}
};

/// A board's shell, one line out and one answer back.
class BoardShell {
 public:
  BoardShell() = default;
  BoardShell(const BoardShell&) = delete;
  auto operator=(const BoardShell&) -> BoardShell& = delete;
  virtual ~BoardShell() = default;
  /// The lines of the answer, without its "ok". Throws Refusal with the board's sentence.
  auto ask(const std::string& line) -> std::vector<std::string>;
  /// Once this is not 0 the next ask() throws Stopped. Those behind it put back what was changed, and are answered;
  /// torque is not given any more.
  void stop_by(const volatile std::sig_atomic_t& flag) { stop_ = &flag; }

 protected:
  [[nodiscard]] auto stopping() const -> bool { return stop_ != nullptr && *stop_ != 0; }

 private:
  virtual auto do_ask(const std::string& line) -> std::vector<std::string> = 0;
  const volatile std::sig_atomic_t* stop_ = nullptr;
  bool told_ = false;  // that it is to stop
};

/// Over a port, as ShellClient takes it.
class PortShell final : public BoardShell {
 public:
  explicit PortShell(const std::string& port) : shell_(port) {}

 private:
  auto do_ask(const std::string& line) -> std::vector<std::string> override;
  ShellClient shell_;
};

/// To a simulated board in this process, which runs as fast as it goes while it answers.
class SimShell final : public BoardShell {
 public:
  explicit SimShell(const sim::Scenario& scenario) : SimShell(scenario, nullptr) {}
  /// On banks that outlive it: what a board had saved is there when its power comes back.
  SimShell(const sim::Scenario& scenario, Banks& banks) : SimShell(scenario, &banks) {}
  [[nodiscard]] auto board() -> SimBoard& { return board_; }
  /// Furthest that motor and joint have been from where they began, rad, since this was called last.
  struct Way {
    double motor_rad = 0.0, joint_rad = 0.0, seconds = 0.0;
  };
  auto take_way() -> Way;

 private:
  class Sink final : public TextSink {
   public:
    std::string text;

   private:
    void do_write(std::string_view written) override { text.append(written); }
  };
  SimShell(const sim::Scenario& scenario, Banks* banks)
      : board_(scenario, banks == nullptr ? banks_ : *banks, sink_, false) {
    board_.tick();
  }
  auto do_ask(const std::string& line) -> std::vector<std::string> override;
  void tick();

  FileBanks banks_ = FileBanks::temporary();
  Sink sink_;
  SimBoard board_;
  bool begun_ = false;
  double motor0_ = 0.0, joint0_ = 0.0;
  Way way_;
};

}  // namespace capstan::tools
