// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/board_efforts.hpp"

#include <cstdio>

#include "capstan/tools/replay/effort_replay.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::machines {
namespace {

void print_row(const std::string& name, const AxisLog& whole, double share) {
  const auto rows = static_cast<Eigen::Index>(share * static_cast<double>(whole.samples()));
  AxisLog learned = first_rows(whole, rows);
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

void board_efforts(const std::vector<Joint>& joints, double share) {
  std::printf("%-22s %6s %9s %9s %9s %9s %9s\n", "", "Hz", "noncausal", "alone", "causal", "each row", "late ms");
  for (const auto& joint : joints) {
    if (joint.kind == Kind::kEffort && !joint.log.linear) {
      print_row(joint.name, joint.log, share);
    }
  }
}

}  // namespace capstan::tools::machines
