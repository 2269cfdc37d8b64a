// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/table_section.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kMostKnots = Table<double>::kKnots;

/// Places of the table's shapes.
enum Shape : std::size_t { kSignal, kKnots, kLow, kHigh, kFactor };

auto shape(const JointFile& joint, const CatalogueTerm& term, Shape which) -> double {
  return joint.parameters.shapes[term.first_shape + which];
}

auto list(const std::string& name, const std::vector<double>& values) -> std::string {
  std::string text = name + " = [";
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i > 0 ? ", " : "") + exact(values[i]);
  }
  return text + "]\n";
}

}  // namespace

auto table_signal_words() -> const std::vector<std::string>& {
  static const std::vector<std::string> kWords = {
      "motor_angle",     "torque",          "rate",       "time_since_reversal", "way_since_reversal", "coupled_angle",
      "coupled_angle_2", "coupled_angle_3", "temperature"};
  return kWords;
}

auto table_factor_words() -> const std::vector<std::string>& {
  static const std::vector<std::string> kWords = {"one", "torque", "rate", "motor_angle"};
  return kWords;
}

auto described_table(const double* shapes) -> std::string {
  const auto factor = static_cast<TableFactor>(std::lround(shapes[kFactor]));
  const std::string signal = describe(static_cast<TableSignal>(std::lround(shapes[kSignal])));
  return factor == TableFactor::kOne ? signal : signal + ", times " + describe(factor);
}

auto slots_of_table(const JointFile& joint) -> std::size_t {
  const auto signal = static_cast<TableSignal>(std::lround(shape(joint, joint.catalogue->term(kTableTerm), kSignal)));
  return signal == TableSignal::kOtherAngle         ? 1
         : signal == TableSignal::kSecondOtherAngle ? 2
         : signal == TableSignal::kThirdOtherAngle  ? 3
                                                    : 0;
}

auto table_text(const JointFile& joint, const CatalogueTerm& term) -> std::string {
  const auto signal = static_cast<std::size_t>(std::lround(shape(joint, term, kSignal)));
  const auto factor = static_cast<std::size_t>(std::lround(shape(joint, term, kFactor)));
  const auto count = std::min(static_cast<std::size_t>(std::lround(shape(joint, term, kKnots))), kMostKnots);
  const double low = shape(joint, term, kLow);
  const double high = shape(joint, term, kHigh);
  std::vector<double> knots;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.0;
    knots.push_back(i + 1 == count ? high : low + share * (high - low));
  }
  const auto values = [&](std::size_t first) {
    const auto begin =
        joint.parameters.coefficients.begin() + static_cast<std::ptrdiff_t>(term.first_coefficient + first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  const std::string text = "# over " + described_table(&joint.parameters.shapes[term.first_shape]) + "; values in rad" +
                           (factor > 0 ? " per unit of the factor" : "") + "\nsignal = \"" +
                           table_signal_words().at(signal) + "\"\n" + list("knots", knots) +
                           list("forward", values(0)) + list("backward", values(kMostKnots));
  return factor > 0 ? text + "factor = \"" + table_factor_words().at(factor) + "\"\n" : text;
}

auto fault_of(const TableLists& table) -> std::string {
  const auto& knots = table.knots;
  if (knots.size() < 2 || knots.size() > kMostKnots) {
    return "the table has " + std::to_string(knots.size()) + " knots; give 2 to " + std::to_string(kMostKnots);
  }
  if (table.forward.size() != knots.size() || table.backward.size() != knots.size()) {
    return "the table has " + std::to_string(knots.size()) + " knots, " + std::to_string(table.forward.size()) +
           " values forward and " + std::to_string(table.backward.size()) + " backward; give one for each knot";
  }
  for (std::size_t i = 1; i < knots.size(); ++i) {
    if (knots[i] <= knots[i - 1]) {
      return "knot " + std::to_string(i) + " of the table, " + rounded(knots[i], 6) +
             ", is not above the one before, " + rounded(knots[i - 1], 6) +
             "; put the knots in increasing order, and the values with them";
    }
  }
  const double cell = (knots.back() - knots.front()) / static_cast<double>(knots.size() - 1);
  constexpr double kUneven = 1e-4;  // of a cell: what rounding to six digits leaves of 17 knots far from zero
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (std::abs(knots[i] - (knots.front() + static_cast<double>(i) * cell)) > kUneven * cell) {
      return "knot " + std::to_string(i) + " of the table, " + rounded(knots[i], 6) +
             ", is not evenly spaced; interpolate the values at knots " + rounded(cell, 6) + " apart";
    }
  }
  return {};
}

void set_table(const TableLists& table, JointFile& joint) {
  const CatalogueTerm& term = joint.catalogue->term(kTableTerm);
  auto& shapes = joint.parameters.shapes;
  shapes[term.first_shape + kSignal] = static_cast<double>(table.signal);
  shapes[term.first_shape + kKnots] = static_cast<double>(table.knots.size());
  shapes[term.first_shape + kLow] = table.knots.front();
  shapes[term.first_shape + kHigh] = table.knots.back();
  shapes[term.first_shape + kFactor] = static_cast<double>(table.factor);
  const auto first = joint.parameters.coefficients.begin() + static_cast<std::ptrdiff_t>(term.first_coefficient);
  std::copy(table.forward.begin(), table.forward.end(), first);
  std::copy(table.backward.begin(), table.backward.end(), first + static_cast<std::ptrdiff_t>(kMostKnots));
}

}  // namespace capstan::tools
