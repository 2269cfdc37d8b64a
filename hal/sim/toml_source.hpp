// SPDX-License-Identifier: Apache-2.0
#pragma once

// The library asserts what a person can type ("[$x]"); without that its own error says so.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace capstan::sim {

/// A file being read: knows its name for errors. Every refusal is a ScenarioError, "file:line: sentence; cure".
struct Source {
  std::filesystem::path file;
  std::filesystem::path instruments_folder;

  [[noreturn]] void fail(const toml::source_region& where, const std::string& sentence) const;

  /// Turns a checker's refusal into one with file and line.
  template <class Action>
  auto located(const toml::node& node, Action&& action) const {
    try {
      return action();
    } catch (const std::invalid_argument& refusal) {
      fail(node.source(), refusal.what());
    }
  }

  [[nodiscard]] double number(const std::string& key, const toml::node& node) const;
  [[nodiscard]] int integer(const std::string& key, const toml::node& node) const;
  [[nodiscard]] std::string text(const std::string& key, const toml::node& node) const;
  [[nodiscard]] const toml::table& table(const std::string& key, const toml::node& node) const;
  [[nodiscard]] const toml::array& array(const std::string& key, const toml::node& node) const;
};

using Reader = std::function<void(const std::string& key, const toml::node& value)>;
using Readers = std::map<std::string, Reader, std::less<>>;

/// Every key of the table must have a reader: this is where unknown keys are refused.
void read_table(const Source& source, const std::string& what, const toml::table& table, const Readers& readers);

[[nodiscard]] toml::table parse_toml(std::string_view text, const Source& source);

/// The whole file. Throws ScenarioError.
[[nodiscard]] std::string contents(const std::filesystem::path& file);

}  // namespace capstan::sim
