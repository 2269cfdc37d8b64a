// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/setup_steps.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace capstan::cia402 {
namespace {

using Action = SetupStep::Action;
using Need = SetupStep::Need;
using Meaning = SetupStep::Meaning;

constexpr std::size_t kPdosOfMostDrives = 4;
constexpr const char* kOtherDrive = "use a drive for this profile and mode";
constexpr const char* kOtherMapping = "use a drive whose messages can be mapped, or leave out --pdo packed";

auto hex(std::uint32_t value, int digits) -> std::string {
  std::array<char, 16> text{};
  static_cast<void>(std::snprintf(text.data(), text.size(), "%0*X", digits, value));
  return text.data();
}

auto heartbeat_of_master(std::uint32_t time_ms) -> std::uint32_t {
  return std::uint32_t{kMasterNode} << 16U | time_ms;
}

// Stored objects that push, turn round or limit although nobody asks for it.
void add_stored(std::vector<SetupStep>& steps) {
  steps.push_back({.object = {0x607E, 0, 1, "polarity"},
                   .need = Need::kIfThere,
                   .values = {0},
                   .cure = "with positions reversed and torque not, it would run away; set this object to 0 with the "
                           "maker's tool"});
  steps.push_back({.object = {0x60B2, 0, 2, "torque offset"},
                   .need = Need::kIfThere,
                   .values = {0},
                   .cure = "it would give torque without a command; set this object to 0 with the maker's tool"});
  for (const Object& limit :
       {Object{0x6072, 0, 2, "max torque"}, Object{0x6073, 0, 2, "max current"},
        Object{0x60E0, 0, 2, "positive torque limit"}, Object{0x60E1, 0, 2, "negative torque limit"}}) {
    steps.push_back({.object = limit,
                     .action = Action::kRead,
                     .need = Need::kIfThere,
                     .values = {},
                     .meaning = Meaning::kTorqueLimit});
  }
}

// What the drive does when this firmware or the drive itself fails. A heartbeat every 40 ms has to stay out twice.
void add_reactions(std::vector<SetupStep>& steps) {
  const auto best_ms = static_cast<std::uint32_t>(kHeartbeatTimeout.count());
  steps.push_back({.object = {0x1016, 1, 4, "consumer heartbeat time"},
                   .need = Need::kOnLoss,
                   .values = {heartbeat_of_master(best_ms), heartbeat_of_master(100), heartbeat_of_master(150),
                              heartbeat_of_master(200)},
                   .meaning = Meaning::kConsumerTime,
                   .lost = "its torque goes that much later when this firmware is gone"});
  steps.push_back({.object = {0x1029, 1, 1, "error behaviour"},
                   .need = Need::kOnLossIfThere,
                   .values = {0, 2},  // pre-operational, stopped; 1 would be no change
                   .lost = "it stops instead of becoming pre-operational when this firmware is gone"});
  steps.push_back({.object = {0x1017, 0, 2, "producer heartbeat time"},
                   .values = {static_cast<std::uint32_t>(kHeartbeatPeriod.count()), 50, 80},
                   .lost = "fewer of its heartbeats may be missed",
                   .cure = "without its heartbeat a restart would not be seen; use another drive"});
  steps.push_back({.object = {0x605A, 0, 2, "quick stop option code"},
                   .need = Need::kOptional,
                   .values = {0, 2, 1},
                   .lost = "in a quick stop the drive brakes in its own way before its torque goes off"});
  steps.push_back({.object = {0x605E, 0, 2, "fault reaction option code"},
                   .need = Need::kOptional,
                   .values = {0, 2, 1},
                   .lost = "in a fault it brakes in its own way before its torque goes off"});
  steps.push_back({.object = {0x6007, 0, 2, "abort connection option code"},
                   .need = Need::kOnLoss,
                   .values = {1, 2},
                   .lost = "it takes its voltage off instead of going into fault"});
}

void add_mode(std::vector<SetupStep>& steps) {
  steps.push_back({.object = {0x6060, 0, 1, "mode of operation"}, .values = {kTorqueMode}, .cure = kOtherDrive});
  const char* const lost = "it does not know that set values come every 1 ms, which torque mode can do without";
  steps.push_back(
      {.object = {0x60C2, 1, 1, "interpolation time"}, .need = Need::kOptional, .values = {1}, .lost = lost});
  steps.push_back({.object = {0x60C2, 2, 1, "interpolation time exponent"},
                   .need = Need::kOptional,
                   .values = {0xFD},
                   .lost = lost});
}

// The order is the standard's: not valid, no objects, objects, their number, how it is triggered, valid (CiA
// 301 7.5.2.36). Bit 30 means nothing in an RPDO, and yet some drives insist on it, and others on its absence.
void add_pdo(std::vector<SetupStep>& steps, const PdoMap& map, std::uint16_t communication, std::uint16_t mapping,
             std::size_t number) {
  const auto com = static_cast<std::uint16_t>(communication + number);
  const auto list = static_cast<std::uint16_t>(mapping + number);
  const bool sent = communication == 0x1800;
  const Meaning meaning = sent ? Meaning::kStatusMapping : Meaning::kNothing;
  const Object id{com, 1, 4, "PDO identifier"};
  const Object count{list, 0, 1, "number of mapped objects"};
  steps.push_back(
      {.object = id, .action = Action::kDisable, .values = {}, .mask = kPdoNotValid, .cure = kOtherMapping});
  steps.push_back({.object = count, .values = {0}, .cure = kOtherMapping});
  for (std::size_t i = 0; i < map.count; ++i) {
    steps.push_back({.object = {list, static_cast<std::uint8_t>(i + 1), 4, "mapped object"},
                     .values = {map.word(i)},
                     .meaning = meaning,
                     .cure = kOtherMapping});
  }
  steps.push_back({.object = count, .values = {map.count}, .meaning = meaning, .cure = kOtherMapping});
  const std::uint32_t other_type = map.transmission == PdoMap::kAtOnce ? 254U : sent ? map.transmission : 0U;
  steps.push_back({.object = {com, 2, 1, "PDO transmission type"},
                   .values = {map.transmission, other_type},
                   .lost = "which means the same here",
                   .cure = kOtherMapping});
  const std::uint32_t flag = sent ? kPdoNoRemote : 0;
  steps.push_back({.object = id,
                   .values = {map.id | flag, map.id | (flag ^ kPdoNoRemote)},
                   .mask = ~kPdoNoRemote,
                   .cure = kOtherMapping});
}

// What the drive's maker or somebody before us left switched on would load the bus or move the motor.
void silence_pdos(std::vector<SetupStep>& steps, std::uint16_t communication, std::size_t from) {
  for (std::size_t i = from; i < kPdosOfMostDrives; ++i) {
    steps.push_back({.object = {static_cast<std::uint16_t>(communication + i), 1, 4, "PDO identifier"},
                     .action = Action::kDisable,
                     .need = Need::kIfThere,
                     .values = {},
                     .mask = kPdoNotValid});
  }
}

void add_messages(std::vector<SetupStep>& steps, const DriveMaps& maps) {
  add_pdo(steps, maps.torque, 0x1400, 0x1600, 0);
  const bool two = maps.controlword.count != 0;
  if (two) {
    add_pdo(steps, maps.controlword, 0x1400, 0x1600, 1);
  }
  silence_pdos(steps, 0x1400, two ? 2 : 1);
  std::size_t sent = 0;
  for (const PdoMap& status : maps.status) {
    if (status.count != 0) {
      add_pdo(steps, status, 0x1800, 0x1A00, sent++);
    }
  }
  silence_pdos(steps, 0x1800, sent);
}

void apply_profile(std::vector<SetupStep>& steps, const DriveProfile& profile) {
  for (const DriveProfile::Values& entry : profile.values) {
    for (SetupStep& step : steps) {
      if (step.object == entry.object) {
        step.values = entry.values;
      }
    }
  }
}

}  // namespace

