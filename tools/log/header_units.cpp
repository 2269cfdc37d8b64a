// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/header_units.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct UnitName {
  std::string_view written;
  std::string_view si;
  double factor;
};

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array kUnits = {
    UnitName{"s", "s", 1.0},       UnitName{"sec", "s", 1.0},       UnitName{"seconds", "s", 1.0},
    UnitName{"ms", "s", 1e-3},     UnitName{"us", "s", 1e-6},       UnitName{"µs", "s", 1e-6},
    UnitName{"μs", "s", 1e-6},     UnitName{"ns", "s", 1e-9},       UnitName{"rad", "rad", 1.0},
    UnitName{"mrad", "rad", 1e-3}, UnitName{"deg", "rad", kDegree}, UnitName{"°", "rad", kDegree},
    UnitName{"m", "m", 1.0},       UnitName{"mm", "m", 1e-3},       UnitName{"Nm", "Nm", 1.0},
    UnitName{"N m", "Nm", 1.0},    UnitName{"N*m", "Nm", 1.0},      UnitName{"N·m", "Nm", 1.0},
    UnitName{"mNm", "Nm", 1e-3},   UnitName{"Nmm", "Nm", 1e-3},     UnitName{"N", "N", 1.0},
    UnitName{"kN", "N", 1e3},      UnitName{"C", "C", 1.0},         UnitName{"°C", "C", 1.0},
    UnitName{"degC", "C", 1.0},
};

struct NamedUnit {
  std::string stem;
  std::string_view unit;
};

/// "Name [unit]", "Name (unit)", "name_unit".
auto taken_apart(std::string_view name) -> std::optional<NamedUnit> {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const auto at = name.rfind(open);
    if (at != std::string_view::npos && name.back() == close) {
      return NamedUnit{std::string(trimmed(name.substr(0, at))), trimmed(name.substr(at + 1, name.size() - at - 2))};
    }
  }
  const auto at = name.rfind('_');
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  return NamedUnit{std::string(name.substr(0, at)), name.substr(at + 1)};
}

/// "Time" and "t" are time; blanks are '_'; upper case is lower.
auto plain_stem(std::string stem) -> std::string {
  std::transform(stem.begin(), stem.end(), stem.begin(), [](char c) {
    return c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  constexpr std::array kTimes = {"t", "timestamp", "zeit", "temps", "tiempo", "elapsed_time", "time_stamp"};
  return std::find(kTimes.begin(), kTimes.end(), stem) != kTimes.end() ? "time" : stem;
}

auto is_contract_stem(const std::string& stem) -> bool {
  if (stem == "time" || stem == "temperature") {
    return true;
  }
  const auto slash = stem.find('/');
  return stem.starts_with("axis") && slash != std::string::npos && slash > 4 &&
         std::all_of(stem.begin() + 4, stem.begin() + static_cast<std::ptrdiff_t>(slash),
                     [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

auto unit_named(std::string_view word) -> const UnitName* {
  const auto* const unit =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const UnitName& u) { return u.written == word; });
  return unit == kUnits.end() ? nullptr : &*unit;
}

struct Reading {
  std::string wanted;
  double factor = 1.0;
};

auto reading_of(const std::string& name) -> std::optional<Reading> {
  const auto apart = taken_apart(name);
  if (!apart || !is_contract_stem(plain_stem(apart->stem))) {
    return std::nullopt;
  }
  const UnitName* unit = unit_named(apart->unit);
  if (unit == nullptr) {
    return std::nullopt;
  }
  const std::string wanted = plain_stem(apart->stem) + "_" + std::string(unit->si);
  return Reading{wanted, unit->factor};
}

}  // namespace

auto mappings_by_unit(const std::vector<std::string>& names, const std::vector<ColumnMapping>& given,
                      const std::string& log, std::vector<std::string>& notes) -> std::vector<ColumnMapping> {
  std::map<std::string, std::vector<std::pair<std::string, double>>> found;
  for (const auto& name : names) {
    if (const auto reading = reading_of(name)) {
      found[reading->wanted].emplace_back(name, reading->factor);
    }
  }
  std::vector<ColumnMapping> mappings;
  for (const auto& [wanted, sources] : found) {
    const bool taken =
        std::find(names.begin(), names.end(), wanted) != names.end() ||
        std::any_of(given.begin(), given.end(), [&name = wanted](const auto& m) { return m.wanted == name; });
    if (taken || sources.size() > 1) {
      continue;
    }
    const auto& [source, factor] = sources.front();
    mappings.push_back({wanted, factor == 1.0 ? source : source + "*" + exact(factor)});
    notes.push_back(log + ": column " + source + " is read as " + wanted +
                    (factor == 1.0 ? "" : " (times " + rounded(factor, 6) + ")"));
  }
  return mappings;
}

void read_by_unit(ColumnMapping& mapping, const std::vector<std::string>& names, const std::string& log,
                  std::vector<std::string>& notes) {
  const auto of_column = taken_apart(mapping.expression);
  const auto of_wanted = taken_apart(mapping.wanted);
  if (!of_column || !of_wanted || std::find(names.begin(), names.end(), mapping.expression) == names.end()) {
    return;
  }
  const UnitName* given = unit_named(of_column->unit);
  const UnitName* wanted = unit_named(of_wanted->unit);
  if (given == nullptr || wanted == nullptr || given->si != wanted->si || given->factor == wanted->factor) {
    return;
  }
  const double factor = given->factor / wanted->factor;
  notes.push_back(log + ": column " + mapping.expression + " is read as " + mapping.wanted + " (times " +
                  rounded(factor, 6) + "); --map \"" + mapping.wanted + "=" + mapping.expression +
                  "*1\" takes its numbers as they are");
  mapping.expression += "*" + exact(factor);
}

}  // namespace capstan::tools
