// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/effort_frames.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/select/effort_catalogue.hpp"

namespace capstan::tools {
namespace {

/// Time constant with which dry friction lets go at a standstill, s. Chosen in November 2026 on the 13 effort joints of
/// the shared measured machines, laws of inertia, friction, weight and spring: with 0.06, 0.12 and 0.25 s each of the
/// six of industrial robots and servos leaves less at rest than with friction that holds (a factor of 1.2 to 3.5); of
/// the seven of a tendon-driven arm, which hardly ever rests, five the same or less, two up to 5 % more.
constexpr double kLettingGoS = 0.12;
/// It may also let go at once, as where a controller takes the torque back with the speed, or never; and it may turn
/// over at a quarter of the speed at which a motor usually counts as standing. Set on 27 November 2026 on reaches with
/// rests among 55 axes by the laws of others (docs/measured_machines.md).
constexpr double kAtOnceS = 0.02;
constexpr double kNeverS = 0.0;
constexpr double kFineStandstill = 0.25;
/// Or as soon as it turns, where its angle has no noise: textbook friction in a simulator, 28 November 2026.
constexpr double kFinestStandstill = 1.0 / 16.0;

/// Half the logarithm of the mean squared error of a plain law seen through the law's view: of an effort inertia, drag,
/// Coulomb friction and offset; of a gear gain, offset, Coulomb and load friction.
auto plain_loss(const std::vector<AxisLog>& logs, const EffortLaw& law, const EffortDesign& design) -> double {
  const MotionRanges ranges = motion_ranges(design);
  auto parts = law.of_gear() ? gear_parts(ranges) : effort_parts(ranges, {}, AxisKind::kLinear);
  parts.resize(law.of_gear() ? 6 : kRigidParts);
  const PartLaw plain =
      law.of_gear() ? PartLaw{{0, 0}, {1, 0}, {2, 0}, {5, 0}} : PartLaw{{0, 0}, {1, 0}, {2, 0}, {3, 0}};
  const PartProducts products(PartColumns(design, stacked_target(logs), *law.joint.catalogue, parts), 1.0);
  return 0.5 * std::log(products.fold_errors(plain, kEffortNumbers.ridge).mean());
}

/// The motor's torque late or early against the joint's: the skew at which a plain law leaves least, if that is worth
/// it.
auto best_skew(const std::vector<AxisLog>& logs, EffortLaw law) -> double {
  constexpr double kLongestS = 0.06;
  constexpr int kMostSteps = 12;
  const double step_s = std::max(0.5 * logs.front().period_s, kLongestS / kMostSteps);
  const auto loss = [&](double skew_s) {
    law.view.skew_s = skew_s;
    return plain_loss(logs, law, EffortDesign(logs, law.view));
  };
  double best = 0.0;
  double lowest = loss(0.0) - kWorthAnotherView;
  for (int i = -kMostSteps; i <= kMostSteps; ++i) {
    const double skew_s = i * step_s;
    const double found = i != 0 && std::abs(skew_s) <= kLongestS ? loss(skew_s) : lowest;
    if (found < lowest) {
      lowest = found;
      best = skew_s;
    }
  }
  return best;
}

}  // namespace

auto axis_kind(const std::vector<AxisLog>& logs) -> AxisKind {
  return logs.front().linear ? AxisKind::kLinear : AxisKind::kRotary;
}

auto catalogue_for(const std::vector<AxisLog>& logs) -> const Catalogue& {
  return logs.front().motion_alone() ? effort_law_catalogue(axis_kind(logs)) : gear_law_catalogue();
}

auto frames_by(const std::vector<AxisLog>& logs, const std::function<double(const Frame&)>& error)
    -> std::vector<Frame> {
  // How slow a motor stands, of the usual, and how soon the dry friction of its last motion lets go then.
  constexpr std::pair<double, double> kRests[] = {{1.0, kLettingGoS},
                                                  {1.0, kAtOnceS},
                                                  {1.0, kNeverS},
                                                  {kFineStandstill, kLettingGoS},
                                                  {kFineStandstill, kAtOnceS},
                                                  {kFineStandstill, kNeverS},
                                                  {kFinestStandstill, kAtOnceS},
                                                  {kFinestStandstill, kNeverS}};
  EffortLaw law;
  law.joint = JointFile(catalogue_for(logs));
  law.target = logs.front().target;
  law.view = usual_view(logs);
  law.view.skew_s = law.of_gear() ? best_skew(logs, law) : 0.0;
  std::vector<Frame> frames;  // the usual one, and the best of the others
  double lowest = 0.0;
  for (const auto& [share, letting_go_s] : kRests) {
    EffortLaw trial = law;
    trial.view.standstill = share * law.view.standstill;
    trial.view.letting_go_s = letting_go_s;
    EffortDesign design(logs, trial.view);
    Frame frame{std::move(trial), std::move(design)};
    const double found = error(frame);
    if (frames.empty()) {
      lowest = (1.0 - kWorthAnotherView) * found;
      frames.push_back(std::move(frame));
    } else if (found < lowest) {
      lowest = found;
      frames.erase(frames.begin() + 1, frames.end());
      frames.push_back(std::move(frame));
    }
  }
  return frames;
}

auto frames_for(const std::vector<AxisLog>& logs) -> std::vector<Frame> {
  return frames_by(logs, [&logs](const Frame& frame) { return std::exp(plain_loss(logs, frame.law, frame.design)); });
}

}  // namespace capstan::tools
