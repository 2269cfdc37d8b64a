// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/palpation.hpp"
#include "capstan/firmware/loop/expect.hpp"

#include <algorithm>

namespace capstan {
namespace {

constexpr Q24 kOne = Q24::from_int(1);
constexpr int kShift = 8;  // Q24 to 2^-16

/// 97.5 % of Student's t with 1 to 11 degrees of freedom.
constexpr std::array<Q24, 11> kStudent = {Q24::from_double(12.706), Q24::from_double(4.303), Q24::from_double(3.182),
                                          Q24::from_double(2.776),  Q24::from_double(2.571), Q24::from_double(2.447),
                                          Q24::from_double(2.365),  Q24::from_double(2.306), Q24::from_double(2.262),
                                          Q24::from_double(2.228),  Q24::from_double(2.201)};

/// above / below; both lose the same bits where the quotient would not fit otherwise.
auto quotient(std::int64_t above, std::int64_t below) -> Q24 {
  constexpr std::int64_t kFits = std::int64_t{1} << 38;
  while (above > kFits || above < -kFits) {
    above /= 2;
    below /= 2;
  }
  return below == 0 ? Q24::max() : Q24::from_wide((above << Q24::kFrac) / below);
}

auto square_root(std::uint64_t square) -> std::int64_t {
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 31; bit != 0; bit >>= 1) {
    const std::uint64_t more = root | bit;
    root = more * more <= square ? more : root;
  }
  return static_cast<std::int64_t>(root);
}

auto parameters_of(const ForceConfig& force) -> TensionStateParameters<Q24> {
  return {.eta_top = force.eta_top,
          .eta_bottom = force.eta_bottom,
          .pretension_nm = force.pretension_nm,
          .compliance_top = kOne / force.stiffness_top_nm_per_rad,
          .compliance_bottom = kOne / force.stiffness_bottom_nm_per_rad,
          .beta = kOne / force.ratio,
          .friction_nm = force.friction_nm};
}

}  // namespace

auto Palpation::check(const ForceConfig& force) -> const char* {
  const auto kind = static_cast<ForceLawKind>(force.law);
  const bool of_tendons = kind == ForceLawKind::kPullPush || kind == ForceLawKind::kBlend;
  if (!of_tendons || force.stiffness_top_nm_per_rad <= Q24{} || force.stiffness_bottom_nm_per_rad <= Q24{}) {
    return "the joint has no pull-push law with the stiffness of both tendons; identify one with the tip locked and "
           "'capstan apply' it";
  }
  const TensionStateFault fault = capstan::check(parameters_of(force));
  return fault == TensionStateFault::kNone ? nullptr : describe(fault);
}

void Palpation::begin(const ForceConfig& force, std::int32_t site, std::int32_t every_ms) {
  CAPSTAN_EXPECT(check(force) == nullptr && every_ms > 0);
  constexpr std::int32_t kAverageMs = 40;  // noise turns more often than the motion, and every turn is phase I
  state_ = TensionState<Q24>(parameters_of(force));
  constexpr Q24 kHalf = Q24::from_double(0.5);
  const TensionStateParameters<Q24> p = parameters_of(force);
  own_compliance_ = (p.compliance_top + p.compliance_bottom) * kHalf * p.beta * p.beta;
  moved_forward_ = true;
  extreme_ = Q24::lowest();
  per_row_ = std::max<std::int32_t>(1, kAverageMs / every_ms);
  q1_sum_ = tau_sum_ = averaged_ = 0;
  largest_ = Q24{};
  in_stretch_ = 0;
  stretch_count_ = 0;
  site_ = site;
}

void Palpation::add(Q24 q1_rad, Q24 tau_nm) {
  q1_sum_ += q1_rad.raw();
  tau_sum_ += tau_nm.raw();
  if (++averaged_ < per_row_) {
    return;
  }
  const Q24 q1 = Q24::from_wide(q1_sum_ / per_row_);
  const Q24 tau = Q24::from_wide(tau_sum_ / per_row_);
  q1_sum_ = tau_sum_ = averaged_ = 0;
  // As in SampleConditioner: the direction turns after a return that is no noise.
  constexpr Q24 kReturn = Q24::from_double(0.001);
  const Q24 beyond = moved_forward_ ? q1 - extreme_ : extreme_ - q1;
  moved_forward_ = -beyond > kReturn ? !moved_forward_ : moved_forward_;
  extreme_ = beyond > Q24{} || -beyond > kReturn ? q1 : extreme_;
  take(state_.update(q1, tau, moved_forward_), moved_forward_);
}

