// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/scenario.hpp"

#include <algorithm>
#include <locale>
#include <optional>
#include <sstream>
#include <utility>

#include "capstan/hal/sim/fields.hpp"
#include "capstan/hal/sim/scenario_sections.hpp"

namespace capstan::sim {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepestBase = 8;

Instrument find_instrument(const Source& source, const toml::node& node) {
  const std::string name = source.text("instrument", node);
  for (const fs::path& folder : {source.file.parent_path(), source.instruments_folder}) {
    const fs::path candidate = folder / name;
    if (fs::is_regular_file(candidate))
      return parse_instrument(contents(candidate), candidate);
  }
  const std::string_view text = built_in_instrument(name);
  if (text.empty()) {
    source.fail(node.source(), "there is no instrument `" + name +
                                   "` beside the scenario; give a file, micro_forceps, da_vinci_wrist, raven2 or "
                                   "robot_finger");
  }
  return parse_instrument(text, name);
}

void take_instrument(const Instrument& instrument, Scenario& scenario) {
  const Effects kept = scenario.plant.effects;  // of a base
  scenario.axis_name = instrument.axes.front().name;
  scenario.plant = instrument.axes.front().plant;
  scenario.plant.effects = kept;
  scenario.carried_radius_m = instrument.axes.front().carried_radius_m;
  scenario.other_axes.clear();
  for (std::size_t i = 1; i < instrument.axes.size(); ++i)
    scenario.other_axes.push_back({instrument.axes[i], {}});
}

std::vector<std::string> names_of(const Scenario& scenario) {
  std::vector<std::string> names = {scenario.axis_name};
  for (const OtherAxis& axis : scenario.other_axes)
    names.push_back(axis.joint.name);
  return names;
}

std::uint64_t read_seed(const Source& source, const toml::node& node) {
  const std::optional<std::int64_t> value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!value || *value < 0)
    source.fail(node.source(), "`seed` is not a whole number from 0; write it like 1");
  return static_cast<std::uint64_t>(*value);
}

// The sections that every axis has.
Readers axis_readers(const Source& source, PlantParameters& plant, Motion& motion) {
  return {
      {"plant", [&](const auto& key, const auto& node) { read_plant(source, source.table(key, node), plant); }},
      {"environment", [&](const auto& key,
                          const auto& node) { read_environment(source, source.table(key, node), plant.environment); }},
      {"effects",
       [&](const auto& key, const auto& node) { read_effects(source, source.table(key, node), plant.effects); }},
      {"motion", [&](const auto& key,
                     const auto& node) { motion = read_motion(source, source.table(key, node), Quantity::kAngle); }},
      {"torque", [&](const auto& key,
                     const auto& node) { motion = read_motion(source, source.table(key, node), Quantity::kTorque); }},
  };
}

// [[axes]] changes what the instrument says of the axis that it names.
void read_axis(const Source& source, const toml::table& table, Scenario& scenario) {
  const toml::node* which = table.get("axis");
  if (which == nullptr)
    source.fail(table.source(), "an axis lacks `axis`; give its name");
  const int number = axis_number(source, *which, names_of(scenario));
  OtherAxis* other = number > 0 ? &scenario.other_axes[static_cast<std::size_t>(number) - 1] : nullptr;
  PlantParameters& plant = other != nullptr ? other->joint.plant : scenario.plant;
  Readers readers = axis_readers(source, plant, other != nullptr ? other->motion : scenario.motion);
  readers.emplace("axis", [](const auto&, const auto&) {});
  read_table(source, "an axis", table, readers);
  source.located(table, [&] { validate(plant); });
}

Readers scenario_readers(const Source& source, Scenario& scenario) {
  const auto list = [&source](const std::string& key, const toml::node& node, const auto& each) {
    for (const auto& item : source.array(key, node))
      each(item);
  };
  Readers readers = axis_readers(source, scenario.plant, scenario.motion);
  readers.emplace("name", [&](const auto& key, const auto& node) { scenario.name = source.text(key, node); });
  readers.emplace("seed", [&](const auto&, const auto& node) { scenario.seed = read_seed(source, node); });
  readers.emplace("duration_s",
                  [&](const auto& key, const auto& node) { scenario.duration_s = source.number(key, node); });
  // Both are already read: the other keys change what they gave.
  readers.emplace("base", [](const auto&, const auto&) {});
  readers.emplace("instrument", [](const auto&, const auto&) {});
  readers.emplace("axes", [&, list](const std::string& key, const toml::node& node) {
    list(key, node, [&](const toml::node& axis) { read_axis(source, source.table(key, axis), scenario); });
  });
  readers.emplace("shell", [&, list](const std::string& key, const toml::node& node) {
    list(key, node, [&](const toml::node& line) { scenario.shell.push_back(source.text(key, line)); });
  });
  readers.emplace("faults", [&, list](const std::string& key, const toml::node& node) {
    list(key, node, [&](const toml::node& fault) {
      scenario.faults.push_back(read_fault(source, source.table(key, fault), names_of(scenario)));
    });
  });
  return readers;
}

Scenario parse_at_depth(std::string_view text, const Source& source, int depth);

