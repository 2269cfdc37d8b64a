// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "capstan/model/terms/tendon.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

/// Half the width of the loop at these torques, both tendons sliding.
auto width_by_law(const JointFile& joint, const SteadyTorque& torque) -> double {
  const CatalogueTerm& term = joint.catalogue->term(kTendonModel);
  std::array<double, TendonShape::kCount> shapes{};
  std::copy_n(joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape), shapes.size(),
              shapes.begin());
  const TendonsOf<double, 32> tendons(SamplePeriod<double>(1e-3), shapes);
  const auto lag = [&](double torque_nm, bool forward) {
    Sample<double> s;
    s.tau = torque_nm;
    s.forward = forward;
    return tendons.steady_state(s)[0];
  };
  const double compliance = base_of(joint).tied_compliance.value_or(0.0);
  return std::abs(0.5 * compliance * (lag(torque.forward_nm, true) - lag(torque.backward_nm, false)));
}

}  // namespace

auto loop_of(const JointFile& joint) -> std::optional<Loop> {
  if (!joint.steady_torque || !joint.has(kTendonModel) || !joint.has("motor_angle")) {
    return std::nullopt;
  }
  const bool measured = joint.fit && joint.fit->loop_half_width;
  const double width = measured ? *joint.fit->loop_half_width : width_by_law(joint, *joint.steady_torque);
  const double torque =
      joint.fit && joint.fit->loop_torque ? *joint.fit->loop_torque : friction_of(*joint.steady_torque);
  const Loop loop{width, torque, measured ? joint.fit->late : std::nullopt};
  return loop.half_width_rad > 0.0 && loop.torque_nm > 0.0 ? std::optional(loop) : std::nullopt;
}

auto fit_loop(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const Loop& known)
    -> LawForm {
  LawForm law;
  law.terms = {"motor_angle", "joint_offset", kPlayTerm};
  law.set_shapes(law.catalogue->term(kPlayTerm), {known.half_width_rad});
  return refine_shapes(design, target, rows, law);
}

auto half_width_of(const LawForm& loop) -> double {
  return loop.shapes_of(loop.catalogue->term(kPlayTerm)).front();
}

auto with_lateness(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, LawForm loop)
    -> LawForm {
  if (!loop.has(kDelayTerm) && !loop.has(kDragTerm)) {
    loop.terms.emplace_back(kDelayTerm);
    loop.set_shapes(loop.catalogue->term(kDelayTerm), {design.period_s(0)});
  }
  const std::vector<std::string> held = std::exchange(loop.held, loop.terms);
  std::erase_if(loop.held, [](const std::string& term) { return term == kPlayTerm || term == kDelayTerm; });
  loop = refine_shapes(design, target, rows, std::move(loop));
  loop.held = held;
  return loop;
}

auto lateness_of(const LawForm& law) -> double {
  return law.has(kDelayTerm) ? law.shapes_of(law.catalogue->term(kDelayTerm)).front() : 0.0;
}

auto friction_of(const SteadyTorque& torque) -> double {
  return 0.5 * std::abs(torque.forward_nm - torque.backward_nm);
}

auto loop_torque(const LawDesign& design, const Blocks& rows, double half_width_rad) -> std::optional<double> {
  constexpr double kThrough = 2.2;  // half widths; a tenth for the knee
  const double least = kThrough * half_width_rad;
  const double torque = friction_torque(
      design, rows, [least](const auto& sample) { return std::abs(sample.q1 - sample.q1_reversal) > least; });
  return torque > 0.0 ? std::optional(torque) : std::nullopt;
}

}  // namespace capstan::tools
