// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402_sim/peculiarity.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace capstan::drive_sim {
namespace {

constexpr std::array kNames = {
    "reversed",      "reversed-for-good", "torque-offset",  "offset-for-good",   "max-torque",    "no-max-torque",
    "old-positions", "old-status",        "factory-pdos",   "no-6007",           "goes-on",       "no-605a",
    "no-605e",       "no-60c2",           "no-6061",        "no-1016",           "no-6075",       "no-607e",
    "constant",      "constant-period",   "quick-stop-2-6", "fault-reaction-2",  "heartbeat-100", "two-objects",
    "segmented-sdo", "slow-sdo",          "slow-boot",      "mode-when-enabled", "wrong-mode",    "stays",
    "stays-for-good"};
static_assert(kNames.size() == static_cast<std::size_t>(Peculiarity::kStaysForGood) + 1);

void switch_on_pdos(ObjectDictionary& objects, std::uint8_t node) {
  constexpr std::uint32_t kNoRemote = 0x40000000;
  for (std::uint32_t i = 0; i < 4; ++i) {
    objects.set(static_cast<std::uint16_t>(0x1400 + i), 0x200 + 0x100 * i + node, 1);
    objects.set(static_cast<std::uint16_t>(0x1800 + i), kNoRemote | (0x180 + 0x100 * i + node), 1);
  }
}

void make_constant(ObjectDictionary& objects) {
  objects.set(0x6007, 1);
  objects.set(0x605A, 0);
  objects.set(0x605E, 0);
  for (const std::uint16_t index : {std::uint16_t{0x6007}, std::uint16_t{0x605A}, std::uint16_t{0x605E}}) {
    objects.fix(index);
  }
  objects.fix(0x60C2, 1);
  objects.fix(0x60C2, 2);
}

void store(ObjectDictionary& objects, std::uint16_t index, std::uint32_t value, bool for_good = false) {
  objects.set(index, value);
  if (for_good) {
    objects.fix(index);
  }
}

void apply_stored(Peculiarity peculiarity, ObjectDictionary& objects) {
  switch (peculiarity) {
    case Peculiarity::kReversed:
      return store(objects, 0x607E, 0x80);
    case Peculiarity::kReversedForGood:
      return store(objects, 0x607E, 0x80, true);
    case Peculiarity::kTorqueOffset:
      return store(objects, 0x60B2, 300);
    case Peculiarity::kOffsetForGood:
      return store(objects, 0x60B2, 300, true);
    case Peculiarity::kMaxTorque:
      return store(objects, 0x6072, 50);
    case Peculiarity::kNoMaxTorque:
      return store(objects, 0x6072, 0);
    case Peculiarity::kConstantPeriod:
      objects.set(0x60C2, 2, 1);
      objects.fix(0x60C2, 1);
      objects.fix(0x60C2, 2);
      return;
    case Peculiarity::kStays:
    case Peculiarity::kStaysForGood:
      return objects.store_error_behaviour(1, peculiarity == Peculiarity::kStaysForGood);
    case Peculiarity::kConstantOptions:
      return make_constant(objects);
    case Peculiarity::kQuickStop2Or6:
      return objects.allow(0x605A, {2, 6});
    case Peculiarity::kFaultReaction2:
      return objects.allow(0x605E, {2});
    case Peculiarity::kHeartbeat100:
      return objects.set_least_heartbeat(100);
    case Peculiarity::kTwoObjects:
      return objects.set_most_mapped(2);
    default:
      return;
  }
}

void apply_absent(Peculiarity peculiarity, ObjectDictionary& objects) {
  switch (peculiarity) {
    case Peculiarity::kNo6007:
    case Peculiarity::kGoesOn:
      return objects.remove(0x6007);
    case Peculiarity::kNo605A:
      return objects.remove(0x605A);
    case Peculiarity::kNo605E:
      return objects.remove(0x605E);
    case Peculiarity::kNo60C2:
      return objects.remove(0x60C2);
    case Peculiarity::kNo6061:
      return objects.remove(0x6061);
    case Peculiarity::kNo1016:
      return objects.remove(0x1016);
    case Peculiarity::kNo6075:
      return objects.remove(0x6075);
    case Peculiarity::kNo607E:
      return objects.remove(0x607E);
    default:
      return;
  }
}

}  // namespace

auto name(Peculiarity peculiarity) -> const char* {
  return kNames[static_cast<std::size_t>(peculiarity)];
}

auto peculiarity_names() -> std::string {
  std::string list;
  for (const char* name : kNames) {
    list += std::string(list.empty() ? "" : ", ") + name;
  }
  return list;
}

auto parse_peculiarity(const std::string& text) -> Peculiarity {
  const auto* const found = std::find(kNames.begin(), kNames.end(), text);
  if (found == kNames.end()) {
    throw std::runtime_error("'" + text + "' is nothing that a drive can have; choose one of " + peculiarity_names());
  }
  return static_cast<Peculiarity>(found - kNames.begin());
}

auto dictionary_of(const Peculiarities& peculiarities, std::uint8_t node) -> ObjectDictionary {
  ObjectDictionary objects;
  for (const Peculiarity peculiarity : peculiarities) {
    apply_stored(peculiarity, objects);
    if (peculiarity == Peculiarity::kFactoryPdos) {
      switch_on_pdos(objects, node);
    }
  }
  for (const Peculiarity peculiarity : peculiarities) {
    apply_absent(peculiarity, objects);
  }
  return objects;
}

}  // namespace capstan::drive_sim
