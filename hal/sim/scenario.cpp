// SPDX-License-Identifier: Apache-2.0
#include "hal/sim/scenario.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <locale>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "hal/sim/fields.hpp"

namespace capstan::sim {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepestBase = 8;

/// A file being read: knows its name for errors.
struct Source {
  fs::path file;
  fs::path instruments_folder;

  [[noreturn]] void fail(const toml::source_region& where, const std::string& sentence) const {
    throw ScenarioError(file.string() + ":" + std::to_string(where.begin.line) + ": " + sentence);
  }

  // Turns a checker's refusal into one with file and line.
  template <class Action>
  auto located(const toml::node& node, Action&& action) const {
    try {
      return action();
    } catch (const std::invalid_argument& refusal) {
      fail(node.source(), refusal.what());
    }
  }

  [[nodiscard]] double number(const std::string& key, const toml::node& node) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      fail(node.source(), "`" + key + "` is not a number; write it like 0.5");
    return *value;
  }

  [[nodiscard]] int integer(const std::string& key, const toml::node& node) const {
    const std::optional<std::int64_t> value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!value || *value < -2147483647 || *value > 2147483647) {
      fail(node.source(), "`" + key + "` is not a whole number; write it like 4");
    }
    return static_cast<int>(*value);
  }

  [[nodiscard]] std::string text(const std::string& key, const toml::node& node) const {
    const std::optional<std::string> value = node.value_exact<std::string>();
    if (!value)
      fail(node.source(), "`" + key + "` is not a text; put it in double quotes");
    return *value;
  }

  [[nodiscard]] const toml::table& table(const std::string& key, const toml::node& node) const {
    if (!node.is_table())
      fail(node.source(), "`" + key + "` is not a table; write it as [" + key + "]");
    return *node.as_table();
  }

  [[nodiscard]] const toml::array& array(const std::string& key, const toml::node& node) const {
    if (!node.is_array())
      fail(node.source(), "`" + key + "` is not a list; put its items in [ ]");
    return *node.as_array();
  }
};

using Reader = std::function<void(const std::string& key, const toml::node& value)>;
using Readers = std::map<std::string, Reader, std::less<>>;

// Every key of the table must have a reader: this is where unknown keys are refused.
void read_table(const Source& source, const std::string& what, const toml::table& table, const Readers& readers) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const auto reader = readers.find(name);
    if (reader == readers.end()) {
      std::string known;
      for (const auto& entry : readers)
        known += (known.empty() ? "" : ", ") + entry.first;
      source.fail(key.source(), what + " has no key `" + name + "`; known are: " + known);
    }
    reader->second(name, node);
  }
}

toml::table parse(std::string_view text, const Source& source) {
  try {
    return toml::parse(text, source.file.string());
  } catch (const toml::parse_error& error) {
    source.fail(error.source(), std::string(error.description()) + "; correct the TOML syntax");
  }
}

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || fs::is_directory(file) || !(text << stream.rdbuf())) {
    throw ScenarioError(file.string() + ":1: the file cannot be read; check the path and that it is not empty");
  }
  return text.str();
}

void read_plant(const Source& source, const toml::table& table, PlantParameters& plant) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    source.located(node, [&] { set_parameter(plant, name, source.number(name, node)); });
  }
}

void read_environment(const Source& source, const toml::table& table, Environment& environment) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    source.located(node, [&] {
      if (name == "kind") {
        environment.kind = environment_kind(source.text(name, node));
      } else {
        set_environment(environment, name, source.number(name, node));
      }
    });
  }
}

void read_effects(const Source& source, const toml::table& table, Effects& effects) {
  for (const auto& [key, node] : table) {
    const std::string effect(key.str());
    if (!node.is_table()) {
      source.located(node, [&] { set_effect(effects, effect, source.number(effect, node)); });
      continue;
    }
    for (const auto& [detail, value] : *node.as_table()) {
      const std::string name = effect + "." + std::string(detail.str());
      source.located(value, [&] { set_effect(effects, name, source.number(name, value)); });
    }
  }
}

template <class Kind, std::size_t Count>
Kind choose(const Source& source, const std::string& key, const toml::node& node,
            const std::array<std::pair<const char*, Kind>, Count>& choices) {
  const std::string name = source.text(key, node);
  std::string known;
  for (const auto& [choice, kind] : choices) {
    if (name == choice)
      return kind;
    known += (known.empty() ? "" : ", ") + std::string(choice);
  }
  source.fail(node.source(), "`" + name + "` is no " + key + "; known are: " + known);
}

