// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_size.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {

auto torque_logs(const Preparation& p, const JointFile& healthy, const Loop& before) -> TorqueLogs {
  return {p.logs, p.causal.samples(), before.half_width_rad, beta_of(healthy), before.late_s.value_or(0.0)};
}

LoopSize::LoopSize(const Preparation& p, const JointFile& healthy, const Loop& before, const LawForm& law)
    : p_(p),
      healthy_(healthy),
      before_(before),
      law_(before.late_s ? with_lateness(p.causal, p.target, p.certain(), law) : law) {}

auto LoopSize::half_width_rad() const -> double {
  return half_width_of(law_);
}

auto LoopSize::with_intervals() const -> JointFile {
  const Blocks blocks = interval_blocks(
      unbroken(refined(p_.split, p_.factor).learned()),
      p_.target - law_columns(p_.causal, law_) * fit_law(p_.causal, p_.target, p_.certain(), law_).theta);
  return law_with_intervals(p_.causal, p_.target, blocks, law_, p_.conditioner);
}

// The healthy width is as sure as this one.
auto LoopSize::of_change(const std::string& name) const -> EffectSize {
  const JointFile law = with_intervals();
  const auto& ci95 = law.shape_ci95[law_.catalogue->term(kPlayTerm).first_shape];
  const double half =
      ci95 ? std::hypot(0.5 * ((*ci95)[1] - (*ci95)[0]) / half_width_rad() * std::sqrt(2.0), kLoopBias) : 1.0;
  const auto with = [half](double value, double slope, const char* unit) -> EffectSize {
    return {value, unit, Interval{value - slope * half, value + slope * half}};
  };
  if (name == kPlayTerm) {
    const double gap = beta_of(law) * half_width_rad();
    return with(gap * (1.0 - 1.0 / width()), gap, "rad");
  }
  if (const auto pretension = name == kPretensionTerm ? of_pretension(half * width()) : std::nullopt) {
    return *pretension;
  }
  const double over = name == kPretensionTerm ? width() : 1.0 / width();
  return with(over, over, "1");
}

// Neither width nor torque goes with the pretension alone: the joint's own friction L is in both, the motor's c in
// the torque. Taut, f = c + F + L and the half width is k (F + 2 L), F the tendons' friction, as a load stretches
// them twice as much, per torque, as their own friction: with (2.16), S(L) = C tanh(eta / 2) / eta (F / 2 + L). So
// the two changes give k and F. width_95 is half of the interval of the loop's width over the healthy one's.
auto LoopSize::of_pretension(double width_95) const -> std::optional<EffectSize> {
  const double reach = before_.half_width_rad * std::max(1.0, width());
  const auto now = torque_parts({p_.logs, p_.causal.samples(), reach});
  if (!now || !healthy_.fit || !healthy_.fit->torque) {
    return std::nullopt;
  }
  constexpr std::size_t kMotorFriction = 4;
  const double motor = healthy_.parameters.shapes[healthy_.catalogue->term(kTendonModel).first_shape + kMotorFriction];
  const double friction = healthy_.fit->torque->friction();
  const double more = now->friction() - friction;
  const double tendons = 2.0 * (friction - motor) - more / (width() - 1.0);
  if (tendons <= kLeastOfFriction * friction || tendons > friction) {
    return std::nullopt;
  }
  const double per_width = std::pow(more / (tendons * (width() - 1.0)), 2.0);
  const double per_motor = 2.0 * std::abs(more) / (tendons * tendons);
  const double half = std::hypot(per_width * width_95, per_motor * kMotorFrictionKnown * friction);
  const double over = 1.0 + more / tendons;
  return EffectSize{over, "1", Interval{over - half, over + half}};
}

// How late the healthy joint may be by its own drag, which is another in another motion; a clock's is not.
auto LoopSize::lateness_of_drag() const -> double {
  const bool told = healthy_.fit && healthy_.fit->torque;
  return told ? std::abs(healthy_.fit->torque->viscous()) / before_.torque_stretching(1.0) : *before_.late_s;
}

auto LoopSize::of_delay(const std::string& name) const -> std::optional<EffectSize> {
  if (name != kDelayTerm || !law_.has(name) || !before_.late_s) {
    return std::nullopt;
  }
  const auto& ci95 = with_intervals().shape_ci95[law_.catalogue->term(name).first_shape];
  const double value = lateness_of(law_) - *before_.late_s;
  if (!ci95) {
    return EffectSize{value, "s"};
  }
  const double fitted = 0.5 * ((*ci95)[1] - (*ci95)[0]) * std::sqrt(2.0);  // the healthy one is as sure as this one
  const double half = std::hypot(fitted, kLatenessKnown * std::min(*before_.late_s, lateness_of_drag()));
  return EffectSize{value, "s", Interval{value - half, value + half}};
}

auto LoopSize::is_torque_periodic() const -> bool {
  constexpr const char* kPeriodic = "angle_periodic";
  const JointFile law = with_intervals();
  const CatalogueTerm& term = law.catalogue->term(kPeriodic);
  const double* wave = &law.parameters.coefficients[term.first_coefficient];
  const double order = law.parameters.shapes[term.first_shape];
  const double stretch = std::hypot(wave[0], wave[1]) / std::abs(beta_of(healthy_));
  return periodic_torque(torque_logs(p_, healthy_, before_), *healthy_.fit->torque, order) >
         kTorqueOfStretch * before_.torque_stretching(stretch);
}

}  // namespace capstan::tools
