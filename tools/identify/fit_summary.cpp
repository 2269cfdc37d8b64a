// SPDX-License-Identifier: Apache-2.0
// What logs say of a law beside its terms.
#include <algorithm>
#include <cmath>

#include "capstan/model/terms/tendon.hpp"
#include "capstan/tools/identify/error_bar.hpp"
#include "capstan/tools/identify/friction_spread.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/pretension.hpp"
#include "capstan/tools/identify/settled.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/identify/torque_balance.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

auto steady_torque(const std::vector<AxisLog>& logs, const LawDesign& design) -> std::optional<SteadyTorque> {
  // Of the stroke, at either end: by then the friction has turned round, and what the torque owes to the angle averages
  // out.
  constexpr double kAwayFromReversal = 0.2;
  std::vector<double> forward;
  std::vector<double> backward;
  for (std::size_t log = 0; log < logs.size(); ++log) {
    const auto& samples = design.samples()[log];
    Eigen::VectorXd rate(static_cast<Eigen::Index>(samples.size()));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      rate[static_cast<Eigen::Index>(i)] = samples[i].dq1;
    }
    const double slowest = 0.3 * rms(rate);
    auto changes = direction_changes(samples);
    changes.push_back(samples.size());
    std::size_t begin = 0;
    for (const std::size_t end : changes) {
      const double stroke = samples[end - 1].q1 - samples[begin].q1;
      for (std::size_t i = begin; i < end; ++i) {
        const double share = stroke != 0.0 ? (samples[i].q1 - samples[begin].q1) / stroke : 0.0;
        const bool away = share > kAwayFromReversal && share < 1.0 - kAwayFromReversal;
        const bool steady = away && std::abs(samples[i].dq1) > slowest;
        if (steady && (samples[i].dq1 > 0.0) == samples[i].forward) {
          (samples[i].forward ? forward : backward).push_back(samples[i].tau);
        }
      }
      begin = end;
    }
  }
  if (forward.empty() || backward.empty()) {
    return std::nullopt;
  }
  auto middle = [](const std::vector<double>& values) {
    return median(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  return SteadyTorque{middle(forward), middle(backward)};
}

namespace {

/// Motor angle at every sample, all logs one below the other.
auto motor_angles(const LawDesign& design) -> Eigen::VectorXd {
  Eigen::VectorXd q1(design.rows());
  Eigen::Index row = 0;
  for (const Samples& log : design.samples()) {
    for (const auto& sample : log) {
      q1[row++] = sample.q1;
    }
  }
  return q1;
}

/// Steady torque, friction and the loop between motor and joint: of motions in which the joint is free.
void describe_free_motion(const std::vector<AxisLog>& logs, const LawDesign& design, const Eigen::VectorXd& target,
                          JointFile& joint) {
  joint.steady_torque = steady_torque(logs, design);
  if (joint.steady_torque) {
    joint.fit->friction_rms = friction_spread(logs, design.samples(), *joint.steady_torque);
  }
  const auto loop = loop_of(joint);
  if (!loop) {
    return;
  }
  const Blocks rows = even_blocks(design.log_rows(), 2);
  const LawForm gauge = with_lateness(design, target, rows, fit_loop(design, target, rows, *loop));
  joint.fit->loop_half_width = half_width_of(gauge);
  joint.fit->late = lateness_of(gauge);
  joint.fit->loop_torque = loop_torque(design, rows, *joint.fit->loop_half_width);
  joint.fit->torque = torque_parts({logs, design.samples(), *joint.fit->loop_half_width});
}

/// The logs in which the tip was not held; all, where it was in each.
auto free_logs(const std::vector<AxisLog>& logs, const JointFile& joint) -> std::vector<AxisLog> {
  const double beta = beta_of(joint);
  std::vector<AxisLog> free;
  std::copy_if(logs.begin(), logs.end(), std::back_inserter(free),
               [beta](const AxisLog& log) { return !is_held(log, beta); });
  return free.empty() ? logs : free;
}

/// Whether logs, the tip held in some, tell the pretension from the friction numbers: by more than a law of tendons
/// errs itself, and that law leaves no more than so much; else why not, if it is not that no tendon went slack.
struct Telling {
  bool pretension = false;
  std::vector<std::string> notes = {};
};

auto tells_pretension(const LawDesign& design, const Eigen::VectorXd& target, const JointFile& joint) -> Telling {
  const auto loop = loop_of(joint);
  if (!loop) {
    return {};
  }
  const double half_width = std::abs(beta_of(joint)) * loop->half_width_rad;  // at the joint
  const auto trial = try_pretensions(design, target, even_blocks(design.log_rows(), 2), form_of(joint));
  if (trial.left >= kTendonForm * half_width) {
    return {false,
            {"the law of two tendons leaves " + rounded(trial.left, 2) +
             " rad beside the noise, more than it may err of this loop, so these logs do not determine the pretension: "
             "check both for a slip, a contact or a limit of the motor's torque"}};
  }
  return {trial.rise > kPretensionShows * half_width};
}

/// Where logs do not tell the pretension from the friction numbers, nothing is known of what trades with it: all of it
/// lies in one valley of the fit, whose curvature is not how far it reaches.
void forget_what_trades(JointFile& joint) {
  const CatalogueTerm& tendon = joint.catalogue->term(kTendonModel);
  joint.coefficient_ci95[tendon.first_coefficient].reset();
  joint.coefficient_ci95[joint.catalogue->term("joint_offset").first_coefficient].reset();
  for (const auto place : {TendonShape::kEtaTop, TendonShape::kEtaBottom, TendonShape::kPretension}) {
    joint.shape_ci95[tendon.first_shape + place].reset();
  }
}

auto describe_angle(const std::vector<AxisLog>& logs, const LawDesign& design, const Eigen::VectorXd& target,
                    const Eigen::VectorXd& estimate, const Blocks& settled, JointFile& joint)
    -> std::vector<std::string> {
  joint.fit->error_bar = error_bar(design.samples(), target - estimate, settled);
  const std::vector<AxisLog> free = free_logs(logs, joint);
  const bool held = free.size() < logs.size();
  if (held) {
    describe_free_motion(free, LawDesign(free, joint.parameters.conditioner), stacked_target(free), joint);
  } else {
    describe_free_motion(logs, design, target, joint);
  }
  const Telling telling = held && joint.has(kTendonModel) ? tells_pretension(design, target, joint) : Telling{};
  joint.fit->pretension = pretension_of(joint, telling.pretension);
  if (joint.has(kTendonModel) && !telling.pretension) {
    forget_what_trades(joint);
  }
  return telling.notes;
}

}  // namespace

auto describe_logs(const std::vector<AxisLog>& logs, const LawDesign& design, const Eigen::VectorXd& target,
                   const Eigen::VectorXd& estimate, JointFile& joint) -> std::vector<std::string> {
  const auto& others = logs.front().others;
  for (std::size_t slot = 0; slot < std::min(slots_used(joint), others.size()); ++slot) {
    joint.coupled_to.push_back(others[slot].number);
  }
  const bool angle = joint.catalogue->target() == TargetKind::kAngle;
  const Blocks logged = pieces_of(design.log_rows());
  const Blocks rows = angle ? settled_rows(motor_angles(design), logged) : logged;
  const Eigen::VectorXd measured = stacked(target, rows);
  const Eigen::VectorXd estimated = stacked(estimate, rows);
  FitSummary summary;
  summary.rmse = rms(measured - estimated);
  summary.gof_percent = goodness_of_fit_percent(measured, estimated);
  summary.samples = measured.size();
  summary.joint_range = target.maxCoeff() - target.minCoeff();
  Interval range = {logs.front().q1_rad.minCoeff(), logs.front().q1_rad.maxCoeff()};
  for (const auto& log : logs) {
    range = {std::min(range[0], log.q1_rad.minCoeff()), std::max(range[1], log.q1_rad.maxCoeff())};
    summary.logs.push_back(log.name);
  }
  summary.motor_range = range;
  joint.fit = summary;
  return angle ? describe_angle(logs, design, target, estimate, rows, joint) : std::vector<std::string>{};
}

}  // namespace capstan::tools
