// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/force_replay.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

template <typename Scalar, typename Convert>
auto converted(const ForceLawParameters<double>& from, Convert&& to) -> ForceLawParameters<Scalar> {
  ForceLawParameters<Scalar> result;
  result.kind = from.kind;
  result.pull_push.eta_top = to(from.pull_push.eta_top);
  result.pull_push.eta_bottom = to(from.pull_push.eta_bottom);
  result.pull_push.pretension_nm = to(from.pull_push.pretension_nm);
  result.pull_push.ratio = to(from.pull_push.ratio);
  result.pull_push.pull_weight = to(from.pull_push.pull_weight);
  result.pull_push.pull_push_weight = to(from.pull_push.pull_push_weight);
  result.friction_nm = to(from.friction_nm);
  result.offset_nm = to(from.offset_nm);
  return result;
}

template <typename Scalar, typename ToScalar, typename ToDouble>
auto run(const Eigen::VectorXd& tau_nm, const BoardForceLaw& from, ToScalar&& to_scalar, ToDouble&& to_double)
    -> ReplayedForce {
  const auto table = convert_table<Scalar>(from.table);
  ForceLaw<Scalar, kMostPreisachLevels, kForceDepth> law;
  law.become(converted<Scalar>(from.parameters, to_scalar), table);
  if (!law.is_there()) {
    throw BadInput("the force law has a number that no board takes; identify it again, in N m");
  }
  ReplayedForce result{Eigen::VectorXd(tau_nm.size())};
  for (Eigen::Index i = 0; i < tau_nm.size(); ++i) {
    const auto estimate = law.update(to_scalar(tau_nm[i]));
    result.torque_nm[i] = to_double(estimate.force);
    result.unknown += estimate.known ? 0 : 1;
    result.beyond += estimate.beyond_table ? 1 : 0;
  }
  return result;
}

}  // namespace

auto read_board_force_law(const std::string& joint_file, const std::string& name) -> BoardForceLaw {
  BoardForceLaw law;
  const std::string model = force_model(joint_file, name);
  if (is_of_tendons(model)) {
    law.parameters = force_law_of(read_pull_push(joint_file, name));
  } else if (model == "preisach") {
    law.parameters.kind = ForceLawKind::kPreisach;
    law.table = read_preisach(joint_file, name);
  } else if (!model.empty()) {
    throw BadInput(name + ": [force] has the model \"" + model +
                   "\", which no board runs; pull_push, blend and preisach are");
  }
  return law;
}

auto force_rows(const CsvLog& log, int axis, std::vector<std::string>& notes) -> CsvLog {
  AxisRequest request;
  request.axis = axis;
  request.force = true;
  return common_rows_of(log, request, notes);
}

auto replay_force(const Eigen::VectorXd& tau_nm, const BoardForceLaw& law, Arithmetic arithmetic) -> ReplayedForce {
  if (arithmetic == Arithmetic::kDouble) {
    const auto same = [](double x) { return x; };
    return run<double>(tau_nm, law, same, same);
  }
  return run<Q24>(
      tau_nm, law, [](double x) { return Q24::from_double(x); }, [](Q24 x) { return x.to_double(); });
}

}  // namespace capstan::tools
