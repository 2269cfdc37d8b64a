// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/effort_file.hpp"

#include <cmath>

#include "capstan/tools/joint_file/section_reader.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/support/toml_text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kEffortFamily = "effort";
constexpr const char* kGearFamily = "gear";

auto needed(const SectionReader& reader, const toml::table& root, const char* key) -> const toml::table& {
  const toml::table* table = reader.table(root, key);
  if (table == nullptr) {
    reader.fail(root, "[" + std::string(key) + "] is missing; write the file again with capstan diagnose -o");
  }
  return *table;
}

auto word(const SectionReader& reader, const toml::table& law, const char* key) -> std::string {
  const auto text = law[key].value<std::string>();
  if (!text) {
    reader.fail(law, std::string(key) + " is missing; write it as text in quotes");
  }
  return as_written(*text);
}

auto catalogue_for(const SectionReader& reader, const toml::table& law) -> const Catalogue& {
  const std::string family = word(reader, law, "family");
  if (family != kEffortFamily && family != kGearFamily) {
    reader.fail(law, family + " is no family of laws; write effort or gear");
  }
  const auto speed = law["standstill"]["unit"].value<std::string>();  // the target may be a mapped column of any name
  const bool linear = word(reader, law, "target").ends_with("_N") || speed == "m/s";
  return family == kGearFamily ? gear_law_catalogue()
                               : effort_law_catalogue(linear ? AxisKind::kLinear : AxisKind::kRotary);
}

auto parse_table(const toml::table& root, const std::string& name) -> EffortLaw {
  const SectionReader reader(name);
  const auto schema = root["schema"].value<std::string>();
  if (schema && schema->starts_with(kEffortSchemas) && *schema != kEffortSchema) {
    throw BadInput(place(name, 1) + "the law is of another version, " + *schema + ", and this program reads " +
                   kEffortSchema + "; update capstan, or write the file again with this version");
  }
  if (schema != kEffortSchema) {
    throw BadInput(place(name, 1) + "the schema is not capstan.effort/1; write schema = \"capstan.effort/1\" or make " +
                   "the file with capstan diagnose -o");
  }
  const toml::table& table = needed(reader, root, "law");
  EffortLaw law;
  law.joint = JointFile(catalogue_for(reader, table));
  law.target = word(reader, table, "target");
  law.status = word(reader, table, "status");
  const std::string motion = law.joint.catalogue->motion_unit();
  law.view.window_s = reader.quantity(table, "window", "s", kAnyNumber);
  law.view.standstill = reader.quantity(table, "standstill", motion + "/s", kAnyNumber);
  law.view.skew_s = reader.quantity(table, "skew", "s", kAnyNumber);
  law.view.letting_go_s = table.contains("letting_go") ? reader.quantity(table, "letting_go", "s", kAnyNumber) : 0.0;
  law.view.averaged = !law.of_gear();
  constexpr double kLongestS = 1.0;
  if (law.view.window_s <= 0.0 || law.view.window_s > kLongestS || std::abs(law.view.skew_s) > kLongestS ||
      law.view.letting_go_s < 0.0 || law.view.letting_go_s > kLongestS) {
    reader.fail(table,
                "window, skew and letting_go must be within a second, the window above nothing and letting_go not "
                "below; check their units");
  }
  reader.terms(needed(reader, root, "terms"), law.joint);
  return law;
}

auto quantity(const std::string& key, double value, const std::string& unit) -> std::string {
  return key + " = { value = " + exact(value) + ", unit = \"" + unit + "\" }\n";
}

}  // namespace

auto effort_file_text(const EffortLaw& law) -> std::string {
  return joint_file_text(law.joint) +
         "\n# What it takes to run the law over a log. window: of the cubic that motion is taken from, and through "
         "which\n# law and effort are compared. standstill: speed below which the direction stays what it was. skew: "
         "how "
         "much\n# later than logged the motor's torque acts. letting_go: time constant with which dry friction lets go "
         "at a\n# standstill; 0: it holds.\n[law]\nfamily = \"" +
         (law.of_gear() ? kGearFamily : kEffortFamily) + "\"\ntarget = " + quoted(law.target) + "\nstatus = \"" +
         law.status + "\"\n" + quantity("window", law.view.window_s, "s") +
         quantity("standstill", law.view.standstill, law.joint.catalogue->motion_unit() + "/s") +
         quantity("skew", law.view.skew_s, "s") + quantity("letting_go", law.view.letting_go_s, "s");
}

void write_effort_file(const std::string& path, const EffortLaw& law) {
  write_text_file(path, effort_file_text(law));
}

auto parse_effort_file(const std::string& text, const std::string& name) -> EffortLaw {
  return read_toml(text, name, "repair the line or write the file again with capstan diagnose",
                   [&name](const toml::table& root) { return parse_table(root, name); });
}

auto read_effort_file(const std::string& path) -> EffortLaw {
  return parse_effort_file(read_text_file(path), path);
}

auto is_effort_file(const std::string& path) -> bool {
  return schema_of(read_text_file(path)).starts_with(kEffortSchemas);
}

}  // namespace capstan::tools
