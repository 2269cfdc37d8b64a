// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/machine_lines.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "capstan/firmware/parameters/parameter_text.hpp"
#include "capstan/tools/support/toml_text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kLongest = 48;  // characters of a name or a value; the shell's line has room for both

auto is_plain(std::string_view text, std::string_view more) -> bool {
  return !text.empty() && text.size() <= kLongest && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || more.find(c) != std::string_view::npos;
  });
}

[[noreturn]] void fail(const std::string& file, const toml::source_region& where, const std::string& sentence) {
  throw BadInput(file + ":" + std::to_string(where.begin.line) + ": " + sentence);
}

void add_joint(const std::string& joint, const toml::table& table, const std::string& file,
               std::vector<std::string>& lines) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const toml::value<std::string>* value = node.as_string();
    // What stands here is typed at the board's prompt, so it is a name and a number with its unit and nothing else.
    if (!is_plain(name, "_.") || value == nullptr || !is_plain(value->get(), " +-./ABCDEFGHIJKLMNOPQRSTUVWXYZ")) {
      fail(file, node.source(),
           "'" + name +
               "' is no parameter with its value in quotes, as \"control.kp\" = \"0.5\"; write it so, or take "
               "the line out");
    }
    lines.push_back("set " + joint + "." + name + " " + value->get());
  }
}

auto lines_of(const toml::table& root, const std::string& file) -> std::vector<std::string> {
  if (root["schema"].value<std::string>() != kMachineSchema) {
    throw BadInput(place(file, 1) + "the schema is not " + std::string(kMachineSchema) +
                   "; give the machine.toml that 'capstan commission' of this version writes");
  }
  std::vector<std::string> lines = {"maintenance open", "begin"};
  for (const auto& [key, node] : root) {
    const std::string joint(key.str());
    if (joint == "schema") {
      continue;
    }
    const bool known = joint.size() == 6 && joint.starts_with("joint") && joint.back() >= '0' && joint.back() <= '3';
    if (!known || node.as_table() == nullptr) {
      fail(file, node.source(), "'" + joint + "' is none of [joint0] to [joint3]; take it out");
    }
    add_joint(joint, *node.as_table(), file, lines);
  }
  if (lines.size() == 2) {
    throw BadInput(file + ": sets nothing; give the machine.toml of a completed commissioning");
  }
  lines.insert(lines.end(), {"commit", "maintenance close"});
  return lines;
}

}  // namespace

auto reports(const std::string& answer, const std::string& set_line) -> bool {
  std::istringstream asked(set_line);
  std::string command;
  std::string name;
  std::string text;
  asked >> command >> name;
  std::getline(asked >> std::ws, text);
  std::istringstream answered(answer);
  std::string answered_name;
  std::string unit;
  double value = 0.0;
  if (!(answered >> answered_name >> value) || answered_name != name) {
    return false;
  }
  answered >> unit;
  std::istringstream parts(text);
  std::string given_unit;
  double wanted = 0.0;
  parts >> wanted >> given_unit;
  if (Q24 converted; given_unit != unit && parse_quantity(text, unit, converted) == ValueError::kNone) {
    wanted = converted.to_double();
  }
  constexpr double kRounding = 8.1e-8;  // half of 2^-24, and half of the last decimal
  return std::abs(value - wanted) <= kRounding;
}

auto machine_lines(const std::string& text, const std::string& file) -> std::vector<std::string> {
  return read_toml(text, file, "repair the line", [&file](const toml::table& root) { return lines_of(root, file); });
}

}  // namespace capstan::tools
