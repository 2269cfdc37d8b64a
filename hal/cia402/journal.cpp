// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/journal.hpp"

namespace capstan::cia402 {
namespace {

constexpr const char* kWiring = "check cable, plugs and the termination of 120 ohm at both ends";
constexpr const char* kForeign = "find the other sender on this bus and remove it";
constexpr const char* kFirmware = "check that node number and firmware of the drive are those that were set up";
constexpr const char* kAnew = "remove the cause, then 'reboot' sets the drives up again";

constexpr std::array<AnomalyInfo, kAnomalies> kTable = {{
    {Anomaly::kStatusLength, "status_length", "a status message has another length than was mapped, and was not used",
     kForeign},
    {Anomaly::kStatusLate, "status_late", "a status message answered an earlier SYNC, and was not used",
     "take load off the bus, or look why the drive needs longer than a cycle"},
    {Anomaly::kStatusRepeated, "status_repeated", "the same status message came twice for one SYNC",
     "check that no two nodes have the same number"},
    {Anomaly::kStatusContradicts, "status_contradicts",
     "two different status messages came for one SYNC, and neither was used",
     "check that no two nodes have the same number, and that no other node sends on this bus"},
    {Anomaly::kStatusMissing, "status_missing", "no status message came for a SYNC", kWiring},
    {Anomaly::kStatusUnknown, "status_unknown", "the statusword matches no state of the standard", kFirmware},
    {Anomaly::kHeartbeatLength, "heartbeat_length", "a heartbeat is not one byte long, and does not count", kForeign},
    {Anomaly::kHeartbeatState, "heartbeat_state", "a heartbeat names no state of the standard, and does not count",
     kForeign},
    {Anomaly::kHeartbeatLost, "heartbeat_lost", "the drive's heartbeat stayed out",
     "check its supply and cable; 'reboot' sets the drives up again"},
    {Anomaly::kRestarted, "restarted", "the drive restarted and has lost its configuration",
     "check its supply; 'reboot' sets the drives up again"},
    {Anomaly::kNotOperational, "not_operational",
     "the drive left the state operational by itself or on another node's command", kAnew},
    {Anomaly::kEmergency, "emergency", "the drive sent an emergency message",
     "remove the cause; a drive in fault is reset once it has no torque to give"},
    {Anomaly::kEmergencyLength, "emergency_length", "an emergency message is not eight bytes long, and was not read",
     kForeign},
    {Anomaly::kSdoLength, "sdo_length", "an answer to a request is not eight bytes long, and was not read", kForeign},
    {Anomaly::kSdoUnexpected, "sdo_unexpected", "an answer came that was not expected",
     "find out who else configures this drive and end it"},
    {Anomaly::kSdoOtherObject, "sdo_other_object", "an answer is about another object than was asked for",
     "find out who else configures this drive and end it"},
    {Anomaly::kSdoCommand, "sdo_command", "an answer is of a kind that was not asked for", kFirmware},
    {Anomaly::kSdoSize, "sdo_size", "an object has another size than the standard gives it", kFirmware},
    {Anomaly::kSdoTimeout, "sdo_timeout", "the drive did not answer a request in time",
     "check its supply, node number, bit rate and cable"},
    {Anomaly::kDriveFault, "drive_fault", "the drive is in fault",
     "its emergency message says why; it is reset once it has no torque to give, then 'disarm' and 'arm'"},
    {Anomaly::kDroppedOut, "dropped_out", "the drive took its torque away by itself",
     "check its enable input (STO), supply and limits, then 'disarm' and 'arm'"},
    {Anomaly::kNotEnabled, "not_enabled", "the drive did not give torque within 200 ms",
     "check its enable input (STO) and supply, then 'disarm' and 'arm'"},
    {Anomaly::kAnswersLate, "answers_late",
     "the drive followed no controlword within 10 ms, or answer_ms of its profile, so its positions may be as old",
     "switch off filters and delays of its messages; if only its state machine is that slow, say so with answer_ms in "
     "a "
     "drive profile"},
    {Anomaly::kWrongMode, "wrong_mode", "the drive, once enabled, was in another mode than cyclic synchronous torque",
     "set mode of operation 10 with the maker's tool, then 'reboot'"},
    {Anomaly::kModeUnknown, "mode_unknown", "the drive did not say in which mode it was enabled, so it got no torque",
     "check the bus's load, then 'disarm' and 'arm'"},
    {Anomaly::kUnknownId, "unknown_id", "a message came that belongs to no drive here", kForeign},
    {Anomaly::kRemoteFrame, "remote_frame", "another node asked for a message by a remote frame, which is not answered",
     kForeign},
    {Anomaly::kExtendedFrame, "extended_frame", "a message with a long identifier came, which no drive here uses",
     kForeign},
    {Anomaly::kForeignSync, "foreign_sync", "another node sends SYNC, so drives act at the wrong time", kForeign},
    {Anomaly::kFlood, "flood", "more messages came in a cycle than one cycle reads", kForeign},
    {Anomaly::kSyncStuck, "sync_stuck",
     "the SYNC of the last cycle had not left when the next was due, so nothing more was sent", kWiring},
    {Anomaly::kSendQueueFull, "send_queue_full",
     "the kernel had no room for a message, which was dropped and not sent later",
     "take load off the bus; a longer queue would only make set values old"},
    {Anomaly::kLinkDown, "link_down", "the interface is down",
     "bring it up (ip link set can0 up type can bitrate 1000000), then 'reboot'"},
    {Anomaly::kSendFailed, "send_failed", "the kernel refused to send", kAnew},
    {Anomaly::kReceiveFailed, "receive_failed", "the kernel refused to receive", kAnew},
    {Anomaly::kReceiveLost, "receive_lost", "the kernel dropped messages that had arrived",
     "take load off the bus or the processor"},
    {Anomaly::kBusOff, "bus_off", "the controller took itself off the bus after too many errors",
     "check wiring and bit rate, bring the interface down and up, then 'reboot'"},
    {Anomaly::kErrorPassive, "error_passive", "the controller met so many errors that it may no longer signal them",
     kWiring},
    {Anomaly::kErrorWarning, "error_warning", "the controller met many errors", kWiring},
    {Anomaly::kControllerOverflow, "controller_overflow", "the controller lost messages before the kernel saw them",
     "give its interrupt a processor and a priority, or use a controller on the chip instead of one behind SPI"},
    {Anomaly::kNoAcknowledge, "no_acknowledge", "no node on the bus acknowledged a message",
     "check that a drive is connected, powered and has this bit rate"},
    {Anomaly::kBusError, "bus_error", "messages were destroyed on the bus", kWiring},
    {Anomaly::kControllerRestarted, "controller_restarted", "the controller went back on the bus by itself",
     "switch that off (ip link set can0 type can restart-ms 0): a bus that failed is started by a person"},
}};

constexpr auto table_is_in_order() -> bool {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    if (static_cast<std::size_t>(kTable[i].anomaly) != i) {
      return false;
    }
  }
  return true;
}
static_assert(table_is_in_order());

template <typename Code>
struct Text {
  Code code;
  const char* text;
};

// CiA 301 7.2.7 table 26; 7xxx and the finer codes of 2xxx to 5xxx and 8xxx from CiA 402-2 and the makers' common
// lists.
constexpr std::array kEmergencies = {
    Text<std::uint16_t>{0x0000, "the error is over"},
    Text<std::uint16_t>{0x2310, "continuous over-current"},
    Text<std::uint16_t>{0x2320, "short circuit or earth leakage"},
    Text<std::uint16_t>{0x2340, "short circuit on the motor's side"},
    Text<std::uint16_t>{0x3210, "over-voltage of the supply"},
    Text<std::uint16_t>{0x3220, "under-voltage of the supply"},
    Text<std::uint16_t>{0x4210, "the drive is too hot"},
    Text<std::uint16_t>{0x4310, "the motor is too hot"},
    Text<std::uint16_t>{0x5113, "the supply of the drive's electronics is too low"},
    Text<std::uint16_t>{0x5441, "the input for switching off, or safe torque off, is open"},
    Text<std::uint16_t>{0x6320, "a parameter of the drive is wrong"},
    Text<std::uint16_t>{0x7121, "the motor is blocked"},
    Text<std::uint16_t>{0x7305, "the encoder's signal failed"},
    Text<std::uint16_t>{0x7320, "the position sensor failed"},
    Text<std::uint16_t>{0x8110, "the drive lost messages"},
    Text<std::uint16_t>{0x8120, "the drive's controller is error passive"},
    Text<std::uint16_t>{0x8130, "the drive missed this firmware's heartbeat"},
    Text<std::uint16_t>{0x8140, "the drive came back from bus-off"},
    Text<std::uint16_t>{0x8150, "the drive's message identifier is used by another node"},
    Text<std::uint16_t>{0x81FD, "the drive is bus-off"},
    Text<std::uint16_t>{0x8210, "the drive got a message of the wrong length"},
    Text<std::uint16_t>{0x8220, "the drive got a message that is too long"},
    Text<std::uint16_t>{0x8240, "the drive got a SYNC of the wrong length"},
    Text<std::uint16_t>{0x8250, "the drive's set values stayed out"},
    Text<std::uint16_t>{0x8500, "the drive's position control failed"},
    Text<std::uint16_t>{0x8611, "the following error is too large"},
    Text<std::uint16_t>{0xFF01, "the drive needs a device of its own maker's"},
};

constexpr std::array<const char*, 16> kEmergencyClasses = {
    "no error",
    "an error that the drive does not name",
    "a current is wrong",
    "a voltage is wrong",
    "a temperature is wrong",
    "the drive's hardware failed",
    "the drive's software failed",
    "a module of the drive failed",
    "the drive's communication or control failed",
    "an error from outside",
    "an error of a class that the standard does not know",
    "an error of a class that the standard does not know",
    "an error of a class that the standard does not know",
    "an error of a class that the standard does not know",
    "an additional function of the drive failed",
    "an error that only the drive's manual explains",
};

// CiA 301 7.2.4.3.17 table 22.
constexpr std::array kAborts = {
    Text<std::uint32_t>{0x05030000, "toggle bit not alternated"},
    Text<std::uint32_t>{0x05040000, "its own time limit passed"},
    Text<std::uint32_t>{0x05040001, "unknown command"},
    Text<std::uint32_t>{0x05040005, "out of memory"},
    Text<std::uint32_t>{0x06010000, "access not supported"},
    Text<std::uint32_t>{0x06010001, "the object can only be written"},
    Text<std::uint32_t>{0x06010002, "the object can only be read"},
    Text<std::uint32_t>{0x06020000, "there is no such object"},
    Text<std::uint32_t>{0x06040041, "the object can not be mapped"},
    Text<std::uint32_t>{0x06040042, "the mapped objects are longer than a message"},
    Text<std::uint32_t>{0x06040043, "the parameters do not fit together"},
    Text<std::uint32_t>{0x06040047, "internal incompatibility"},
    Text<std::uint32_t>{0x06060000, "hardware error"},
    Text<std::uint32_t>{0x06070010, "wrong length"},
    Text<std::uint32_t>{0x06070012, "too long"},
    Text<std::uint32_t>{0x06070013, "too short"},
    Text<std::uint32_t>{0x06090011, "there is no such subindex"},
    Text<std::uint32_t>{0x06090030, "value out of range"},
    Text<std::uint32_t>{0x06090031, "value too high"},
    Text<std::uint32_t>{0x06090032, "value too low"},
    Text<std::uint32_t>{0x08000000, "general error"},
    Text<std::uint32_t>{0x08000020, "the value can not be stored"},
    Text<std::uint32_t>{0x08000021, "the value can not be stored, the drive is under local control"},
    Text<std::uint32_t>{0x08000022, "not in this state of the drive"},
};

template <typename Code, std::size_t Size>
auto find(const std::array<Text<Code>, Size>& table, Code code, const char* otherwise) -> const char* {
  for (const Text<Code>& entry : table) {
    if (entry.code == code) {
      return entry.text;
    }
  }
  return otherwise;
}

}  // namespace

auto info(Anomaly anomaly) -> const AnomalyInfo& {
  return kTable[static_cast<std::size_t>(anomaly)];
}

auto emergency_text(std::uint16_t code) -> const char* {
  return find(kEmergencies, code, kEmergencyClasses[code >> 12U]);
}

auto abort_text(std::uint32_t code) -> const char* {
  return find(kAborts, code, "a reason that the standard does not know");
}

}  // namespace capstan::cia402