Scenario read_base(const Source& source, const toml::node& node, int depth) {
  if (depth >= kDeepestBase)
    source.fail(node.source(), "`base` leads in a circle; name a scenario that stands alone");
  const fs::path file = source.file.parent_path() / source.text("base", node);
  if (!fs::is_regular_file(file)) {
    source.fail(node.source(), "there is no scenario " + file.string() + "; give a file beside this one");
  }
  return parse_at_depth(contents(file), Source{file, source.instruments_folder}, depth + 1);
}

// A joint follows an angle or its motor gives a torque, and the bench is there for all axes or for none.
void check_quantities(const Source& source, const toml::table& root, const Scenario& scenario) {
  const bool bench = on_bench(scenario);
  bool mixed = root.contains("motion") && root.contains("torque");
  const auto differs = [bench](const Motion& motion) {
    return !motion.empty() && (motion.quantity() == Quantity::kTorque) != bench;
  };
  mixed = mixed || differs(scenario.motion);
  for (const OtherAxis& axis : scenario.other_axes)
    mixed = mixed || differs(axis.motion);
  if (mixed)
    source.fail(root.source(), "one axis has a [motion] and another, or the same, a [torque]; choose one for all");
}

double longest_motion_s(const Scenario& scenario) {
  double longest = scenario.motion.duration_s();
  for (const OtherAxis& axis : scenario.other_axes)
    longest = std::max(longest, axis.motion.duration_s());
  return longest;
}

Scenario parse_at_depth(std::string_view text, const Source& source, int depth) {
  const toml::table root = parse_toml(text, source);
  Scenario scenario;
  if (const toml::node* base = root.get("base"))
    scenario = read_base(source, *base, depth);
  scenario.name = source.file.stem().string();
  if (root.contains("shell"))
    scenario.shell.clear();
  if (root.contains("faults"))
    scenario.faults.clear();
  if (const toml::node* instrument = root.get("instrument"))
    take_instrument(find_instrument(source, *instrument), scenario);
  read_table(source, "a scenario", root, scenario_readers(source, scenario));
  source.located(root, [&] { validate(scenario.plant); });
  check_quantities(source, root, scenario);
  if (const toml::node* duration = root.get("duration_s")) {
    if (scenario.duration_s <= 0.0 || scenario.duration_s > 1.0e6) {
      source.fail(duration->source(), "`duration_s` must be above 0 and at most 1e6; give the run's length in seconds");
    }
  } else if (root.contains("motion") || root.contains("torque") || root.contains("axes") || !root.contains("base")) {
    scenario.duration_s = longest_motion_s(scenario);
  }
  return scenario;
}

/// @param form  how the number is written
double value_of(const std::string& number, const std::string& what, const std::string& form) {
  std::istringstream stream(number);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  if (!(stream >> value) || !(stream >> std::ws).eof())
    throw ScenarioError(what + " `" + number + "` is not a number; write it like " + form);
  return value;
}

}  // namespace

bool on_bench(const Scenario& scenario) {
  bool bench = scenario.motion.quantity() == Quantity::kTorque;
  for (const OtherAxis& axis : scenario.other_axes)
    bench = bench || axis.motion.quantity() == Quantity::kTorque;
  return bench;
}

std::vector<InstrumentAxis> axes_of(const Scenario& scenario) {
  std::vector<InstrumentAxis> axes = {{scenario.axis_name, scenario.plant, scenario.carried_radius_m}};
  for (const OtherAxis& axis : scenario.other_axes)
    axes.push_back(axis.joint);
  return axes;
}

Scenario parse_scenario(std::string_view text, const fs::path& file, const fs::path& instruments_folder) {
  return parse_at_depth(text, Source{file, instruments_folder}, 0);
}

Scenario load_scenario(const fs::path& file, const fs::path& instruments_folder) {
  return parse_scenario(contents(file), file, instruments_folder);
}

void override_effect(Scenario& scenario, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string text(assignment);
  if (equals == std::string_view::npos || equals == 0) {
    throw ScenarioError("the effect `" + text + "` has no value; write it like play=0.03");
  }
  const double value = value_of(text.substr(equals + 1), "the effect's value", "play=0.03");
  try {
    set_effect(scenario.plant.effects, text.substr(0, equals), value);
    validate(scenario.plant);
  } catch (const std::invalid_argument& refusal) {
    throw ScenarioError(refusal.what());
  }
}

Fault parse_fault(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string target;
  std::string kind;
  words >> target >> kind;
  Fault fault;
  try {
    fault.target = fault_target(target);
    fault.kind = fault_kind(kind);
    for (std::string key, number; words >> key;) {
      if (!(words >> number))
        throw ScenarioError("`" + key + "` in the fault has no value; write it like at 3");
      const double value = value_of(number, "the fault's value", key + " 3");
      if (key == "at") {
        fault.time_s = value;
      } else if (key == "for") {
        fault.duration_s = value;
      } else if (key == "amount") {
        fault.amount = value;
      } else if (key == "axis" && value >= 0.0 && value < 100.0) {
        fault.axis = static_cast<int>(value);
      } else {
        throw ScenarioError("`" + key + "` says nothing about a fault; known are: at, for, amount, axis");
      }
    }
    FaultSchedule(0).add(fault);
  } catch (const std::invalid_argument& refusal) {
    throw ScenarioError(refusal.what());
  }
  return fault;
}

}  // namespace capstan::sim
