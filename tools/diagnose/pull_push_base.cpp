// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/pull_push_base.hpp"

#include <algorithm>

#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// The first rows of all logs.
auto head_of(const std::vector<AxisLog>& logs, Eigen::Index rows) -> std::vector<AxisLog> {
  std::vector<AxisLog> head;
  for (const auto& log : logs) {
    const Eigen::Index own = std::min(rows, log.samples());
    if (own > 0) {
      head.push_back(first_rows(log, own));
    }
    rows -= own;
  }
  return head;
}

/// The law that identify would write; nothing, and why, where it would write none.
auto written_fit(const std::vector<AxisLog>& logs, std::string& why) -> std::optional<PullPushFit> {
  try {
    PullPushFit fit = fit_pull_push(logs);
    if (fit.undetermined.empty()) {
      return fit;
    }
    why = "the log can not determine " + joined(fit.undetermined) + " of it; " + fit.cure;
  } catch (const Refusal& refusal) {
    why = refusal.what();
  }
  return std::nullopt;
}

}  // namespace

auto run_pull_push_base(const AxisLog& log, const JointFile& joint, const std::optional<PullPushFit>& fit)
    -> Eigen::VectorXd {
  return fit ? joint_torque_by(*fit, log.tau_nm)
             : estimates({log}, LawDesign({log}, joint.parameters.conditioner), joint);
}

auto pull_push_base(const std::vector<AxisLog>& logs, const JointFile& searched, Eigen::Index first_unseen)
    -> std::optional<PullPushBase> {
  PullPushBase base;
  base.fit = written_fit(logs, base.undetermined);
  if (!base.fit && !searched.has("pull_push")) {
    return std::nullopt;
  }
  base.joint = base.fit ? pull_push_joint(*base.fit) : searched;
  base.joint.status = LawStatus::kBase;
  std::optional<PullPushFit> judged = base.fit;
  if (std::string ignored; base.fit) {
    if (auto without = written_fit(head_of(logs, first_unseen), ignored)) {  // else they have seen what judges them
      judged = std::move(without);
    }
  }
  base.estimate.resize(total_samples(logs));
  Eigen::Index row = 0;
  for (const auto& log : logs) {
    base.estimate.segment(row, log.samples()) = run_pull_push_base(log, base.joint, judged);
    row += log.samples();
  }
  return base;
}

}  // namespace capstan::tools
