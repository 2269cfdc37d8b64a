// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/palpation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

// What no row shows: the calibration's own error and that of the friction model, as a share of the stiffness, of 95 %.
// Chosen on 28 Nov 2026 on seeds 765000 to 765599 and 815000 to 815499, and judged on others (palpation_coverage_test):
// 0.002 covers 95 and 96 %, this 96 and 97, 0.005 96 and 97.
constexpr double kModelShare = 0.0035;
// Resistance to speed, s/rad, that a site may have where no stroke out tells: tissue's stiffness grows by this share
// per rad/s. The largest of the tissues that are asked about in the same test.
constexpr double kMostDampingSPerRad = 0.2;
// The joint's torque follows a release only below what friction holds, a factor exp(-2 eta) of the motor's: strokes out
// count down to this share of the least torque that counts on the way in.
constexpr double kReleasedShare = 0.35;

/// Means over 20 ms: at 1 kHz the noise of the torque turns more often than the motion, and every turn is phase I.
auto averaged(const AxisLog& log) -> AxisLog {
  constexpr double kStretch = 0.02;
  const double period = (log.time_s[log.samples() - 1] - log.time_s[0]) / static_cast<double>(log.samples() - 1);
  const auto stretch = std::max<Eigen::Index>(1, std::lround(kStretch / period));
  return averaged_over(log, stretch);
}

/// One sample as the tension state sees it.
struct SeenRow {
  ForcePhase phase;
  bool forward, known;
  double joint_torque;
  double q2;
};

auto see(const AxisLog& log, const TensionStateParameters<double>& parameters) -> std::vector<SeenRow> {
  TensionState<double> state(parameters);
  SampleConditioner<double> conditioner(SamplePeriod<double>(0.001), ConditionerShape<double>{});
  std::vector<SeenRow> seen;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const bool forward = conditioner.update(log.q1_rad[i], log.tau_nm[i]).forward;
    const auto estimate = state.update(log.q1_rad[i], log.tau_nm[i], forward);
    seen.push_back({estimate.phase, forward, estimate.known, estimate.joint_torque, estimate.q2});
  }
  return seen;
}

/// What a slope of angle over torque says about what is pressed.
struct Meaning {
  double stiffness;  ///< N m/rad
  double per_slope;  ///< change of the stiffness by one of the slope, its size
};

/// A log as far as strokes are concerned: what is regressed on what, and when.
struct Pressed {
  const Eigen::VectorXd& time_s;
  const Eigen::VectorXd& torque;
  const Eigen::VectorXd& angle;
  const std::vector<SeenRow>& seen;
  std::function<Meaning(ForcePhase, bool forward, double slope)> meaning;
};

/// Motor-side numbers make a pair of tendons on an input pulley of radius one.
auto pair_of(const TensionStateParameters<double>& p, bool forward) -> TendonPair {
  const Tendon top = {p.eta_top, 1.0 / p.compliance_top};
  const Tendon bottom = {p.eta_bottom, 1.0 / p.compliance_bottom};
  return {forward ? top : bottom, forward ? bottom : top, 1.0, 1.0 / p.beta};
}

/// One joint: the motor's angle over its torque, (3.22).
auto one_joint(const AxisLog& log, const std::vector<SeenRow>& seen, const TensionStateParameters<double>& parameters)
    -> Pressed {
  return {log.time_s, log.tau_nm, log.q1_rad, seen, [&parameters](ForcePhase phase, bool forward, double slope) {
            const TendonPair pair = pair_of(parameters, forward);
            const PhaseStiffness own = phase_stiffness(pair, phase);
            const double value = environment_stiffness(pair, own, slope);
            return Meaning{value, value * value / (pair.r2 / pair.r1 * own.gain)};
          }};
}

/// A stroke of the tip against what it touches: on this side, into it or out of it.
struct Stroke {
  bool forward_side;  ///< the joint's torque is positive
  bool pressing;      ///< the motor goes further in
  [[nodiscard]] auto forward() const -> bool { return forward_side == pressing; }
};

/// The motor moves as the stroke does and the joint's torque is large enough to be contact.
auto counts(const SeenRow& s, ForcePhase phase, const Stroke& stroke, double least_torque) -> bool {
  return s.known && s.phase == phase && s.forward == stroke.forward() &&
         (stroke.forward_side ? s.joint_torque : -s.joint_torque) > least_torque;
}

/// Stiffness of all strokes of one kind, and the speed that a resistance to it shows in that with, rad/s.
struct StrokeStiffness {
  Stiffness stiffness;
  double speed = 0.0;
};

