// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/pretension.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/model/terms/tendon.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/identify/torque_balance.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// A shape of the law's tendons, known to the share that is known of it and to its interval. Where a fit held it, it is
/// from a fit of the same logs before that.
auto shape_of(const JointFile& joint, TendonShape::Place place, double share) -> Gauged {
  const std::size_t at = joint.catalogue->term(kTendonModel).first_shape + place;
  const double value = joint.parameters.shapes[at];
  const auto& ci95 = joint.shape_ci95[at];
  return {value, std::hypot(share * value, ci95 ? 0.5 * ((*ci95)[1] - (*ci95)[0]) : share * value)};
}

/// A friction number of the law's tendons.
auto friction_number(const JointFile& joint, TendonShape::Place place) -> Gauged {
  const bool large = joint.parameters.shapes[joint.catalogue->term(kTendonModel).first_shape + place] > kLargeEta;
  return shape_of(joint, place, large ? kLargeEtaKnown : kTendonEtaKnown);
}

auto motor_friction(const JointFile& joint) -> double {
  return joint.parameters.shapes[joint.catalogue->term(kTendonModel).first_shape + TendonShape::kFriction];
}

auto range_text(const Gauged& number, const std::string& unit) -> std::string {
  return with_interval(number.value, number.value - number.half, number.value + number.half) +
         (unit == "1" ? "" : " " + unit);
}

/// What is told best of two times' pretension: newtons, torque, or nothing but the ratio.
auto best_of(const PretensionNumbers& n) -> std::pair<Gauged, std::string> {
  if (n.force_n() > 0.0) {
    return {{n.force_n(), n.force_95_n()}, "N"};
  }
  return n.torque_nm() > 0.0 ? std::pair<Gauged, std::string>{{n.torque_nm(), n.torque_95_nm()}, "Nm"}
                             : std::pair<Gauged, std::string>{{1.0, 0.0}, "1"};
}

/// How far a tendon stretches, per torque and compliance, while it slides (2.16).
auto stretch_by_friction(double eta) -> double {
  return std::tanh(0.5 * eta) / eta;
}

/// Whether width and torque changed as they do when the tendons' friction F alone does: with c the motor's own friction
/// and L the joint's, the torque is c + F + L and the width k (F + 2 L) (LoopSize::of_pretension). The pretension
/// leaves k as it was, the friction number does not.
/// @param stretch  k over the healthy joint's
auto goes_with_width(const JointFile& healthy, const Loop& before, const Loop& now, double times, double stretch = 1.0)
    -> bool {
  const double friction_nm = healthy.fit->pretension->friction_nm();
  const double joint_nm = std::max(0.0, before.torque_nm - motor_friction(healthy) - friction_nm);
  const double wanted = stretch * (1.0 + friction_nm * (times - 1.0) / (friction_nm + 2.0 * joint_nm));
  return std::abs(now.half_width_rad / before.half_width_rad - wanted) <
         kLoopTold + kWidthWithTorque * std::abs(wanted - 1.0);
}

/// The tendons' friction over the healthy joint's.
auto friction_times(const JointFile& healthy, const Loop& before, const Loop& now) -> double {
  return 1.0 + (now.torque_nm - before.torque_nm) / healthy.fit->pretension->friction_nm();
}

/// Half of its interval, by how well the torque of a loop comes again and the healthy joint's friction is known.
auto friction_times_95(const JointFile& healthy, const Loop& before, double times) -> double {
  const PretensionNumbers& known = *healthy.fit->pretension;
  return std::hypot(std::abs(times - 1.0) * known.friction_95_nm() / known.friction_nm(),
                    kTorqueAgain * before.torque_nm / known.friction_nm());
}

}  // namespace

