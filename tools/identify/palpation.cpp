// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/palpation.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Means over 40 ms: at 1 kHz the noise of the torque turns more often than the motion, and every turn is phase I.
auto averaged(const ForceLog& log) -> ForceLog {
  constexpr double kStretch = 0.04;
  const double period = (log.time_s[log.samples() - 1] - log.time_s[0]) / static_cast<double>(log.samples() - 1);
  const auto stretch = std::max<Eigen::Index>(1, std::lround(kStretch / period));
  const Eigen::Index rows = log.samples() / stretch;
  ForceLog result;
  result.name = log.name;
  for (const auto& [from, to] : {std::pair{&log.time_s, &result.time_s}, std::pair{&log.q1_rad, &result.q1_rad},
                                 std::pair{&log.tau_nm, &result.tau_nm}}) {
    to->resize(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      (*to)[i] = from->segment(i * stretch, stretch).mean();
    }
  }
  return result;
}

/// One sample as the tension state sees it.
struct Seen {
  ForcePhase phase;
  bool forward, known;
  double joint_torque;
};

auto see(const ForceLog& log, const TensionStateParameters<double>& parameters) -> std::vector<Seen> {
  TensionState<double> state(parameters);
  SampleConditioner<double> conditioner(SamplePeriod<double>(0.001), ConditionerShape<double>{});
  std::vector<Seen> seen;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const bool forward = conditioner.update(log.q1_rad[i], log.tau_nm[i]).forward;
    const auto estimate = state.update(log.q1_rad[i], log.tau_nm[i], forward);
    seen.push_back({estimate.phase, forward, estimate.known, estimate.joint_torque});
  }
  return seen;
}

/// Motor-side numbers make a pair of tendons on an input pulley of radius one.
auto pair_of(const TensionStateParameters<double>& p, bool forward) -> TendonPair {
  const Tendon top = {p.eta_top, 1.0 / p.compliance_top};
  const Tendon bottom = {p.eta_bottom, 1.0 / p.compliance_bottom};
  return {forward ? top : bottom, forward ? bottom : top, 1.0, 1.0 / p.beta};
}

/// The motor pulls in this direction and the joint's torque has followed far enough.
auto counts(const Seen& s, ForcePhase phase, bool forward, double least_torque) -> bool {
  return s.known && s.phase == phase && s.forward == forward &&
         (forward ? s.joint_torque : -s.joint_torque) > least_torque;
}

/// Compliance over all stretches of one phase and direction, each about its own mean, for the motor's friction and the
/// angle where the contact begins are nobody's business here.
auto stiffness_in(const ForceLog& log, const std::vector<Seen>& seen, const TensionStateParameters<double>& parameters,
                  const SiteSpan& site, ForcePhase phase, bool forward, double least_torque)
    -> std::optional<Stiffness> {
  constexpr Eigen::Index kFewest = 6;
  constexpr Eigen::Index kBlocks = 2;
  constexpr std::ptrdiff_t kEdge = 3;
  constexpr Eigen::Index kMostGap = 2;  // noise of the torque now and then shows another phase
  std::vector<double> tau, q1;
  Blocks blocks;
  std::vector<Eigen::Index> stretch;
  const auto close = [&] {
    // The edges of a stretch lie near the kink where the phase changes, some rows on its other side.
    const auto edge = std::min<std::ptrdiff_t>(kEdge, static_cast<std::ptrdiff_t>(stretch.size() / 6));
    stretch.erase(stretch.end() - edge, stretch.end());
    stretch.erase(stretch.begin(), stretch.begin() + edge);
    const auto count = static_cast<Eigen::Index>(stretch.size());
    if (count >= kFewest) {
      const double mean_tau = log.tau_nm(stretch).mean();
      const double mean_q1 = log.q1_rad(stretch).mean();
      const auto first = static_cast<Eigen::Index>(tau.size());
      for (const Eigen::Index i : stretch) {
        tau.push_back(log.tau_nm[i] - mean_tau);
        q1.push_back(log.q1_rad[i] - mean_q1);
      }
      for (Eigen::Index b = 0; b < kBlocks; ++b) {
        blocks.push_back({first + count * b / kBlocks, first + count * (b + 1) / kBlocks});
      }
    }
    stretch.clear();
  };
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    if (log.time_s[i] < site.begin_s || log.time_s[i] >= site.end_s) {
      continue;
    }
    if (!stretch.empty() && i - stretch.back() > kMostGap) {
      close();
    }
    if (counts(seen[static_cast<std::size_t>(i)], phase, forward, least_torque)) {
      stretch.push_back(i);
    }
  }
  close();
  if (blocks.empty()) {
    return std::nullopt;
  }
  const auto rows = static_cast<Eigen::Index>(tau.size());
  const LinearFit fit = fit_columns(Eigen::Map<const Eigen::MatrixXd>(tau.data(), rows, 1),
                                    Eigen::Map<const Eigen::VectorXd>(q1.data(), rows), blocks, {Sign::kAny});
  const TendonPair pair = pair_of(parameters, forward);
  const PhaseStiffness own = phase_stiffness(pair, phase);
  const double value = environment_stiffness(pair, own, fit.theta[0]);
  if (!(value > 0.0) || !std::isfinite(value)) {
    return std::nullopt;  // as stiff as the instrument itself, or stiffer: nothing can be said
  }
  const double by_compliance = value * value / (pair.r2 / pair.r1 * own.gain);
  return Stiffness{value, by_compliance * half_interval(fit, 0)};
}

auto combine(const std::optional<Stiffness>& a, const std::optional<Stiffness>& b) -> std::optional<Stiffness> {
  if (!a || !b) {
    return a ? a : b;
  }
  const double wa = 1.0 / (a->half_interval * a->half_interval);
  const double wb = 1.0 / (b->half_interval * b->half_interval);
  return Stiffness{(wa * a->value + wb * b->value) / (wa + wb), 1.0 / std::sqrt(wa + wb)};
}

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

auto palpate(const ForceLog& full_log, const TensionStateParameters<double>& parameters,
             const std::vector<SiteSpan>& sites, double from_share) -> std::vector<SiteStiffness> {
  if (const auto fault = check(parameters); fault != TensionStateFault::kNone) {
    throw BadInput(describe(fault));
  }
  if (full_log.samples() < 2) {
    throw BadInput(full_log.name + ": nothing was recorded; press and release each site at least once");
  }
  const ForceLog log = averaged(full_log);
  const auto seen = see(log, parameters);
  double largest = 0.0;
  for (const auto& s : seen) {
    largest = std::max(largest, s.known ? std::abs(s.joint_torque) : 0.0);
  }
  std::vector<SiteStiffness> result;
  for (const auto& site : sites) {
    SiteStiffness stiffness;
    stiffness.begin_s = site.begin_s;
    stiffness.end_s = site.end_s;
    const auto in = [&](ForcePhase phase) {
      return combine(stiffness_in(log, seen, parameters, site, phase, true, from_share * largest),
                     stiffness_in(log, seen, parameters, site, phase, false, from_share * largest));
    };
    stiffness.both_active = in(ForcePhase::kBothActive);
    stiffness.one_slack = in(ForcePhase::kOneSlack);
    stiffness.combined = combine(stiffness.both_active, stiffness.one_slack);
    result.push_back(stiffness);
  }
  return result;
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
