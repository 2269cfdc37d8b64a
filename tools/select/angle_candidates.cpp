// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/model/terms/table.hpp"
#include "capstan/tools/select/vocabulary.hpp"
#include "capstan/tools/support/geometric_grid.hpp"

namespace capstan::tools {
namespace {

/// Seconds in the unit of a time.
auto seconds_in(const std::string& unit) -> double {
  constexpr double kMinute = 60.0;
  return unit == "min" ? kMinute : 1.0;
}

/// What a shape may be, from the log: shares of its ranges, times from a few samples to a part of its length.
auto values_of(const ShapeInfo& shape, const SignalRanges& ranges, const DecidingNumbers& numbers)
    -> std::vector<double> {
  const auto shares = [&numbers](double range, double low, double high) {
    return range > 0.0 ? geometric_grid(low * range, high * range, numbers.shape_values) : std::vector<double>{};
  };
  switch (shape.of) {
    case ShapeOf::kMotorRange:
      return shares(ranges.q1, numbers.narrowest_play, numbers.widest_play);
    case ShapeOf::kTorqueRange:
      return shares(ranges.tau, numbers.smallest_share, 1.0);
    case ShapeOf::kOtherRange:
      return shares(ranges.others.front(), numbers.smallest_share, numbers.widest_play);
    case ShapeOf::kTime:
      return geometric_grid(numbers.shortest_time * ranges.period_s / seconds_in(shape.unit),
                            numbers.longest_time * ranges.length_s / seconds_in(shape.unit), numbers.shape_values);
    case ShapeOf::kNothing:
    case ShapeOf::kMotorSpeed:  // of efforts
    case ShapeOf::kGiven:
      break;
  }
  return shape.scale == ShapeScale::kRatio && shape.minimum > 0.0
             ? geometric_grid(shape.minimum, shape.maximum, numbers.shape_values)
             : std::vector<double>{shape.initial};
}

/// Every combination of the values of a term's shapes; none where the log has nothing that one is a share of.
auto settings_of(const CatalogueTerm& term, const SignalRanges& ranges, const DecidingNumbers& numbers)
    -> std::vector<Shapes> {
  return combinations(term.shapes, [&](const auto& shape) { return values_of(shape, ranges, numbers); });
}

void add_couplings(const SignalRanges& ranges, const DecidingNumbers& numbers, std::vector<TermGrid>& terms) {
  constexpr const char* kOfSlot[] = {"coupled_hysteresis", "coupled_hysteresis_2", "coupled_hysteresis_3"};
  for (std::size_t slot = 0; slot < ranges.others.size(); ++slot) {
    const double range = ranges.others[slot];
    if (range > 0.0) {
      terms.push_back(
          {kOfSlot[slot], one_by_one(geometric_grid(numbers.narrowest_coupled_play * range, numbers.widest_play * range,
                                                    numbers.coupled_play_widths))});
    }
  }
}

/// Angles of the coupled joints, by slot.
constexpr TableSignal kOtherAngles[] = {TableSignal::kOtherAngle, TableSignal::kSecondOtherAngle,
                                        TableSignal::kThirdOtherAngle};

auto table_over(TableSignal signal, double knots, double centre, double range, TableFactor factor = TableFactor::kOne)
    -> Shapes {
  return {static_cast<double>(signal), knots, centre - 0.5 * range, centre + 0.5 * range, static_cast<double>(factor)};
}

/// A signal that tables are drawn over, and what it makes no sense to multiply them by.
struct TabledSignal {
  TableSignal signal;
  double centre = 0.0, range = 0.0;
  TableFactor same = TableFactor::kOne;  ///< the signal itself as a factor
};

/// Signals that have a range in this log.
auto tabled_signals(const SignalRanges& ranges) -> std::vector<TabledSignal> {
  std::vector<TabledSignal> signals = {
      {TableSignal::kMotorAngle, ranges.q1_centre, ranges.q1, TableFactor::kMotorAngle},
      {TableSignal::kTorque, ranges.tau_centre, ranges.tau, TableFactor::kTorque},
      {TableSignal::kRate, ranges.rate_centre, ranges.rate, TableFactor::kRate},
      {TableSignal::kSinceReversal, 0.5 * ranges.since_s, ranges.since_s},
      {TableSignal::kTravelledSince, 0.5 * ranges.travelled, ranges.travelled},
      {TableSignal::kWarmth, ranges.warmth_centre, ranges.warmth}};
  for (std::size_t slot = 0; slot < ranges.others.size(); ++slot) {
    signals.push_back({kOtherAngles[slot], ranges.others_centre[slot], ranges.others[slot]});
  }
  std::erase_if(signals, [](const auto& one) { return !(one.range > 0.0); });
  return signals;
}

/// Whatever depends on one signal, times another: torque that ripples with the angle, friction that grows with rate
/// and torque, wear. Values of both directions together on the finer grid, of each for itself on the coarser one.
void add_wider_tables(const SignalRanges& ranges, const DecidingNumbers& numbers, std::vector<TermGrid>& terms) {
  TermGrid together{"table", {}};
  TermGrid apart{"table", {}, true};
  for (const auto& one : tabled_signals(ranges)) {
    for (const TableFactor factor :
         {TableFactor::kOne, TableFactor::kTorque, TableFactor::kRate, TableFactor::kMotorAngle}) {
      const bool known = factor != TableFactor::kTorque || ranges.tau > 0.0;
      if (known && (factor == TableFactor::kOne || factor != one.same)) {
        const auto of = [&](std::size_t knots) {
          return table_over(one.signal, static_cast<double>(knots), one.centre, one.range, factor);
        };
        together.settings.push_back(of(numbers.fine_table_knots));
        if (one.signal != TableSignal::kRate) {  // its sign is the direction
          apart.settings.push_back(
              of(one.signal == TableSignal::kMotorAngle ? numbers.fine_table_knots : numbers.table_knots));
        }
      }
    }
  }
  terms.push_back(std::move(together));
  terms.push_back(std::move(apart));
}

void add_tables(const SignalRanges& ranges, const DecidingNumbers& numbers, std::vector<TermGrid>& terms) {
  const auto knots = static_cast<double>(numbers.table_knots);
  TermGrid tables{"table", {table_over(TableSignal::kMotorAngle, knots, ranges.q1_centre, ranges.q1)}};
  if (ranges.tau > 0.0) {
    tables.settings.push_back(table_over(TableSignal::kTorque, knots, ranges.tau_centre, ranges.tau));
  }
  for (std::size_t slot = 0; slot < ranges.others.size(); ++slot) {
    if (ranges.others[slot] > 0.0) {
      tables.settings.push_back(table_over(kOtherAngles[slot], knots, ranges.others_centre[slot], ranges.others[slot]));
    }
  }
  terms.push_back(std::move(tables));
}

/// A joint file takes no shape beyond its limits.
void keep_within_limits(const Catalogue& catalogue, Vocabulary& vocabulary) {
  const auto beyond = [](const ShapeInfo& shape, double value) {
    return value < shape.minimum || value > shape.maximum;
  };
  for (auto& grid : vocabulary.terms) {
    const auto& infos = catalogue.term(grid.term).shapes;
    std::erase_if(grid.settings, [&](const Shapes& shapes) {
      return !std::equal(shapes.begin(), shapes.end(), infos.begin(),
                         [&](double value, const ShapeInfo& info) { return !beyond(info, value); });
    });
  }
  const ShapeInfo& half_width = catalogue.term("hysteresis").shapes.front();
  std::erase_if(vocabulary.plays, [&](double value) { return beyond(half_width, value); });
}

}  // namespace

auto angle_vocabulary(const SelectionData& data) -> Vocabulary {
  const SignalRanges& ranges = data.ranges();
  const DecidingNumbers& numbers = data.numbers();
  Vocabulary vocabulary;
  vocabulary.start.terms = {{"motor_angle", {}}, {"joint_offset", {}}};
  vocabulary.starts = {vocabulary.start};
  vocabulary.plays = data.play_widths();
  vocabulary.terms.push_back({"presliding", one_by_one(data.play_widths())});
  vocabulary.terms.push_back({"curved_ratio", {{ranges.q1_centre, 0.5 * ranges.q1}}});
  add_couplings(ranges, numbers, vocabulary.terms);
  add_tables(ranges, numbers, vocabulary.terms);
  for (const auto& term : data.catalogue()) {
    const bool listed = std::any_of(vocabulary.terms.begin(), vocabulary.terms.end(),
                                    [&](const auto& grid) { return grid.term == term.name; });
    // Gravity acts at the law's own angle: it is judged in a law that was found, on that law's estimate.
    const bool apart = term.placed || term.form_free || term.name == "play" || term.name == "gravity";
    if (!listed && !apart && !vocabulary.start.has(term.name)) {
      vocabulary.terms.push_back({term.name, settings_of(term, ranges, numbers)});
    }
  }
  keep_within_limits(data.catalogue(), vocabulary);
  return vocabulary;
}

auto wider_vocabulary(const SelectionData& data, std::vector<LawCandidate> starts) -> Vocabulary {
  Vocabulary vocabulary = angle_vocabulary(data);
  add_wider_tables(data.ranges(), data.numbers(), vocabulary.terms);
  keep_within_limits(data.catalogue(), vocabulary);
  vocabulary.starts = std::move(starts);
  return vocabulary;
}

}  // namespace capstan::tools
