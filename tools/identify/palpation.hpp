// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "capstan/model/stiffness.hpp"
#include "capstan/model/tension_state.hpp"
#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools {

/// What the tip touches, from motor torque and motor angle alone (thesis ch. 3), N m/rad at the joint.
struct Stiffness {
  double value = 0.0;
  double half_interval = 0.0;  ///< of 95 %
};

struct SiteStiffness {
  double begin_s = 0.0, end_s = 0.0;
  std::optional<Stiffness> both_active;  ///< from phase III
  std::optional<Stiffness> one_slack;    ///< from phase IV
  std::optional<Stiffness> combined;     ///< both, each by its interval; empty: the tip was not pressed far enough
};

/// A stretch of a log in which one site is pressed and released.
struct SiteSpan {
  double begin_s = 0.0, end_s = 0.0;
};

/// The tension state's parameters from a pull-push law that was identified with the tip locked. Throws Refusal if the
/// log behind it could not determine the stiffness of both tendons.
auto tension_state_of(const PullPushFit& fit) -> TensionStateParameters<double>;

/// Stiffness site by site. Per stroke and phase the compliance dq1 / dtau is fitted while the joint's torque is above
/// `from_share` of the largest in the log, so contact alone counts; the instrument's own share of it and the pulleys'
/// ratio come out by `environment_stiffness`. The log needs no joint side.
auto palpate(const AxisLog& log, const TensionStateParameters<double>& parameters, const std::vector<SiteSpan>& sites,
             double from_share = 0.3) -> std::vector<SiteStiffness>;

/// One of two jaws of a gripper: its axis of the log, and its law.
struct Jaw {
  const AxisLog& log;
  const TensionStateParameters<double>& parameters;
};

/// The same of what two jaws hold between them, each on its own two tendons and motor (thesis 3.6): both press it with
/// one torque, and it is as long as the difference of their angles, (3.27), tendons' stretch and friction taken out by
/// each jaw's tension state. N m/rad of that difference. It does not matter which way each axis counts. Both motors
/// have to close and open, as servos: of a jaw that stands still, or that the other one drives back, the tendons do not
/// tell what they pass on, and such rows do not count. Throws BadInput if the torques do not go together, for then the
/// jaws do not hold one thing.
auto palpate_between(const Jaw& first, const Jaw& second, const std::vector<SiteSpan>& sites, double from_share = 0.3)
    -> std::vector<SiteStiffness>;

/// From this many times the median on a site is stiffer than the rest, unless somebody says otherwise: tissue that
/// differs by 10 % from site to site then gives no false alarm, and an inclusion of a third of its stiffness is found
/// (docs/thesis.md, table `detection` of `capstan thesis`).
inline constexpr double kStiffFactor = 1.2;
/// Sites that are stiffer than the rest: above the median by this factor, their whole interval.
auto stiff_sites(const std::vector<SiteStiffness>& sites, double factor = kStiffFactor) -> std::vector<std::size_t>;

}  // namespace capstan::tools
