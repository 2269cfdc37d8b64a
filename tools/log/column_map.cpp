// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/column_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/nearest.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// What is read of the whole log, of each axis, and of each jaw that a camera follows.
constexpr std::array kOfLog = {"time_s", "temperature_C", "site"};
constexpr std::array kOfAxis = {"q1_rad",     "q1_m",       "tau_Nm",     "tau_N",      "q2_rad",
                                "tau_out_Nm", "q2_est_rad", "q2_ref_rad", "tau_cmd_Nm", "tau_exc_Nm"};
constexpr std::array kOfJaw = {"qw", "qx", "qy", "qz"};

/// "axis" for "axis12".
auto without_number(std::string_view stem) -> std::string_view {
  const auto last = stem.find_last_not_of("0123456789");
  return last == std::string_view::npos || last + 1 == stem.size() ? stem : stem.substr(0, last + 1);
}

/// Whether some command reads a column of that name without being told so by --target.
auto is_contract_column(const std::string& name) -> bool {
  const auto slash = name.find('/');
  if (slash == std::string::npos) {
    return is_one_of(kOfLog, name);
  }
  const std::string_view stem = std::string_view(name).substr(0, slash);
  const std::string_view quantity = std::string_view(name).substr(slash + 1);
  if (stem == "tip_right" || stem == "tip_left") {
    return is_one_of(kOfJaw, quantity);
  }
  return stem != "axis" && without_number(stem) == "axis" && is_one_of(kOfAxis, quantity);
}

/// The name that was probably meant, in the stem that was written.
auto meant_by(const std::string& wanted) -> std::string {
  const auto slash = wanted.find('/');
  const std::string stem = slash == std::string::npos ? "" : wanted.substr(0, slash + 1);
  std::vector<std::string> known;
  for (const char* name : kOfAxis) {
    known.push_back(stem + name);
  }
  known.insert(known.end(), kOfLog.begin(), kOfLog.end());
  const auto name = nearest(wanted, known);
  return name && is_contract_column(*name) ? "did you mean " + *name + "? " : "";
}

}  // namespace

void expect_read(const std::vector<ColumnMapping>& mappings, const std::vector<std::string>& targets) {
  for (const auto& mapping : mappings) {
    if (!is_contract_column(mapping.wanted) && !is_one_of(targets, mapping.wanted)) {
      throw BadInput("--map " + mapping.wanted + "=" + mapping.expression + ": nothing reads a column " +
                     mapping.wanted + "; " + meant_by(mapping.wanted) + "read are " +
                     joined({kOfLog.begin(), kOfLog.end()}) + ", of each axis, as axis0/q1_rad, " +
                     joined({kOfAxis.begin(), kOfAxis.end()}) + ", and tip_right/qw to qz and tip_left/qw to qz");
    }
  }
}

auto mapping_form() -> std::string {
  return "; write it as --map axis0/q1_rad=q1_motor_rad, --map \"axis0/tau_Nm=current*0.0369\" or --map "
         "\"axis0/q1_rad=deg(0.5*(left + right))\"";
}

auto ColumnMapping::scaled() const -> std::optional<std::pair<std::string, double>> {
  const auto star = expression.rfind('*');
  if (star == std::string::npos) {
    return std::nullopt;
  }
  const auto factor = parse_number(std::string_view(expression).substr(star + 1));
  if (!factor || !std::isfinite(*factor)) {
    return std::nullopt;
  }
  return std::pair(std::string(trimmed(std::string_view(expression).substr(0, star))), *factor);
}

auto parse_mapping(const std::string& text) -> ColumnMapping {
  const auto equals = text.find('=');
  if (equals == std::string::npos) {
    throw BadInput("--map " + text + ": there is no '='" + mapping_form());
  }
  ColumnMapping mapping;
  mapping.wanted = trimmed(std::string_view(text).substr(0, equals));
  mapping.expression = trimmed(std::string_view(text).substr(equals + 1));
  if (mapping.wanted.empty() || mapping.expression.empty()) {
    throw BadInput("--map " + text + ": a column name is missing" + mapping_form());
  }
  const auto star = mapping.expression.rfind('*');
  if (star != std::string::npos) {
    const auto last = trimmed(std::string_view(mapping.expression).substr(star + 1));
    const auto factor = parse_number(last);
    if (last.empty() || (factor && (!std::isfinite(*factor) || *factor == 0.0))) {
      throw BadInput("--map " + text + ": the factor after '*' is not a number other than zero" + mapping_form());
    }
  }
  return mapping;
}

auto parse_mappings(const std::vector<std::string>& texts) -> std::vector<ColumnMapping> {
  std::vector<ColumnMapping> mappings;
  for (const auto& text : texts) {
    mappings.push_back(parse_mapping(text));
    for (std::size_t i = 0; i + 1 < mappings.size(); ++i) {
      if (mappings[i].wanted == mappings.back().wanted) {
        throw BadInput("--map gives " + mappings.back().wanted + " twice; keep one of them");
      }
    }
  }
  return mappings;
}

}  // namespace capstan::tools