void Palpation::take(const TensionStateEstimate<Q24>& estimate, bool forward) {
  constexpr Q24 kPressed = Q24::from_double(0.3);  // of the largest torque: contact alone counts
  largest_ = std::max(largest_, abs(estimate.joint_torque));
  const Q24 pull = forward ? estimate.joint_torque : -estimate.joint_torque;
  const bool slides = estimate.phase == ForcePhase::kBothActive || estimate.phase == ForcePhase::kOneSlack;
  const bool counts = estimate.known && slides && pull > largest_ * kPressed;
  if (in_stretch_ > 0 && (!counts || estimate.phase != phase_ || forward != forward_)) {
    close_stretch();
  }
  if (!counts) {
    return;
  }
  const Row row = {estimate.joint_torque.raw() >> kShift, estimate.q2.raw() >> kShift};
  phase_ = estimate.phase;
  forward_ = forward;
  if (in_stretch_ == 0) {
    origin_ = row;
    sums_ = {};
  }
  // The last kEdge wait, and are never added if the stretch ends with them.
  constexpr auto kRows = static_cast<std::int32_t>(kEdge);
  Row& oldest = pending_[static_cast<std::size_t>(in_stretch_) % kEdge];
  if (in_stretch_ >= 2 * kRows) {
    add_row(oldest);
  }
  oldest = {row.torque - origin_.torque, row.angle - origin_.angle};
  ++in_stretch_;
}

void Palpation::add_row(const Row& row) {
  sums_.n += 1;
  sums_.t += row.torque;
  sums_.q += row.angle;
  sums_.tt += std::int64_t{row.torque} * row.torque;
  sums_.tq += std::int64_t{row.torque} * row.angle;
}

void Palpation::close_stretch() {
  constexpr std::int64_t kFewest = 6;
  in_stretch_ = 0;
  if (sums_.n < kFewest || stretch_count_ == kMostStretches) {
    return;
  }
  stretches_[stretch_count_++] = {sums_.tt - sums_.t * sums_.t / sums_.n, sums_.tq - sums_.t * sums_.q / sums_.n};
}

auto Palpation::fit() const -> std::optional<SiteStiffness> {
  Stretch all;
  for (std::size_t i = 0; i < stretch_count_; ++i) {
    all.tt += stretches_[i].tt;
    all.tq += stretches_[i].tq;
  }
  if (stretch_count_ < 2 || all.tt <= 0 || all.tq <= 0) {
    return std::nullopt;
  }
  const Q24 compliance = quotient(all.tq, all.tt);
  std::uint64_t scatter = 0;  // of each stretch's own fit about that of all
  for (std::size_t i = 0; i < stretch_count_; ++i) {
    const std::int64_t off = stretches_[i].tq - ((stretches_[i].tt >> 4) * compliance.raw() >> (Q24::kFrac - 4));
    constexpr std::int64_t kMost = std::int64_t{1} << 29;
    const auto bounded = static_cast<std::uint64_t>(std::clamp(off < 0 ? -off : off, std::int64_t{0}, kMost));
    scatter += bounded * bounded;
  }
  const auto strokes = static_cast<std::uint64_t>(stretch_count_);
  const Q24 error = quotient(square_root(scatter * strokes / (strokes - 1)), all.tt) * kStudent[stretch_count_ - 2];
  const Q24 value = kOne / compliance;
  constexpr Q24 kOfTorque = Q24::from_double(0.02);
  constexpr Q24 kOfOwn = Q24::from_double(0.05);
  const auto square = [](Q24 x) { return static_cast<std::uint64_t>(std::int64_t{x.raw()} * x.raw()); };
  const Q24 scattered = error * value * value;
  const Q24 trusted = own_compliance_ * kOfOwn * value * value;
  const Q24 half = Q24::from_wide(square_root(square(scattered) + square(trusted) + square(value * kOfTorque)));
  return SiteStiffness{site_, value, half, static_cast<std::int32_t>(stretch_count_)};
}

auto Palpation::end() -> std::optional<SiteStiffness> {
  close_stretch();
  const auto result = fit();
  if (result) {
    if (count_ == kMostSites) {
      std::copy(sites_.begin() + 1, sites_.end(), sites_.begin());
      --count_;
    }
    sites_[count_++] = *result;
  }
  return result;
}

}  // namespace capstan