Fault read_fault(const Source& source, const toml::table& table) {
  static const std::array<std::pair<const char*, FaultTarget>, 3> kTargets = {
      {{"encoder", FaultTarget::kEncoder}, {"current", FaultTarget::kCurrent}, {"amplifier", FaultTarget::kAmplifier}}};
  static const std::array<std::pair<const char*, FaultKind>, 7> kKinds = {{{"off", FaultKind::kOff},
                                                                           {"stuck", FaultKind::kStuck},
                                                                           {"garbage", FaultKind::kGarbage},
                                                                           {"jump", FaultKind::kJump},
                                                                           {"nan", FaultKind::kNan},
                                                                           {"sign", FaultKind::kSign},
                                                                           {"delayed", FaultKind::kDelayed}}};
  Fault fault;
  const auto set = [&source](double& member) {
    return [&source, &member](const std::string& key, const toml::node& node) { member = source.number(key, node); };
  };
  read_table(
      source, "a fault", table,
      {{"time_s", set(fault.time_s)},
       {"duration_s", set(fault.duration_s)},
       {"amount", set(fault.amount)},
       {"target", [&](const auto& key, const auto& node) { fault.target = choose(source, key, node, kTargets); }},
       {"kind", [&](const auto& key, const auto& node) { fault.kind = choose(source, key, node, kKinds); }}});
  for (const char* needed : {"time_s", "target", "kind"}) {
    if (!table.contains(needed))
      source.fail(table.source(), std::string("a fault lacks `") + needed + "`; add it");
  }
  source.located(table, [&] { FaultSchedule(0).add(fault); });
  return fault;
}

Segment read_segment(const Source& source, const toml::table& table) {
  static const std::array<std::pair<const char*, SegmentKind>, 5> kKinds = {
      {{"sine", SegmentKind::kSine},
       {"multisine", SegmentKind::kMultisine},
       {"decaying_sine", SegmentKind::kDecayingSine},
       {"triangle", SegmentKind::kTriangle},
       {"hold", SegmentKind::kHold}}};
  Segment segment;
  const auto set = [&source](double& member) {
    return [&source, &member](const std::string& key, const toml::node& node) { member = source.number(key, node); };
  };
  read_table(source, "a segment", table,
             {{"kind", [&](const auto& key, const auto& node) { segment.kind = choose(source, key, node, kKinds); }},
              {"duration_s", set(segment.duration_s)},
              {"offset_rad", set(segment.offset_rad)},
              {"amplitude_rad", set(segment.amplitude_rad)},
              {"frequency_hz", set(segment.frequency_hz)},
              {"phase_rad", set(segment.phase_rad)},
              {"decay_per_s", set(segment.decay_per_s)},
              {"corner_s", set(segment.corner_s)},
              {"frequencies_hz", [&](const std::string& key, const toml::node& node) {
                 for (const auto& tone : source.array(key, node)) {
                   segment.frequencies_hz.push_back(source.number(key, tone));
                 }
               }}});
  for (const char* needed : {"kind", "duration_s"}) {
    if (!table.contains(needed))
      source.fail(table.source(), std::string("a segment lacks `") + needed + "`; add it");
  }
  // Alone, a segment must already be a motion: so that what is wrong with it is reported at its own line.
  source.located(table, [&] { Motion({segment}, 1, std::min(0.01, segment.duration_s)); });
  return segment;
}

Motion read_motion(const Source& source, const toml::table& table) {
  std::vector<Segment> segments;
  int repeat = 1;
  double blend_s = 0.5;
  read_table(source, "motion", table,
             {{"repeat", [&](const auto& key, const auto& node) { repeat = source.integer(key, node); }},
              {"blend_s", [&](const auto& key, const auto& node) { blend_s = source.number(key, node); }},
              {"segments", [&](const std::string& key, const toml::node& node) {
                 for (const auto& item : source.array(key, node)) {
                   segments.push_back(read_segment(source, source.table("segments", item)));
                 }
               }}});
  return source.located(table, [&] { return Motion(std::move(segments), repeat, blend_s); });
}

