// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/model/turn_play.hpp"
#include "capstan/tools/identify/error_bar.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {
namespace {

/// A board's depth of memory; what a log has beside that no board knows either.
using Law = ForceLaw<double, kMostPreisachLevels, 16>;

/// One log: its motor torque, and the law's error where the law knows.
struct Errors {
  const Eigen::VectorXd* motor_nm;
  std::vector<double> size_nm;  ///< negative: not known
};

auto errors_of(const AxisLog& log, const ForceLawParameters<double>& parameters, const PreisachTable& table) -> Errors {
  Law law;
  law.become(parameters, table);
  Errors errors{&log.tau_nm, {}};
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const auto estimate = law.update(log.tau_nm[i]);
    const bool told = estimate.known && !estimate.beyond_table && !estimate.saturated;
    errors.size_nm.push_back(told ? std::abs(estimate.force - log.effort[i]) : -1.0);
  }
  return errors;
}

/// Widths beyond a turn and near one.
auto with_turn(const std::vector<Errors>& all, double turn_nm) -> std::optional<std::pair<HeldWidth, HeldWidth>> {
  std::vector<double> sizes[2];
  for (const Errors& log : all) {
    TurnPlay<double> play;
    for (std::size_t i = 0; i < log.size_nm.size(); ++i) {
      const bool turning = play.update((*log.motor_nm)[static_cast<Eigen::Index>(i)], turn_nm);
      if (log.size_nm[i] >= 0.0) {
        sizes[turning ? 1 : 0].push_back(log.size_nm[i]);
      }
    }
  }
  const auto steady = held_width(sizes[0]);
  const auto turning = held_width(sizes[1]);
  return steady && turning ? std::optional(std::pair(*steady, *turning)) : std::nullopt;
}

}  // namespace

auto force_law_of(const PullPushFit& fit) -> ForceLawParameters<double> {
  return {.kind = fit.kind,
          .pull_push = fit.law,
          .friction_nm = std::max(fit.friction_nm, 0.0),
          .offset_nm = fit.offset_nm};
}

auto joint_torque_by(const PullPushFit& fit, const Eigen::VectorXd& tau_nm) -> Eigen::VectorXd {
  const PreisachTable none;
  Law law;
  law.become(force_law_of(fit), none);
  Eigen::VectorXd torque(tau_nm.size());
  for (Eigen::Index i = 0; i < torque.size(); ++i) {
    torque[i] = law.update(tau_nm[i]).force;
  }
  return torque;
}

auto force_error_bar(const std::vector<AxisLog>& logs, const ForceLawParameters<double>& law,
                     const PreisachTable& table) -> std::optional<ForceErrorNumbers> {
  constexpr double kBeyond = 0.05;  // a board that goes where the logs went passes their ends by as much at times
  constexpr std::array<double, 6> kTurns = {0.05, 0.1, 0.2, 0.3, 0.4, 0.6};  // shares of the range of torque
  Law there;
  there.become(law, table);
  if (!there.is_there()) {
    return std::nullopt;
  }
  std::vector<Errors> all;
  std::vector<double> sizes;
  double most = 0.0;
  double range = 0.0;
  for (const AxisLog& log : logs) {
    all.push_back(errors_of(log, law, table));
    std::copy_if(all.back().size_nm.begin(), all.back().size_nm.end(), std::back_inserter(sizes),
                 [](double size) { return size >= 0.0; });
    most = std::max(most, log.tau_nm.cwiseAbs().maxCoeff());
    range = std::max(range, log.tau_nm.maxCoeff() - log.tau_nm.minCoeff());
  }
  const auto whole = held_width(sizes);
  if (!whole) {
    return std::nullopt;
  }
  ForceErrorNumbers best{{whole->half, whole->half, kTurns.back() * range, (1.0 + kBeyond) * most}};
  double loss = std::numeric_limits<double>::max();
  for (const double share : kTurns) {
    const auto widths = with_turn(all, share * range);
    if (widths && widths->first.loss + widths->second.loss < loss) {
      loss = widths->first.loss + widths->second.loss;
      best.values = {widths->first.half, widths->second.half, share * range, best.values[3]};
    }
  }
  best.values[0] *= kOtherLoops;
  best.values[1] *= kOtherLoops;
  return best;
}

}  // namespace capstan::tools
