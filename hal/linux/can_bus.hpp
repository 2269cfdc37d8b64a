// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "capstan/hal/cia402/bus_budget.hpp"
#include "capstan/hal/cia402/bus_master.hpp"
#include "capstan/hal/cia402/drive_profile.hpp"
#include "capstan/hal/linux/can_socket.hpp"

namespace capstan {

/// One bus and the drives on it, as on the command line.
struct CanBusSetup {
  std::string name;  ///< interface, or unix:PATH of a drive simulator
  std::vector<std::uint8_t> nodes;
};

struct CanSetup {
  std::vector<CanBusSetup> buses;
  cia402::PdoLayout layout = cia402::PdoLayout::kSeparate;
  bool fd = false;
  bool watchdog = false;                         ///< a line outside the bus takes torque away when this program stops
  std::vector<cia402::DriveProfile> profiles{};  ///< before those that are known
  bool (*interrupted)() = nullptr;               ///< asked while drives are set up: true gives it up
};

/// CanSetup::interrupted said so.
struct SetUpInterrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Socket, protocol and journal of one bus whose drives are set up. Its rt_ functions belong to the cycle, the journal
/// may be read by anybody.
class CanBus {
 public:
  /// Checks the interface and the bus budget, which it prints, sets up every drive, says what it found there, and
  /// leaves them operational and without torque. Takes about a second, with slow drives up to a minute. Throws
  /// std::runtime_error with "sentence; cure" if any drive is not fit, and leaves none in operation then.
  CanBus(const CanBusSetup& bus, const CanSetup& setup, std::ostream& out);
  /// The same on a socket that is there already.
  CanBus(CanSocket socket, const CanBusSetup& bus, const CanSetup& setup, std::ostream& out);
  CanBus(const CanBus&) = delete;
  auto operator=(const CanBus&) -> CanBus& = delete;
  /// Takes the drives out of operation.
  ~CanBus();

  /// Takes all that has arrived while other buses were set up. Before the first cycle only: it takes what it takes.
  void catch_up();
  /// Takes what has arrived, at most as much as a bus carries in a cycle.
  void rt_receive(std::span<AxisSensed> axes);
  /// Steps the drives; then look whether every bus is sound.
  void rt_decide(std::span<const AxisDrive> axes) { master_.rt_decide(axes); }
  [[nodiscard]] auto rt_sound() const -> bool { return master_.rt_sound(); }
  /// @returns whether everything was handed to the kernel
  auto rt_send(bool torque) -> bool;

  [[nodiscard]] auto name() const -> const std::string& { return name_; }
  [[nodiscard]] auto master() const -> const cia402::BusMaster& { return master_; }
  [[nodiscard]] auto journal() const -> const cia402::Journal& { return *journal_; }

 private:
  std::string name_;
  CanSocket socket_;
  std::unique_ptr<cia402::Journal> journal_;
  std::vector<cia402::DriveSetting> settings_;
  cia402::BusMaster master_;
};

/// One line: what a cycle asks of the bus and what it may. Throws std::runtime_error with the cure if it does not fit.
/// @param budget  what the drives need
auto budget_line(const std::string& bus, std::size_t drives, const cia402::BusBudget& budget,
                 const cia402::BitRates& rates) -> std::string;

}  // namespace capstan
