// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "firmware/application.hpp"
#include "firmware/shell.hpp"
#include "hal/sim/scenario.hpp"
#include "hal/sim/sim_io.hpp"

namespace capstan {

/// Parameter banks that forget: for runs that shall leave nothing behind.
class MemoryBanks final : public Banks {
 private:
  static constexpr std::size_t kSize = 16 * 1024;
  struct Bank {
    Bank() { bytes.fill(0xFF); }
    std::array<std::uint8_t, kSize> bytes{};
  };
  auto do_erase(int bank) -> bool override;
  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override;
  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override;

  std::array<Bank, kBanks> banks_;
};

/// The firmware on a simulated joint: every object built once, as on any board.
class SimBoard {
 public:
  /// @param sink  receives the shell's answers   @param echo  the shell talks to a person
  SimBoard(const sim::Scenario& scenario, Banks& banks, TextSink& sink, bool echo);

  /// One cycle of 1 ms: firmware, then plant. `reference_rad` streams a joint reference, as a host over a link would.
  /// Throws std::runtime_error if the plant diverged.
  void tick(std::optional<double> reference_rad = std::nullopt);

  [[nodiscard]] auto shell() -> Shell& { return shell_; }
  [[nodiscard]] auto application() -> Application<SimIo>& { return application_; }
  [[nodiscard]] auto plant() const -> const sim::Plant& { return plant_; }

 private:
  sim::Plant plant_;
  SimIo io_;
  Application<SimIo> application_;
  Shell shell_;
};

}  // namespace capstan