auto is_held(const AxisLog& log, double beta) -> bool {
  // A free joint follows but for its loop; one that is held moves by its noise, which may be as large as the way of a
  // motor that pulls at it.
  constexpr double kFollows = 0.25;
  if (log.q2_rad.size() == 0) {
    return false;
  }
  const Eigen::ArrayXd motor = log.q1_rad.array() - log.q1_rad.mean();
  const double follows = (motor * log.q2_rad.array()).sum();
  return std::abs(follows) < kFollows * std::abs(beta) * motor.square().sum();
}

auto pretension_of(const JointFile& joint, bool held) -> std::optional<PretensionNumbers> {
  if (!joint.has(kTendonModel)) {
    return std::nullopt;
  }
  const Gauged top = friction_number(joint, TendonShape::kEtaTop);
  const Gauged bottom = friction_number(joint, TendonShape::kEtaBottom);
  const Gauged torque = shape_of(joint, TendonShape::kPretension, kTendonPretensionKnown);
  const Gauged eta = {0.5 * (top.value + bottom.value), 0.5 * (top.half + bottom.half)};
  const double friction = eta.value * torque.value;
  if (friction <= 0.0) {
    return std::nullopt;
  }
  PretensionNumbers numbers;
  if (!held) {  // the two go against each other: what the motor rubs beside them is what their product is known to
    numbers.values = {friction, kMotorFrictionOfFreeTip * motor_friction(joint) + kProductOfFreeTip * friction};
    return numbers;
  }
  numbers.values = {friction,     friction * std::hypot(eta.half / eta.value, torque.half / torque.value),
                    torque.value, torque.half,
                    eta.value,    eta.half};
  return numbers;
}

void put_into_newtons(const TendonDrawing& drawing, JointFile& joint) {
  if (!joint.fit || !joint.fit->pretension || !joint.has(kTendonModel)) {
    return;
  }
  PretensionNumbers& numbers = *joint.fit->pretension;
  double radius_m = drawing.radius_m.value_or(0.0);
  double radius_share = 0.0;
  // r1^2 = 2 / (K (c_t + c_b)); a free tip does not know the compliance apart from the rest.
  if (!drawing.radius_m && drawing.stiffness_n_per_m && numbers.torque_nm() > 0.0) {
    const double elongation = joint.parameters.coefficients[joint.catalogue->term(kTendonModel).first_coefficient];
    const double compliance = std::abs(elongation / beta_of(joint));
    radius_m = compliance > 0.0 ? std::sqrt(2.0 / (*drawing.stiffness_n_per_m * compliance)) : 0.0;
    radius_share = 0.5 * kTendonPretensionKnown;
  }
  if (radius_m <= 0.0) {
    return;
  }
  numbers.values[PretensionNumbers::kRadius] = radius_m;
  if (numbers.torque_nm() > 0.0) {
    const double force_n = numbers.torque_nm() / radius_m;
    numbers.values[PretensionNumbers::kForce] = force_n;
    numbers.values[PretensionNumbers::kForce95] =
        force_n * std::hypot(numbers.torque_95_nm() / numbers.torque_nm(), radius_share);
  }
}

auto pretension_sentence(const PretensionNumbers& n) -> std::string {
  const std::string radius = "the radius of the motor's pulley (--radius METRES)";
  if (n.torque_nm() == 0.0) {
    return "friction along the tendons takes " + range_text({n.friction_nm(), n.friction_95_nm()}, "Nm") +
           ", friction number times pretension times radius. To get the pretension in N, add a log with the tip held "
           "in " +
           "which the motor pulls each tendon slack in turn" + (n.radius_m() > 0.0 ? "" : ", and give " + radius);
  }
  const std::string eta = "; friction number " + range_text({n.eta(), n.eta_95()}, "1");
  if (n.force_n() == 0.0) {
    return "pretension times the radius of the motor's pulley is " +
           range_text({n.torque_nm(), n.torque_95_nm()}, "Nm") + eta + "; to get it in N, give " + radius +
           " or the tendons' stiffness (--stiffness N/m)";
  }
  return "pretension is " + range_text({n.force_n(), n.force_95_n()}, "N") + ", both tendons' mean tensions together" +
         eta;
}

