// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/weight_in_torque.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto number_of(const JointFile& law, const std::string& term, std::size_t i) -> double {
  return law.parameters.coefficients[law.catalogue->term(term).first_coefficient + i];
}

}  // namespace

auto weight_in_torque(const Preparation& p, const JointFile& law) -> std::optional<WeightInTorque> {
  constexpr Eigen::Index kBlocks = 32;
  const bool torque = std::all_of(p.logs.begin(), p.logs.end(), [](const auto& log) { return log.has_torque; });
  if (!torque || !law.has("gravity") || !law.has("tendon_elongation")) {
    return std::nullopt;
  }
  const double elongation =
      0.5 * (number_of(law, "tendon_elongation", 0) + number_of(law, "tendon_elongation", 1));  // rad/Nm
  const double sine = number_of(law, "gravity", 0);
  const double cosine = number_of(law, "gravity", 1);
  if (elongation == 0.0 || std::hypot(sine, cosine) == 0.0) {
    return std::nullopt;
  }
  const Eigen::ArrayXd q2 = p.coarse(p.target).array();
  const auto& s = p.signals;
  Eigen::MatrixXd columns(q2.size(), 5);
  columns << (sine * q2.sin() + cosine * q2.cos()).matrix() / elongation, s.forward, (1.0 - s.forward.array()).matrix(),
      s.dq1, s.ddq1;
  const std::vector<Sign> signs(5, Sign::kAny);
  const LinearFit fit = fit_columns(columns, s.tau, even_parts(p.coarse_logs, kBlocks), signs);
  return WeightInTorque{std::hypot(sine, cosine) / std::abs(elongation), fit.theta[0],
                        fit.theta[0] + half_interval(fit, 0)};
}

void doubt_weight(const Preparation& p, Diagnosis& d) {
  const bool named =
      std::any_of(d.effects.begin(), d.effects.end(), [](const auto& effect) { return effect.name == "gravity"; });
  const auto weight = named && d.found ? weight_in_torque(p, *d.found) : std::nullopt;
  if (!weight || weight->share_at_most >= kWeightInTorque) {
    return;
  }
  d.warnings.push_back(
      "gravity may be the joint's pulley or sensor off its centre: both are waves over the joint's "
      "angle, and the motor's torque shows " +
      rounded(100.0 * std::max(0.0, weight->share), 2) + " % of the " + rounded(weight->needed_nm, 2) +
      (p.logs.front().linear ? " N" : " Nm") +
      " that such a weight needs, unless that was taken out of it. Record the same motion with the "
      "base tilted or another payload: what a weight does changes with that, what a pulley does stays");
}

}  // namespace capstan::tools
