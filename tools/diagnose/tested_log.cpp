// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/tested_log.hpp"

#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/pull_push_base.hpp"

namespace capstan::tools {
namespace {

auto by_joint(const AxisLog& log, const JointFile& law) -> ErrorSummary {
  const LawDesign design({log}, law.parameters.conditioner);
  Eigen::VectorXd estimate = estimates({log}, design, law);
  estimate.array() += (log.measured() - estimate).mean();
  return error_summary(log.measured(), estimate);
}

auto by_effort_law(const AxisLog& log, const std::vector<AxisLog>& fitted, const Diagnosis& d) -> TestedLog {
  const EffortDesign seen({log}, d.effort_law->view);
  const Eigen::VectorXd measured = seen.seen(log.effort);
  const auto by_base = [&]() -> Eigen::VectorXd {
    if (d.base.has("pull_push")) {
      return seen.seen(run_pull_push_base(log, d.base, d.pull_push));
    }
    EffortLaw base = runnable_law(d.base, fitted);
    base.view = d.effort_law->view;
    return run_effort_law({log}, base);
  };
  return {log.name, error_summary(measured, by_base()), error_summary(measured, run_effort_law({log}, *d.effort_law))};
}

}  // namespace

auto tested_log(const AxisLog& log, const std::vector<AxisLog>& fitted, const Diagnosis& d) -> TestedLog {
  if (d.effort_law) {
    return by_effort_law(log, fitted, d);
  }
  if (d.pull_push) {
    const ErrorSummary error = error_summary(log.effort, joint_torque_by(*d.pull_push, log.tau_nm));
    return {log.name, error, error};
  }
  return {log.name, by_joint(log, d.base), by_joint(log, d.law)};
}

}  // namespace capstan::tools