/// Torque times speed of the joint at a row of a stretch.
auto power_at(const Pressed& log, const std::vector<Eigen::Index>& stretch, std::size_t place) -> double {
  constexpr std::size_t kReach = 10;  // rows to either side, for the angle's noise
  const auto seen = [&log](Eigen::Index row) -> const SeenRow& { return log.seen[static_cast<std::size_t>(row)]; };
  const Eigen::Index from = stretch[place - std::min(place, kReach)];
  const Eigen::Index to = stretch[std::min(place + kReach, stretch.size() - 1)];
  return seen(stretch[place]).joint_torque * (seen(to).q2 - seen(from).q2) / (log.time_s[to] - log.time_s[from]);
}

/// Half the 95 % interval of a slope through stretches of centred rows. Neighbours err alike, so they count as fewer:
/// by the residual's first autocorrelation, as of a process of first order.
auto slope_error(const Eigen::VectorXd& x, const Eigen::VectorXd& residual, const std::vector<Eigen::Index>& ends)
    -> double {
  constexpr double kMostAlike = 0.9;
  double alike = 0.0;
  for (Eigen::Index i = 1; i < residual.size(); ++i) {
    if (std::find(ends.begin(), ends.end(), i) == ends.end()) {
      alike += residual[i] * residual[i - 1];
    }
  }
  const double rho = std::clamp(alike / std::max(residual.squaredNorm(), 1e-300), 0.0, kMostAlike);
  const double inflation = (1.0 + rho) / (1.0 - rho);
  const auto freedom = static_cast<double>(residual.size()) - static_cast<double>(ends.size()) - 1.0;
  const double counted = std::max(1.0, freedom / inflation);
  return student_t95(counted) *
         std::sqrt(residual.squaredNorm() / std::max(1.0, freedom) * inflation / x.squaredNorm());
}

/// Compliance over all stretches of one phase and stroke, each about its own mean, for the motor's friction and the
/// angle where the contact begins do not matter here.
auto stiffness_in(const Pressed& log, const SiteSpan& site, ForcePhase phase, const Stroke& stroke, double least_torque)
    -> std::optional<StrokeStiffness> {
  constexpr Eigen::Index kFewest = 6;
  constexpr std::ptrdiff_t kEdge = 3;
  constexpr Eigen::Index kMostGap = 2;  // noise of the torque now and then shows another phase
  std::vector<double> torque, angle, joint_torque, power;
  std::vector<Eigen::Index> ends;  // of stretches
  std::vector<Eigen::Index> stretch;
  const auto close = [&] {
    // The edges of a stretch lie near the kink where the phase changes, some rows on its other side.
    const auto edge = std::min<std::ptrdiff_t>(kEdge, static_cast<std::ptrdiff_t>(stretch.size() / 6));
    stretch.erase(stretch.end() - edge, stretch.end());
    stretch.erase(stretch.begin(), stretch.begin() + edge);
    if (static_cast<Eigen::Index>(stretch.size()) >= kFewest) {
      const double mean_torque = log.torque(stretch).mean();
      const double mean_angle = log.angle(stretch).mean();
      for (std::size_t place = 0; place < stretch.size(); ++place) {
        const Eigen::Index i = stretch[place];
        torque.push_back(log.torque[i] - mean_torque);
        angle.push_back(log.angle[i] - mean_angle);
        joint_torque.push_back(log.seen[static_cast<std::size_t>(i)].joint_torque);
        power.push_back(power_at(log, stretch, place));
      }
      ends.push_back(static_cast<Eigen::Index>(torque.size()));
    }
    stretch.clear();
  };
  for (Eigen::Index i = 0; i < log.time_s.size(); ++i) {
    if (log.time_s[i] < site.begin_s || log.time_s[i] >= site.end_s) {
      continue;
    }
    if (!stretch.empty() && i - stretch.back() > kMostGap) {
      close();
    }
    if (counts(log.seen[static_cast<std::size_t>(i)], phase, stroke, least_torque)) {
      stretch.push_back(i);
    }
  }
  close();
  if (ends.empty()) {
    return std::nullopt;
  }
  const auto rows = static_cast<Eigen::Index>(torque.size());
  const auto column = [rows](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), rows);
  };
  const auto x = column(torque), y = column(angle);
  const double slope = x.dot(y) / x.squaredNorm();
  const Meaning meaning = log.meaning(phase, stroke.forward(), slope);
  if (!(meaning.stiffness > 0.0) || !std::isfinite(meaning.stiffness)) {
    return std::nullopt;  // as stiff as the instrument itself, or stiffer: nothing can be said
  }
  const double error = slope_error(x, y - slope * x, ends);
  // Tissue bears T = K q (1 + d v), so q is (T - d T v) / K to first order, and the slope has d times that of T v in
  // it: the mean speed only where that stays the same.
  return StrokeStiffness{{meaning.stiffness, meaning.per_slope * error},
                         std::abs(x.dot(column(power)) / x.dot(column(joint_torque)))};
}

