// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/boards/browser/memory_banks.hpp"
#include "capstan/boards/sim/sim_board.hpp"
#include "capstan/firmware/console/shell_input.hpp"

namespace capstan {

/// The firmware on a simulated instrument, with its console as two streams of bytes. Time goes on by tick() only.
class BrowserBoard {
 public:
  /// @param scenario  TOML, as `capstan run --scenario` reads it; empty: one joint. Throws sim::ScenarioError, or
  /// std::runtime_error if the instrument has more axes than a board.
  explicit BrowserBoard(std::string_view scenario);
  /// The same from what was read already.
  explicit BrowserBoard(sim::Scenario scenario);

  /// Characters for the shell; returns how many found room. The others are to be given again after a tick.
  [[nodiscard]] auto receive(std::string_view bytes) -> std::size_t;
  /// One cycle of 1 ms and what the background does meanwhile. Throws std::runtime_error if the plant diverged.
  void tick();
  /// Whoever was at the console has gone: the torque goes, and what he staged or opened.
  void peer_left();
  void print_banner() { board_->shell().print_banner(); }
  /// What the shell said, text and frames. Whoever takes it clears it.
  [[nodiscard]] auto output() -> std::string& { return sink_.text; }

 private:
  /// Keeps what fits between two looks of the page; what comes beyond is dropped and counted, as on any board.
  struct Sink final : TextSink {
    static constexpr std::size_t kMost = std::size_t{1} << 20U;
    std::string text;

   private:
    void do_write(std::string_view more) override;
    [[nodiscard]] auto do_dropped() const -> std::uint32_t override { return dropped_; }
    std::uint32_t dropped_ = 0;
  };
  void start();

  sim::Scenario scenario_;
  MemoryBanks banks_;
  std::vector<std::uint32_t> fault_memory_;
  Sink sink_;
  std::optional<SimBoard> board_;
  std::optional<ShellInput> input_;
};

}  // namespace capstan
