// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/instrument.hpp"

#include <algorithm>

#include "capstan/hal/sim/fields.hpp"
#include "capstan/hal/sim/scenario_sections.hpp"

namespace capstan::sim {
namespace {

constexpr std::size_t kMostAxes = 8;
constexpr double kLargestRadiusM = 1.0;

Reader plant_into(const Source& source, PlantParameters& plant) {
  return [&](const std::string& key, const toml::node& node) { read_plant(source, source.table(key, node), plant); };
}

Reader environment_into(const Source& source, PlantParameters& plant) {
  return [&](const std::string& key, const toml::node& node) {
    read_environment(source, source.table(key, node), plant.environment);
  };
}

void read_axis(const Source& source, const toml::table& table, InstrumentAxis& axis) {
  read_table(source, "an axis", table,
             {{"name", [&](const auto& key, const auto& node) { axis.name = source.text(key, node); }},
              {"plant", plant_into(source, axis.plant)},
              {"environment", environment_into(source, axis.plant)},
              {"carried_radius_m", [](const auto&, const auto&) {}}});  // read once all names are known
  if (axis.name.empty())
    source.fail(table.source(), "an axis lacks `name`; add it");
  source.located(table, [&] { validate(axis.plant); });
}

void read_carried(const Source& source, const toml::table& table, const std::vector<std::string>& names,
                  std::size_t own, std::vector<double>& radii) {
  radii.assign(names.size(), 0.0);
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const auto joint = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    if (joint == names.size() || joint == own)
      source.fail(key.source(), "`" + name + "` is no other axis of this instrument; name one that is");
    radii[joint] = source.number(name, node);
    if (!(radii[joint] >= -kLargestRadiusM && radii[joint] <= kLargestRadiusM))
      source.fail(node.source(), "a carried radius is beyond 1 m; give it in m");
  }
}

void read_axes(const Source& source, const toml::array& list, Instrument& instrument) {
  if (list.empty() || list.size() > kMostAxes)
    source.fail(list.source(), "an instrument has 1 to 8 axes; correct the list");
  for (const auto& item : list) {
    InstrumentAxis axis;
    read_axis(source, source.table("axes", item), axis);
    const std::vector<std::string> names = axis_names(instrument);
    if (std::find(names.begin(), names.end(), axis.name) != names.end())
      source.fail(item.source(), "there are two axes `" + axis.name + "`; rename one");
    if (!instrument.axes.empty() && instrument.axes.front().plant.substeps != axis.plant.substeps)
      source.fail(item.source(), "all axes share their sub-steps; give the same `substeps` everywhere");
    instrument.axes.push_back(axis);
  }
  const std::vector<std::string> names = axis_names(instrument);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (const toml::node* carried = list[i].as_table()->get("carried_radius_m")) {
      read_carried(source, source.table("carried_radius_m", *carried), names, i, instrument.axes[i].carried_radius_m);
    }
  }
}

}  // namespace

std::vector<std::string> axis_names(const Instrument& instrument) {
  std::vector<std::string> names;
  for (const InstrumentAxis& axis : instrument.axes)
    names.push_back(axis.name);
  return names;
}

Instrument parse_instrument(std::string_view text, const std::filesystem::path& file) {
  const Source source{file, {}};
  const toml::table root = parse_toml(text, source);
  Instrument instrument;
  if (root.contains("axes")) {
    read_table(
        source, "an instrument of several axes", root,
        {{"name", [&](const auto& key, const auto& node) { instrument.name = source.text(key, node); }},
         {"axes", [&](const auto& key, const auto& node) { read_axes(source, source.array(key, node), instrument); }}});
    return instrument;
  }
  InstrumentAxis only{"joint0", {}, {}};
  read_table(source, "an instrument", root,
             {{"name", [&](const auto& key, const auto& node) { instrument.name = source.text(key, node); }},
              {"plant", plant_into(source, only.plant)},
              {"environment", environment_into(source, only.plant)}});
  source.located(root, [&] { validate(only.plant); });
  instrument.axes.push_back(only);
  return instrument;
}

}  // namespace capstan::sim
