// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/scenario_sections.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "capstan/hal/sim/experiments.hpp"
#include "capstan/hal/sim/fields.hpp"

namespace capstan::sim {
namespace {

// A segment as it stands in a file: of the kinds that Motion knows, or a ladder that becomes several of them.
struct WrittenSegment {
  std::string kind;
  Segment plain;
  int cycles = 2;
  int levels = 0;
  std::vector<double> speeds_rad_per_s;
};

Reader number_into(const Source& source, double& member) {
  return [&source, &member](const std::string& key, const toml::node& node) { member = source.number(key, node); };
}

Reader numbers_into(const Source& source, std::vector<double>& members) {
  return [&source, &members](const std::string& key, const toml::node& node) {
    for (const auto& item : source.array(key, node))
      members.push_back(source.number(key, item));
  };
}

Reader integer_into(const Source& source, int& member) {
  return [&source, &member](const std::string& key, const toml::node& node) { member = source.integer(key, node); };
}

void demand(const Source& source, const toml::table& table, const std::string& what, const char* key) {
  if (!table.contains(key))
    source.fail(table.source(), what + " lacks `" + key + "`; add it");
}

SegmentKind plain_kind(const std::string& name) {
  static const std::map<std::string, SegmentKind> kKinds = {
      {"sine", SegmentKind::kSine},         {"multisine", SegmentKind::kMultisine},
      {"triangle", SegmentKind::kTriangle}, {"decaying_sine", SegmentKind::kDecayingSine},
      {"hold", SegmentKind::kHold},         {"polyline", SegmentKind::kPolyline}};
  return kKinds.at(name);
}

std::vector<Segment> expand(WrittenSegment written, bool has_duration) {
  Segment& plain = written.plain;
  const LadderShape shape{plain.amplitude_rad, plain.offset_rad, plain.corner_s, written.cycles};
  std::vector<Segment> result;
  if (written.kind == "sine_ladder") {
    result = sine_ladder(shape, plain.frequencies_hz);
  } else if (written.kind == "speed_ladder") {
    result = speed_ladder(shape, written.speeds_rad_per_s);
  } else if (written.kind == "reversal_staircase") {
    result = reversal_staircase(shape, written.levels, plain.speed_rad_per_s);
  } else {
    plain.kind = plain_kind(written.kind);
    if (plain.kind == SegmentKind::kPolyline && !has_duration)
      plain.duration_s = polyline_duration_s(plain);
    else if (!has_duration)
      throw std::invalid_argument("a segment lacks `duration_s`; add it");
    // Alone, a segment must already be a motion: so that what is wrong with it is reported at its own line.
    Motion({plain}, 1, 0.01);
    return {plain};
  }
  if (has_duration)
    throw std::invalid_argument("a ladder's length follows from its rungs; leave `duration_s` out");
  Motion(result, 1, 0.01);
  return result;
}

// What a segment may say beside its kind, `duration_s` and offset; @ stands for the quantity's unit.
constexpr std::array kSegmentKeys = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"sine", "amplitude_@ frequency_hz phase_rad"},
    {"multisine", "amplitude_@ frequencies_hz phase_rad"},
    {"decaying_sine", "amplitude_@ frequency_hz phase_rad decay_per_s"},
    {"triangle", "amplitude_@ frequency_hz phase_rad corner_s"},
    {"hold", ""},
    {"polyline", "points_@ speed_@_per_s corner_s"},
    {"sine_ladder", "amplitude_@ frequencies_hz cycles"},
    {"speed_ladder", "amplitude_@ speeds_@_per_s cycles corner_s"},
    {"reversal_staircase", "amplitude_@ levels speed_@_per_s corner_s"},
});

