// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "capstan/model/tension_state.hpp"
#include "capstan/tools/identify/bounded_search.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/thesis/chapter4.hpp"
#include "capstan/tools/thesis/hysteresis_laws.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kRuns = 3;
using Runs = std::array<ForceRun, kRuns>;

auto preisach_row(const ForceRun& learned, const Runs& runs, const PreisachGrid& grid) -> std::vector<double> {
  const ForceSurface surface = fitted_surface(learned, grid);
  std::vector<double> shares;
  for (const ForceRun& run : runs) {
    shares.push_back(share_of(preisach_estimate(surface, run), run));
  }
  const double values = 0.5 * static_cast<double>(grid.levels * (grid.levels + 3));
  shares.push_back(values * sizeof(float));
  return shares;
}

constexpr Eigen::Index kEvery = 4;  // of 10 ms at 1 V/s: 0.04 V, as the averaged rows of Preisach's fit

auto thinned(const Eigen::VectorXd& signal) -> Eigen::VectorXd {
  return signal(Eigen::seqN(0, signal.size() / kEvery, kEvery));
}

auto hysteresis_row(HysteresisLaw::Kind kind, const ForceRun& learned, const Runs& runs, double bytes)
    -> std::vector<double> {
  const HysteresisLaw law(kind, thinned(learned.input_v) / kSaturationV, thinned(learned.torque_nm));
  std::vector<double> shares;
  for (const ForceRun& run : runs) {
    shares.push_back(share_of(law.estimate(run.input_v / kSaturationV), run));
  }
  shares.push_back(bytes);
  return shares;
}

/// Both tendons' tensions; told the direction by the voltage.
auto tendon_estimate(const TensionStateParameters<double>& parameters, const Eigen::VectorXd& input_v)
    -> Eigen::VectorXd {
  constexpr double kLeadIn = 0.01;  // V
  TensionState<double> state(parameters);
  bool forward = true;
  double last = 0.0;
  const auto step = [&](double next) {
    forward = last == next ? forward : last < next;
    last = next;
    return state.update(0.0, next * kTorquePerVolt, forward).joint_torque;
  };
  for (const double way : {-kSaturationV, input_v[0]}) {
    while (last != way) {
      (void)step(last + std::clamp(way - last, -kLeadIn, kLeadIn));
    }
  }
  Eigen::VectorXd torque(input_v.size());
  std::transform(input_v.begin(), input_v.end(), torque.begin(), step);
  return torque;
}

/// Parameters: both eta, pretension over 0.1 N m, compliance of the bottom over the top, beta, friction over 0.01 N m.
auto tendons_of(const Eigen::VectorXd& p) -> TensionStateParameters<double> {
  return {p[0], p[1], 0.1 * p[2], 1.0, p[3], p[4], 0.0, 0.01 * p[5]};
}

class TendonsLeft final : public SteppedResidual {
 public:
  TendonsLeft(Eigen::VectorXd input_v, Eigen::VectorXd torque_nm)
      : input_v_(std::move(input_v)), torque_nm_(std::move(torque_nm)) {}

 private:
  auto left_of(const Eigen::VectorXd& parameters) -> Eigen::VectorXd override {
    return tendon_estimate(tendons_of(parameters), input_v_) - torque_nm_;
  }
  Eigen::VectorXd input_v_, torque_nm_;
};

/// This run makes no tendon slack for long, so that `identify --model pull_push` refuses it; the same law, searched.
auto tendon_row(const ForceRun& learned, const Runs& runs) -> std::vector<double> {
  Eigen::VectorXd low(6), start(6), high(6);
  low << 0.05, 0.05, 0.05, 0.3, 0.5, 0.0;
  start << 0.7, 0.7, 0.5, 1.0, 1.0, 0.2;
  high << 2.9, 2.9, 5.0, 3.0, 2.0, 3.0;
  TendonsLeft left(thinned(learned.input_v), thinned(learned.torque_nm));
  const auto parameters = tendons_of(least_squares_within({low, high}, start, left).parameters);
  std::vector<double> shares;
  for (const ForceRun& run : runs) {
    shares.push_back(share_of(tendon_estimate(parameters, run.input_v), run));
  }
  shares.push_back(sizeof(float) * 6.0);
  return shares;
}

}  // namespace

auto table_4_1_laws() -> ThesisTable {
  ThesisTable table{
      "4.1 laws",
      "RMS over magnitude of laws that learned the same run of first-order reversals, on three others",
      {"Every law is fitted to one run of 41 reversals at 1 V/s (seed 400); u1 to u3 took no part in fit or "
       "choice. Preisach's tables and adaptive levels are those of capstan identify --model preisach "
       "--levels N (--adaptive-levels); `tendon` is the tension state with six numbers, told "
       "the direction. Bytes: a law's numbers on a board, without its past."},
      {},
      {}};
  for (std::size_t s = 0; s < kRuns; ++s) {
    table.columns.push_back({"held out", "u" + std::to_string(s + 1), "u" + std::to_string(s + 1) + " %", "%", 1});
  }
  table.columns.push_back({"memory", "bytes", "bytes", "1", 0});
  const ForceRun learned = reversal_run(kMostLevels);
  const Runs runs = {run_of_chapter_4(0), run_of_chapter_4(1), run_of_chapter_4(2)};
  table.rows.push_back({"printed, 11 levels", {2.3, 3.6, 4.0, std::nan("")}});
  for (const std::size_t levels : {11U, 21U, 41U}) {
    table.rows.push_back({"Preisach " + std::to_string(levels), preisach_row(learned, runs, {levels, false})});
    if (levels < kMostLevels) {
      table.rows.push_back(
          {"Preisach " + std::to_string(levels) + ", adaptive", preisach_row(learned, runs, {levels, true})});
    }
  }
  table.rows.push_back({"tendon", tendon_row(learned, runs)});
  table.rows.push_back({"Bouc-Wen", hysteresis_row(HysteresisLaw::Kind::kBoucWen, learned, runs, 24.0)});
  table.rows.push_back({"Coleman-Hodgdon", hysteresis_row(HysteresisLaw::Kind::kColemanHodgdon, learned, runs, 28.0)});
  return table;
}

}  // namespace capstan::tools
