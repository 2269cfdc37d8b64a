// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "capstan/hal/cia402_sim/simulated_drive.hpp"

namespace capstan::drive_sim {

/// What a drive, or something else on its bus, can do wrong from some moment on.
enum class Mischief : std::uint8_t {
  kSilence,         ///< the drive sends nothing any more
  kNoHeartbeat,     ///< it sends all but heartbeats
  kShortStatus,     ///< its status messages have three bytes
  kDoubleStatus,    ///< each comes twice, with another position
  kBadStatus,       ///< its statusword stands for no state
  kFault,           ///< over-current: emergency 2310, once
  kRestart,         ///< its supply fails for a moment, once
  kShortHeartbeat,  ///< its heartbeats have no byte
  kBadHeartbeat,    ///< its heartbeats name a state that does not exist
  kShortEmergency,  ///< it sends emergency messages of two bytes
  kForeignSync,     ///< somebody else sends SYNC
  kForeignNode,     ///< somebody sends as another node, and with long identifiers
  kFlood,           ///< somebody repeats the drive's status message as fast as the bus takes it
};

struct Incident {
  double at_s = 0.0;  ///< after the first drive gave torque
  Mischief mischief = Mischief::kSilence;
  std::uint8_t node = 0;
};

/// "SECONDS:KIND:NODE". Throws std::runtime_error with "sentence; cure".
auto parse_incident(const std::string& text) -> Incident;
auto incident_kinds() -> std::string;

/// Several drives on one bus, what happens to them, and a record of when torque came and went. Frames in, frames out.
class DriveBus {
 public:
  /// @param out  gets one line for each change of a drive's torque; outlives this object
  DriveBus(std::span<const std::uint8_t> nodes, std::vector<Incident> incidents, std::ostream& out,
           const std::map<std::uint8_t, Peculiarities>& peculiarities = {});

  /// A frame from the bus. @returns what the drives send for it
  auto receive(const Frame& frame, Time now) -> std::vector<Frame>;
  /// What happens by itself. Call it every millisecond.
  auto tick(Time now) -> std::vector<Frame>;

  [[nodiscard]] auto drives() -> std::vector<SimulatedDrive>& { return drives_; }
  /// SYNCs seen, and the least and greatest time between two while a drive gave torque.
  void print_summary();

 private:
  void watch(Time now);
  auto spoil(const SimulatedDrive& drive, std::vector<Frame> frames) const -> std::vector<Frame>;
  void strike(const Incident& incident, Time now, std::vector<Frame>& out);
  void go_on(Time now, std::vector<Frame>& out);
  [[nodiscard]] auto suffers(std::uint8_t node, Mischief mischief) const -> bool;
  [[nodiscard]] auto since_s(Time now) const -> double;

  std::vector<SimulatedDrive> drives_;
  std::vector<bool> enabled_;
  std::vector<Incident> waiting_;
  std::vector<Incident> active_;
  std::ostream& out_;
  std::optional<Time> began_;  // torque
  std::optional<Time> struck_;
  std::optional<Time> last_sync_;
  std::uint64_t syncs_ = 0;
  std::uint64_t syncs_at_strike_ = 0;
  Time shortest_ = Time::max();
  Time longest_{};
};

}  // namespace capstan::drive_sim