std::string keys_of(const std::string& kind, const std::string& unit) {
  std::string known;
  for (const auto& [name, keys] : kSegmentKeys) {
    if (name == kind) {
      std::string written = " kind duration_s offset_@ " + std::string(keys) + " ";
      for (std::size_t at = written.find('@'); at != std::string::npos; at = written.find('@', at))
        written.replace(at, 1, unit);
      return written;
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument("`" + kind + "` is no kind; known are: " + known);
}

std::vector<Segment> read_segment(const Source& source, const toml::table& table, Quantity quantity) {
  WrittenSegment written;
  Segment& plain = written.plain;
  demand(source, table, "a segment", "kind");
  const toml::node& kind = *table.get("kind");
  written.kind = source.text("kind", kind);
  const std::string unit = quantity == Quantity::kTorque ? "nm" : "rad";
  const std::string keys = source.located(kind, [&] { return keys_of(written.kind, unit); });
  Readers readers = {{"kind", [](const auto&, const auto&) {}},
                     {"duration_s", number_into(source, plain.duration_s)},
                     {"offset_" + unit, number_into(source, plain.offset_rad)},
                     {"amplitude_" + unit, number_into(source, plain.amplitude_rad)},
                     {"frequency_hz", number_into(source, plain.frequency_hz)},
                     {"phase_rad", number_into(source, plain.phase_rad)},
                     {"decay_per_s", number_into(source, plain.decay_per_s)},
                     {"corner_s", number_into(source, plain.corner_s)},
                     {"speed_" + unit + "_per_s", number_into(source, plain.speed_rad_per_s)},
                     {"cycles", integer_into(source, written.cycles)},
                     {"levels", integer_into(source, written.levels)},
                     {"points_" + unit, numbers_into(source, plain.points_rad)},
                     {"speeds_" + unit + "_per_s", numbers_into(source, written.speeds_rad_per_s)},
                     {"frequencies_hz", numbers_into(source, plain.frequencies_hz)}};
  std::erase_if(readers, [&](const auto& reader) { return keys.find(" " + reader.first + " ") == std::string::npos; });
  read_table(source, "a segment of kind `" + written.kind + "`", table, readers);
  return source.located(table, [&] { return expand(std::move(written), table.contains("duration_s")); });
}

}  // namespace

// Lambdas may not capture structured bindings, as one of the compilers in use sees it: hence the plain names.
void read_plant(const Source& source, const toml::table& table, PlantParameters& plant) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const toml::node& value = node;
    source.located(node, [&] {
      if (name == "mode") {
        plant.mode = solver_mode(source.text(name, value));
      } else {
        set_parameter(plant, name, source.number(name, value));
      }
    });
  }
}

void read_environment(const Source& source, const toml::table& table, Environment& environment) {
  if (const toml::node* kind = table.get("kind"))
    source.located(*kind, [&] { environment.kind = environment_kind(source.text("kind", *kind)); });
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (name == "kind")
      continue;
    const toml::node& value = node;
    source.located(node, [&] {
      set_environment(environment, name, source.number(name, value));
      if (!plays_a_part(environment.kind, name))
        throw std::invalid_argument("`" + name +
                                    "` plays no part in this kind of environment; choose another `kind`, or "
                                    "leave it out");
    });
  }
}

void read_effects(const Source& source, const toml::table& table, Effects& effects) {
  const auto set = [&](const std::string& name, const toml::node& node) {
    source.located(node, [&] { set_effect(effects, name, source.number(name, node)); });
  };
  for (const auto& [key, node] : table) {
    const std::string effect(key.str());
    if (!node.is_table()) {
      set(effect, node);
      continue;
    }
    for (const auto& [detail, value] : *node.as_table())
      set(effect + "." + std::string(detail.str()), value);
  }
}

int axis_number(const Source& source, const toml::node& node, const std::vector<std::string>& names) {
  const std::string name = source.text("axis", node);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    std::string known;
    for (const std::string& each : names)
      known += (known.empty() ? "" : ", ") + each;
    source.fail(node.source(), "there is no axis `" + name + "`; known are: " + known);
  }
  return static_cast<int>(found - names.begin());
}

Fault read_fault(const Source& source, const toml::table& table, const std::vector<std::string>& axis_names) {
  Fault fault;
  read_table(source, "a fault", table,
             {{"time_s", number_into(source, fault.time_s)},
              {"duration_s", number_into(source, fault.duration_s)},
              {"amount", number_into(source, fault.amount)},
              {"axis", [&](const auto&, const auto& node) { fault.axis = axis_number(source, node, axis_names); }},
              {"target",
               [&](const auto& key, const auto& node) {
                 source.located(node, [&] { fault.target = fault_target(source.text(key, node)); });
               }},
              {"kind", [&](const auto& key, const auto& node) {
                 source.located(node, [&] { fault.kind = fault_kind(source.text(key, node)); });
               }}});
  for (const char* needed : {"time_s", "target", "kind"})
    demand(source, table, "a fault", needed);
  source.located(table, [&] { FaultSchedule(0).add(fault); });
  return fault;
}

Motion read_motion(const Source& source, const toml::table& table, Quantity quantity) {
  std::vector<Segment> segments;
  int repeat = 1;
  double blend_s = 0.5;
  read_table(source, quantity == Quantity::kTorque ? "torque" : "motion", table,
             {{"repeat", integer_into(source, repeat)},
              {"blend_s", number_into(source, blend_s)},
              {"segments", [&](const std::string& key, const toml::node& node) {
                 for (const auto& item : source.array(key, node)) {
                   std::vector<Segment> more = read_segment(source, source.table("segments", item), quantity);
                   std::move(more.begin(), more.end(), std::back_inserter(segments));
                 }
               }}});
  return source.located(table, [&] { return Motion(std::move(segments), repeat, blend_s, quantity); });
}

}  // namespace capstan::sim