auto object_text(const Object& object) -> std::string {
  return "object " + hex(object.index, 4) + ':' + hex(object.subindex, 2) + ", " + object.name;
}

auto SetupStep::text(std::uint32_t value) const -> std::string {
  constexpr std::uint32_t kTime = 0xFFFF;  // below the node's number
  return meaning == Meaning::kConsumerTime ? std::to_string(value & kTime) + " ms"
                                           : std::to_string(value) + " (" + hex(value, 4) + "h)";
}

auto SetupStep::rank(std::uint32_t value) const -> std::size_t {
  const auto found =
      std::find_if(values.begin(), values.end(), [&](std::uint32_t other) { return (value & mask) == (other & mask); });
  return static_cast<std::size_t>(found - values.begin());
}

auto identity_steps() -> std::vector<SetupStep> {
  return {{.object = {0x1000, 0, 4, "device type (a drive, 402)"},
           .action = Action::kRead,
           .values = {402},
           .mask = 0xFFFF,
           .cure = kOtherDrive},
          {.object = {0x1018, 1, 4, "vendor"},
           .action = Action::kRead,
           .need = Need::kIfThere,
           .values = {},
           .meaning = Meaning::kVendor},
          {.object = {0x1018, 2, 4, "product code"},
           .action = Action::kRead,
           .need = Need::kIfThere,
           .values = {},
           .meaning = Meaning::kProduct}};
}

auto setup_steps(const DriveMaps& maps, const DriveProfile& profile) -> std::vector<SetupStep> {
  std::vector<SetupStep> steps = {{.object = {0x6502, 0, 4, "supported modes (cyclic synchronous torque, bit 9)"},
                                   .action = Action::kRead,
                                   .need = Need::kIfThere,
                                   .values = {0x200},
                                   .mask = 0x200,
                                   .cure = kOtherDrive}};
  steps.push_back({.object = object::kControlword,
                   .need = Need::kOptional,
                   .values = {controlword::kDisableVoltage},
                   .lost = "that its voltage is off while it is set up is not certain"});
  if (!profile.rated_current_ma) {
    steps.push_back({.object = profile.rated_current.value_or(Object{0x6075, 0, 4, "motor rated current"}),
                     .action = Action::kRead,
                     .values = {},
                     .meaning = Meaning::kRatedCurrent,
                     .cure = "torques on the bus are thousandths of it; say it with rated_current_ma, or where it is "
                             "with rated_current, in a drive profile (--profile FILE)"});
  }
  for (const DriveProfile::Values& entry : profile.required) {
    steps.push_back({.object = entry.object, .values = entry.values});
  }
  add_stored(steps);
  add_reactions(steps);
  add_mode(steps);
  add_messages(steps, maps);
  steps.push_back({.object = object::kModeDisplay,
                   .action = Action::kRead,
                   .need = Need::kOptional,
                   .values = {},
                   .meaning = Meaning::kMode,
                   .lost = "that it is in torque mode is known from object 6060 alone"});
  apply_profile(steps, profile);
  return steps;
}

}  // namespace capstan::cia402