/// What two strokes of one kind of contact say about it at rest: tissue that resists speed is stiffer by a share of the
/// speed on the way in and softer by it on the way out. A stroke in alone has an error that nobody knows, and a wider
/// interval.
auto at_rest(const std::optional<StrokeStiffness>& in, const std::optional<StrokeStiffness>& out)
    -> std::optional<Stiffness> {
  if (!in) {
    return std::nullopt;
  }
  if (!out) {
    const double unknown = kMostDampingSPerRad * in->speed * in->stiffness.value;
    return Stiffness{in->stiffness.value, std::hypot(in->stiffness.half_interval, unknown)};
  }
  const double share = in->speed / (in->speed + out->speed);
  const Stiffness& a = in->stiffness;
  const Stiffness& b = out->stiffness;
  return Stiffness{(1.0 - share) * a.value + share * b.value,
                   std::hypot((1.0 - share) * a.half_interval, share * b.half_interval)};
}

auto combine(const std::optional<Stiffness>& a, const std::optional<Stiffness>& b) -> std::optional<Stiffness> {
  if (!a || !b) {
    return a ? a : b;
  }
  const double wa = 1.0 / (a->half_interval * a->half_interval);
  const double wb = 1.0 / (b->half_interval * b->half_interval);
  return Stiffness{(wa * a->value + wb * b->value) / (wa + wb), 1.0 / std::sqrt(wa + wb)};
}

void require_palpable(const AxisLog& log, const TensionStateParameters<double>& parameters) {
  if (const auto fault = check(parameters); fault != TensionStateFault::kNone) {
    throw BadInput(describe(fault));
  }
  if (log.samples() < 2) {
    throw BadInput(log.name + ": nothing was recorded; press and release each site at least once");
  }
}

auto stiffness_of(const Pressed& log, const std::vector<SiteSpan>& sites, double from_share)
    -> std::vector<SiteStiffness> {
  double largest = 0.0;
  for (const auto& s : log.seen) {
    largest = std::max(largest, s.known ? std::abs(s.joint_torque) : 0.0);
  }
  std::vector<SiteStiffness> result;
  for (const auto& site : sites) {
    SiteStiffness stiffness;
    stiffness.begin_s = site.begin_s;
    stiffness.end_s = site.end_s;
    const auto in = [&](ForcePhase phase) {
      const auto side = [&](bool forward) {
        const auto stroke = [&](bool pressing) {
          return stiffness_in(log, site, phase, {forward, pressing},
                              (pressing ? from_share : kReleasedShare * from_share) * largest);
        };
        return at_rest(stroke(true), stroke(false));
      };
      return combine(side(true), side(false));
    };
    stiffness.both_active = in(ForcePhase::kBothActive);
    stiffness.one_slack = in(ForcePhase::kOneSlack);
    stiffness.combined = combine(stiffness.both_active, stiffness.one_slack);
    if (stiffness.combined) {
      double& half = stiffness.combined->half_interval;
      half = std::hypot(half, kModelShare * stiffness.combined->value);
      if (half >= stiffness.combined->value) {
        stiffness.combined.reset();  // it may be next to nothing, or twice as much
      }
    }
    result.push_back(stiffness);
  }
  return result;
}

