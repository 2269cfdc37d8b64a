// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/browser/tables.hpp"

#include <initializer_list>
#include <sstream>

#include "capstan/firmware/loop/version.hpp"
#include "capstan/firmware/safety/faults.hpp"
#include "capstan/firmware/safety/supervisor.hpp"
#include "capstan/hal/sim/fields.hpp"
#include "capstan/hal/sim/instrument.hpp"

namespace capstan {
namespace {

constexpr std::array<const char*, kTriggerCount> kTriggers = {
    "first cycle", "fault", "disarm", "arm", "experiment runs", "motion begins", "motion brakes", "motion ends"};

}  // namespace

auto tables() -> std::string {
  std::ostringstream out;
  out << "version\t" << kVersion << '\n';
  for (std::size_t i = 0; i < kStateNames.size(); ++i) {
    out << "state\t" << kStateNames[i] << '\t' << energised(static_cast<State>(i)) << '\n';
  }
  for (const Transition& row : kTransitions) {
    out << "transition\t" << name(row.from) << '\t' << kTriggers[static_cast<std::size_t>(row.trigger)] << '\t'
        << name(row.to) << '\n';
  }
  for (const FaultInfo& fault : kFaultTable) {
    out << "fault\t" << static_cast<int>(fault.code) << '\t' << fault.name << '\t' << fault.cause << '\t' << fault.cure
        << '\n';
  }
  for (const char* instrument : {"micro_forceps", "da_vinci_wrist", "raven2", "robot_finger"}) {
    const auto axes = sim::parse_instrument(sim::built_in_instrument(instrument), instrument).axes.size();
    out << "instrument\t" << instrument << '\t' << axes << '\n';
  }
  for (const sim::EffectField& field : sim::effect_fields()) {
    out << "effect\t" << field.effect << '\t' << field.key << '\t' << field.low << '\t' << field.high << '\t'
        << field.primary << '\n';
  }
  return out.str();
}

}  // namespace capstan