void read_instrument_file(const Source& source, const std::string& text, PlantParameters& plant) {
  const toml::table root = parse(text, source);
  read_table(source, "an instrument", root,
             {{"name", [&](const auto& key, const auto& node) { static_cast<void>(source.text(key, node)); }},
              {"plant", [&](const auto& key, const auto& node) { read_plant(source, source.table(key, node), plant); }},
              {"environment", [&](const auto& key, const auto& node) {
                 read_environment(source, source.table(key, node), plant.environment);
               }}});
}

void read_instrument(const Source& source, const toml::node& node, PlantParameters& plant) {
  const std::string name = source.text("instrument", node);
  for (const fs::path& folder : {source.file.parent_path(), source.instruments_folder}) {
    const fs::path candidate = folder / name;
    if (!fs::is_regular_file(candidate))
      continue;
    read_instrument_file(Source{candidate, {}}, contents(candidate), plant);
    return;
  }
  // The defaults of PlantParameters are this instrument.
  if (name == "micro_forceps" || name == "micro_forceps.toml")
    return;
  source.fail(node.source(), "there is no instrument `" + name + "` beside the scenario; give a file or micro_forceps");
}

std::uint64_t read_seed(const Source& source, const toml::node& node) {
  const std::optional<std::int64_t> value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!value || *value < 0)
    source.fail(node.source(), "`seed` is not a whole number from 0; write it like 1");
  return static_cast<std::uint64_t>(*value);
}

Readers scenario_readers(const Source& source, Scenario& scenario) {
  const auto list = [&source](const std::string& key, const toml::node& node, const auto& each) {
    for (const auto& item : source.array(key, node))
      each(item);
  };
  return {
      {"name", [&](const auto& key, const auto& node) { scenario.name = source.text(key, node); }},
      {"seed", [&](const auto&, const auto& node) { scenario.seed = read_seed(source, node); }},
      {"duration_s", [&](const auto& key, const auto& node) { scenario.duration_s = source.number(key, node); }},
      {"base", [](const auto&, const auto&) {}},  // both already read: the other keys change what they gave
      {"instrument", [](const auto&, const auto&) {}},
      {"plant",
       [&](const auto& key, const auto& node) { read_plant(source, source.table(key, node), scenario.plant); }},
      {"environment",
       [&](const auto& key, const auto& node) {
         read_environment(source, source.table(key, node), scenario.plant.environment);
       }},
      {"effects", [&](const auto& key,
                      const auto& node) { read_effects(source, source.table(key, node), scenario.plant.effects); }},
      {"motion",
       [&](const auto& key, const auto& node) { scenario.motion = read_motion(source, source.table(key, node)); }},
      {"shell",
       [&, list](const std::string& key, const toml::node& node) {
         list(key, node, [&](const toml::node& line) { scenario.shell.push_back(source.text(key, line)); });
       }},
      {"faults",
       [&, list](const std::string& key, const toml::node& node) {
         list(key, node, [&](const toml::node& fault) {
           scenario.faults.push_back(read_fault(source, source.table(key, fault)));
         });
       }},
  };
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

Scenario parse_at_depth(std::string_view text, const Source& source, int depth) {
  const toml::table root = parse(text, source);
  Scenario scenario;
  if (const toml::node* base = root.get("base"))
    scenario = read_base(source, *base, depth);
  scenario.name = source.file.stem().string();
  if (root.contains("shell"))
    scenario.shell.clear();
  if (root.contains("faults"))
    scenario.faults.clear();
  if (const toml::node* instrument = root.get("instrument"))
    read_instrument(source, *instrument, scenario.plant);
  read_table(source, "a scenario", root, scenario_readers(source, scenario));
  source.located(root, [&] { validate(scenario.plant); });
  if (const toml::node* duration = root.get("duration_s")) {
    if (scenario.duration_s <= 0.0 || scenario.duration_s > 1.0e6) {
      source.fail(duration->source(), "`duration_s` must be above 0; give the run's length in seconds");
    }
  } else if (root.contains("motion") || !root.contains("base")) {
    scenario.duration_s = scenario.motion.duration_s();
  }
  return scenario;
}

}  // namespace

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
  const std::string number = text.substr(equals + 1);
  std::istringstream stream(number);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  if (!(stream >> value) || !(stream >> std::ws).eof()) {
    throw ScenarioError("the effect's value `" + number + "` is not a number; write it like play=0.03");
  }
  try {
    set_effect(scenario.plant.effects, text.substr(0, equals), value);
    validate(scenario.plant);
  } catch (const std::invalid_argument& refusal) {
    throw ScenarioError(refusal.what());
  }
}

}  // namespace capstan::sim