/// Two jaws with something between them, as one joint that opens: what lies between them has no weight, so they press
/// it equally, and its length is the difference of their angles, as in (3.27).
class Grip {
 public:
  Grip(const std::vector<SeenRow>& first, const std::vector<SeenRow>& second, const std::string& name)
      : torque_(static_cast<Eigen::Index>(first.size())), opening_(torque_.size()) {
    double together = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const bool known = first[i].known && second[i].known;
      const double torques = first[i].joint_torque * second[i].joint_torque;
      together += known ? torques : 0.0;
      all += known ? std::abs(torques) : 0.0;
    }
    if (std::abs(together) < kMostlyAgree * all) {
      throw BadInput(name +
                     ": the two joints do not press against each other, their torques do not go together; grip " +
                     "the object between the jaws, and name the axes of both");
    }
    const double sign = together < 0.0 ? -1.0 : 1.0;  // of the second joint's angles, for the first one's torque
    SampleConditioner<double> conditioner(SamplePeriod<double>(0.001), ConditionerShape<double>{});
    for (std::size_t i = 0; i < first.size(); ++i) {
      const SeenRow& a = first[i];
      const SeenRow& b = second[i];
      const auto row = static_cast<Eigen::Index>(i);
      torque_[row] = 0.5 * (a.joint_torque + sign * b.joint_torque);
      opening_[row] = a.q2 + sign * b.q2;
      const bool agree = std::abs(a.joint_torque - sign * b.joint_torque) < kMostApart * std::abs(torque_[row]);
      const bool slide = slides(a) && slides(b) && presses(a) == presses(b) && agree;
      const bool slack = a.phase == ForcePhase::kOneSlack || b.phase == ForcePhase::kOneSlack;
      seen_.push_back({!slide  ? ForcePhase::kPulledActive
                       : slack ? ForcePhase::kOneSlack
                               : ForcePhase::kBothActive,
                       conditioner.update(opening_[row], torque_[row]).forward, a.known && b.known, torque_[row],
                       opening_[row]});
    }
  }

  [[nodiscard]] auto pressed(const Eigen::VectorXd& time_s) const -> Pressed {
    return {time_s, torque_, opening_, seen_, [](ForcePhase, bool, double slope) {
              return Meaning{1.0 / slope, 1.0 / (slope * slope)};
            }};
  }

 private:
  /// Of the sum of the sizes of products of both torques, what their sum has to come to. Rows of a grip have one sign.
  static constexpr double kMostlyAgree = 0.8;
  /// Of the torque, what both jaws' may differ by: more than friction of the joints and errors of the laws make of it.
  static constexpr double kMostApart = 0.3;
  static auto slides(const SeenRow& s) -> bool {
    return s.phase == ForcePhase::kBothActive || s.phase == ForcePhase::kOneSlack;
  }

  /// A jaw that the other one drives back does the contrary, and what its tendons pass on is then not known.
  static auto presses(const SeenRow& s) -> bool { return s.forward == (s.joint_torque > 0.0); }

  Eigen::VectorXd torque_, opening_;
  std::vector<SeenRow> seen_;
};

}  // namespace

auto tension_state_of(const PullPushFit& fit) -> TensionStateParameters<double> {
  const auto compliance = [&](const char* name) {
    const auto found =
        std::find_if(fit.parameters.begin(), fit.parameters.end(), [&](const auto& p) { return p.name == name; });
    if (found == fit.parameters.end() || !(found->value > 0.0)) {
      throw Refusal(std::string("the pull-push law has no ") + name + "; " + fit.cure);
    }
    return 1.0 / found->value;
  };
  return {.eta_top = fit.law.eta_top,
          .eta_bottom = fit.law.eta_bottom,
          .pretension_nm = fit.law.pretension_nm,
          .compliance_top = compliance("stiffness_top"),
          .compliance_bottom = compliance("stiffness_bottom"),
          .beta = 1.0 / fit.law.ratio,
          .friction_nm = std::max(0.0, fit.friction_nm)};
}

auto palpate(const AxisLog& full_log, const TensionStateParameters<double>& parameters,
             const std::vector<SiteSpan>& sites, double from_share) -> std::vector<SiteStiffness> {
  require_palpable(full_log, parameters);
  const AxisLog log = averaged(full_log);
  const auto seen = see(log, parameters);
  return stiffness_of(one_joint(log, seen, parameters), sites, from_share);
}

auto palpate_between(const Jaw& first, const Jaw& second, const std::vector<SiteSpan>& sites, double from_share)
    -> std::vector<SiteStiffness> {
  for (const Jaw* jaw : {&first, &second}) {
    require_palpable(jaw->log, jaw->parameters);
  }
  if (first.log.samples() != second.log.samples()) {
    throw BadInput(first.log.name + ": the jaws have " + std::to_string(first.log.samples()) + " and " +
                   std::to_string(second.log.samples()) + " samples; give both from one log");
  }
  const AxisLog log = averaged(first.log);
  const Grip grip(see(log, first.parameters), see(averaged(second.log), second.parameters), first.log.name);
  return stiffness_of(grip.pressed(log.time_s), sites, from_share);
}

auto stiff_sites(const std::vector<SiteStiffness>& sites, double factor) -> std::vector<std::size_t> {
  std::vector<double> values;
  for (const auto& site : sites) {
    if (site.combined) {
      values.push_back(site.combined->value);
    }
  }
  std::vector<std::size_t> stiff;
  if (values.size() < 3) {
    return stiff;  // no rest to compare with
  }
  const double middle =
      median(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (sites[i].combined && sites[i].combined->value - sites[i].combined->half_interval > factor * middle) {
      stiff.push_back(i);
    }
  }
  return stiff;
}

}  // namespace capstan::tools
