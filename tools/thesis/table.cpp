// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace capstan::tools {
namespace {

constexpr std::size_t kWidth = 9;

auto padded(const std::string& text, std::size_t width) -> std::string {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : " " + text;
}

auto number(double value, int decimals) -> std::string {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return std::isnan(value) ? "-" : text.data();
}

/// Each group's name over its columns.
auto group_line(const ThesisTable& table, std::size_t first) -> std::string {
  std::string line(first, ' ');
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const bool begins = i == 0 || table.columns[i].group != table.columns[i - 1].group;
    line += padded(begins ? table.columns[i].group : "", kWidth);
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

/// A sentence on lines of at most 120 characters, after its head.
auto wrapped(const std::string& sentence, const std::string& head) -> std::string {
  constexpr std::size_t kLine = 120;
  const std::string text = head + sentence;
  const std::string indent = "  ";
  std::string result;
  std::string line = indent;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (line.size() + word.size() + 1 > kLine && line.size() > indent.size()) {
      result += line + "\n";
      line = std::string(indent.size(), ' ');
    }
    line += (line.size() > indent.size() ? " " : "") + word;
    begin = end + 1;
  }
  return result + line + "\n";
}

/// Names of the rows that share a reason.
auto names_with(const ThesisTable& table, const std::string& why) -> std::string {
  std::string names;
  for (const auto& row : table.rows) {
    if (row.why == why) {
      names += (names.empty() ? "" : ", ") + row.name;
    }
  }
  return names;
}

}  // namespace

auto table_text(const ThesisTable& table) -> std::string {
  std::size_t first = 8;
  for (const auto& row : table.rows) {
    first = std::max(first, row.name.size() + 4);
  }
  std::string text = "Table " + table.number + "  " + table.title + "\n" + group_line(table, first);
  text += std::string(first, ' ');
  for (const auto& column : table.columns) {
    text += padded(column.heading, kWidth);
  }
  text += "\n";
  for (const auto& row : table.rows) {
    text += "  " + row.name + std::string(first - row.name.size() - 2, ' ');
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      text += padded(number(row.values[i], table.columns[i].decimals), kWidth);
    }
    text += "\n";
  }
  for (const auto& condition : table.conditions) {
    text += wrapped(condition, "");
  }
  std::vector<std::string> said;
  for (const auto& row : table.rows) {
    if (!row.why.empty() && std::find(said.begin(), said.end(), row.why) == said.end()) {
      said.push_back(row.why);
      text += wrapped(row.why, names_with(table, row.why) + ": ");
    }
  }
  return text;
}

auto table_json(const ThesisTable& table) -> nlohmann::json {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : table.rows) {
    nlohmann::json entry = {{"name", row.name}, {"why", row.why}};
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const auto& column = table.columns[i];
      entry[column.group][column.key] = std::isnan(row.values[i]) ? nlohmann::json() : nlohmann::json(row.values[i]);
    }
    rows.push_back(std::move(entry));
  }
  nlohmann::json units;
  for (const auto& column : table.columns) {
    units[column.key] = column.unit;
  }
  return {{"table", table.number},
          {"title", table.title},
          {"units", units},
          {"conditions", table.conditions},
          {"rows", rows}};
}

}  // namespace capstan::tools
