// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/toml_source.hpp"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>

#include "capstan/hal/sim/scenario.hpp"

namespace capstan::sim {

void Source::fail(const toml::source_region& where, const std::string& sentence) const {
  throw ScenarioError(file.string() + ":" + std::to_string(where.begin.line) + ": " + sentence);
}

double Source::number(const std::string& key, const toml::node& node) const {
  const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value))
    fail(node.source(), "`" + key + "` is not a number; write it like 0.5");
  return *value;
}

int Source::integer(const std::string& key, const toml::node& node) const {
  const std::optional<std::int64_t> value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!value || *value < -2147483647 || *value > 2147483647) {
    fail(node.source(), "`" + key + "` is not a whole number; write it like 4");
  }
  return static_cast<int>(*value);
}

std::string Source::text(const std::string& key, const toml::node& node) const {
  const std::optional<std::string> value = node.value_exact<std::string>();
  if (!value)
    fail(node.source(), "`" + key + "` is not a text; put it in double quotes");
  return *value;
}

const toml::table& Source::table(const std::string& key, const toml::node& node) const {
  if (!node.is_table())
    fail(node.source(), "`" + key + "` is not a table; write it as [" + key + "]");
  return *node.as_table();
}

const toml::array& Source::array(const std::string& key, const toml::node& node) const {
  if (!node.is_array())
    fail(node.source(), "`" + key + "` is not a list; put its items in [ ]");
  return *node.as_array();
}

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

toml::table parse_toml(std::string_view text, const Source& source) {
  try {
    return toml::parse(text, source.file.string());
  } catch (const toml::parse_error& error) {
    source.fail(error.source(), std::string(error.description()) + "; correct the TOML syntax");
  }
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || std::filesystem::is_directory(file) || !(text << stream.rdbuf())) {
    throw ScenarioError(file.string() + ":1: the file cannot be read; check the path and that it is not empty");
  }
  return text.str();
}

}  // namespace capstan::sim
