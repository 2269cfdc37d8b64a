// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <span>

#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/loop/machine.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/hal/sim/scenario.hpp"

namespace capstan {

/// The firmware on a simulated instrument of one to four axes: every object built once, as on any board.
class SimBoard final : public Board {
 public:
  /// @param sink  receives the shell's answers   @param echo  the shell talks to a person
  /// @param fault_memory  FaultLog::words_for(axes) words that outlive this object; empty: no fault log
  /// Throws std::runtime_error with "sentence; cure" if the instrument has more axes than a board.
  SimBoard(const sim::Scenario& scenario, Banks& banks, TextSink& sink, bool echo,
           std::span<std::uint32_t> fault_memory = {});
  ~SimBoard();

  /// One cycle of 1 ms: firmware, then plant. `references_rad` streams a reference to each of the first joints, as a
  /// host over a link would. Throws std::runtime_error if the plant diverged.
  void tick(std::span<const double> references_rad = {});

  /// One cycle in which supplies of the bench drive the motors with these currents, one per axis; the firmware measures
  /// and estimates, and nothing that it wants reaches a motor. None: it drives them again. Throws as tick does.
  void tick_on_bench(std::span<const double> currents_a);

  [[nodiscard]] auto axes() const -> std::size_t;

  /// How long after its time a cycle began, for `timing`; whoever ticks in real time knows.
  void set_lateness(std::chrono::nanoseconds late);
  /// The operator wants to start anew: make another board on the same banks.
  [[nodiscard]] auto reboot_wanted() const -> bool { return reboot_wanted_; }

  [[nodiscard]] auto name() const -> const char* override { return "sim"; }
  void print_timing(Print& out) const override;
  void reboot() override { reboot_wanted_ = true; }
  /// `fail TARGET KIND [at S] [for S] [amount A] [axis N]`: a fault of the plant, `at` counted from now.
  [[nodiscard]] auto simulated() const -> bool override { return true; }
  auto run_command(std::string_view word, std::string_view rest, Print& out) -> BoardAnswer override;
  void print_commands(Print& out) const override;

  [[nodiscard]] auto shell() -> Shell& { return shell_; }
  [[nodiscard]] auto machine() const -> const Machine&;
  [[nodiscard]] auto truth(std::size_t axis) const -> const sim::Truth&;
  /// The console is gone, see Application.
  void link_lost();

 private:
  class Joints;
  template <std::size_t Axes, class PlantType>
  class JointsOf;
  static auto make_joints(const sim::Scenario& scenario, Banks& banks, std::span<std::uint32_t> fault_memory)
      -> std::unique_ptr<Joints>;

  std::unique_ptr<Joints> joints_;
  Shell shell_;
  bool reboot_wanted_ = false;
  bool in_real_time_ = false;
  std::chrono::microseconds late_{};
  std::chrono::microseconds latest_{};
};

}  // namespace capstan
