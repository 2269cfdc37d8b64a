// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "firmware/machine.hpp"
#include "firmware/shell.hpp"
#include "hal/sim/plant.hpp"
#include "hal/sim/scenario.hpp"

namespace capstan {

/// The firmware on a simulated instrument of one to four axes: every object built once, as on any board.
class SimBoard {
 public:
  /// @param sink  receives the shell's answers   @param echo  the shell talks to a person
  /// Throws std::runtime_error with "sentence; cure" if the instrument has more axes than a board.
  SimBoard(const sim::Scenario& scenario, Banks& banks, TextSink& sink, bool echo);
  ~SimBoard();

  /// One cycle of 1 ms: firmware, then plant. `references_rad` streams a reference to each of the first joints, as a
  /// host over a link would. Throws std::runtime_error if the plant diverged.
  void tick(std::span<const double> references_rad = {});

  /// One cycle in which supplies of the bench drive the motors with these currents, one per axis; the firmware measures
  /// and estimates, and nothing that it wants reaches a motor. Throws as tick does.
  void tick_on_bench(std::span<const double> currents_a);

  [[nodiscard]] auto axes() const -> std::size_t;
  [[nodiscard]] auto shell() -> Shell& { return shell_; }
  [[nodiscard]] auto machine() const -> const Machine&;
  [[nodiscard]] auto truth(std::size_t axis) const -> const sim::Truth&;
  /// The console is gone, see Application.
  void link_lost();

 private:
  class Joints;
  template <std::size_t Axes, class PlantType>
  class JointsOf;
  static auto make_joints(const sim::Scenario& scenario, Banks& banks) -> std::unique_ptr<Joints>;

  std::unique_ptr<Joints> joints_;
  Shell shell_;
};

}  // namespace capstan