auto pretension_drift(const JointFile& healthy, const Loop& now, const std::optional<TorqueParts>& parts)
    -> std::optional<PretensionDrift> {
  const auto before = loop_of(healthy);
  if (!before || !healthy.fit->pretension) {
    return std::nullopt;
  }
  const PretensionNumbers& known = *healthy.fit->pretension;
  const double friction = known.friction_nm();
  const double more = now.torque_nm - before->torque_nm;
  const double times = friction_times(healthy, *before, now);
  if (times <= 0.0 || !goes_with_width(healthy, *before, now, times)) {
    return std::nullopt;
  }
  // The torque that turns round with the motion, taken apart from what speed and weight take: another way to measure
  // it.
  const double otherwise = parts && healthy.fit->torque
                               ? std::abs(parts->friction() - healthy.fit->torque->friction() - more) / friction
                               : 0.0;
  PretensionDrift drift;
  drift.times = {times, std::hypot(otherwise, friction_times_95(healthy, *before, times))};
  drift.now = known;
  for (const auto scaled : {PretensionNumbers::kFriction, PretensionNumbers::kTorque, PretensionNumbers::kForce}) {
    const double value = known.values[scaled];
    drift.now.values[scaled] = value * times;
    drift.now.values[scaled + 1] =  // its interval
        value > 0.0 ? std::hypot(times * known.values[scaled + 1], value * drift.times.half) : 0.0;
  }
  const auto [was, unit] = best_of(known);
  drift.unit = unit;
  drift.pretension = unit == "1" ? drift.times : best_of(drift.now).first;
  drift.change = {was.value * (times - 1.0), std::hypot(was.half * (times - 1.0), was.value * drift.times.half)};
  return drift;
}

auto friction_number_drift(const JointFile& healthy, const Loop& now) -> std::optional<Gauged> {
  const auto before = loop_of(healthy);
  if (!before || !healthy.fit->pretension || healthy.fit->pretension->eta() == 0.0) {
    return std::nullopt;
  }
  const double eta = healthy.fit->pretension->eta();
  const double times = friction_times(healthy, *before, now);
  if (times <= 0.0 || goes_with_width(healthy, *before, now, times) ||
      !goes_with_width(healthy, *before, now, times, stretch_by_friction(times * eta) / stretch_by_friction(eta))) {
    return std::nullopt;
  }
  return Gauged{times, friction_times_95(healthy, *before, times)};
}

auto friction_number_sentence(const PretensionNumbers& healthy, const Gauged& times) -> std::string {
  const double now = times.value * healthy.eta();
  return "the tendons' friction number is " +
         range_text({now, std::hypot(times.value * healthy.eta_95(), times.half * healthy.eta())}, "1") + ", " +
         range_text({100.0 * times.value, 100.0 * times.half}, "% of the healthy joint's") +
         ", at the same pretension: more tension would have made the loop wider for the torque that it takes";
}

auto drift_sentence(const PretensionDrift& drift) -> std::string {
  // A free tip tells their product.
  const std::string condition =
      ", if the tendons rub as they did: a friction number that has changed as much looks the same under a free tip";
  if (drift.unit == "1") {
    return "pretension is " +
           range_text({100.0 * drift.times.value, 100.0 * drift.times.half}, "% of the healthy joint's") + condition +
           "; to get it in N, identify the healthy joint with a log with the tip held";
  }
  const bool less = drift.change.value < 0.0;
  const std::string name = drift.unit == "N" ? "pretension is " : "pretension times the motor pulley's radius is ";
  return name + range_text(drift.pretension, drift.unit) + ", " +
         range_text({std::abs(drift.change.value), drift.change.half}, drift.unit) + (less ? " less" : " more") +
         " than the healthy joint's" + condition +
         (drift.unit == "N" ? "" : "; to get it in N, give that radius (--radius METRES)");
}

}  // namespace capstan::tools
