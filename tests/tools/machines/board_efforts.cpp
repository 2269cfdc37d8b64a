// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/board_efforts.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/replay/effort_replay.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::machines {
namespace {

auto effort_log(const CsvLog& csv, int axis) -> AxisLog {
  AxisRequest request;
  request.axis = axis;
  request.effort = true;
  request.target = axis_column(axis, "tau_Nm");
  return read_axis(csv, request);
}

void print_row(const std::string& name, const AxisLog& whole, double share) {
  AxisLog learned = whole;
  const auto rows = static_cast<Eigen::Index>(share * static_cast<double>(whole.samples()));
  for_each_signal(learned,
                  [rows](Eigen::VectorXd& signal) { signal.conservativeResize(std::min(rows, signal.size())); });
  const auto left = [&](const Eigen::VectorXd& measured, const Eigen::VectorXd& estimate) {
    const Eigen::Index unseen = whole.samples() - rows;
    return 100.0 * rms((measured - estimate).tail(unseen)) / rms(measured.tail(unseen));
  };
  const EffortLaw with_others = select_effort_law({learned}).law;
  learned.side.clear();
  AxisLog alone = whole;
  alone.side.clear();
  const EffortLaw law = select_effort_law({learned}).law;
  const EffortDesign seen({whole}, law.view);
  const Eigen::VectorXd measured = seen.seen(whole.effort);
  std::printf("%-22s %6.1f %9.2f %9.2f ", name.c_str(), whole.rate_hz(),
              left(measured, run_effort_law({whole}, with_others)), left(measured, run_effort_law({alone}, law)));
  try {
    const BoardEffort board = run_board_effort(alone, board_effort_law(law, name, true), Arithmetic::kDouble);
    std::printf("%9.2f %9.2f %9.1f\n", left(measured, seen.seen(board.law)), left(whole.effort, board.law),
                1000.0 * whole.period_s * static_cast<double>(board.delay));
  } catch (const BadInput& refusal) {
    std::printf("%s\n", refusal.what());
  }
}

}  // namespace

void board_efforts(const std::string& folder, double share) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::printf("%-22s %6s %9s %9s %9s %9s %9s\n", "", "Hz", "noncausal", "alone", "causal", "each row", "late ms");
  for (const auto& file : files) {
    const CsvLog csv = CsvLog::read(file.string());
    for (int axis = 0; axis < kMostAxes; ++axis) {
      const bool effort = csv.has(axis_column(axis, "q1_rad")) && csv.has(axis_column(axis, "tau_Nm")) &&
                          !csv.has(axis_column(axis, "q2_rad")) && !csv.has(axis_column(axis, "tau_out_Nm"));
      if (effort) {
        print_row(file.stem().string() + (axis > 0 ? ":" + std::to_string(axis) : ""), effort_log(csv, axis), share);
      }
    }
  }
}

}  // namespace capstan::tools::machines
