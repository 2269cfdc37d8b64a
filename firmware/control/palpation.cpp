// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/palpation.hpp"

#include <algorithm>

#include "capstan/firmware/loop/expect.hpp"

namespace capstan {
namespace {

// The numbers of tools/identify/palpation.cpp, which says where they come from.
constexpr Q24 kPressed = Q24::from_double(0.3);         // of the largest torque: contact alone counts
constexpr Q24 kReleasedShare = Q24::from_double(0.35);  // of that, on the way out
constexpr Q24 kModelShare = Q24::from_double(0.005);
constexpr Q24 kMostDampingSPerRad = Q24::from_double(0.2);
constexpr Q24 kMostAlike = Q24::from_double(0.9);
// Of the error that rows show: over stretches as short as these a process of first order leaves less than over long
// ones. Chosen on 24 Nov 2026 on seeds 780000 to 780299, damped, undamped and pressed by torque, where 1 covered 96.7,
// 97.3 and 97.3 % and 0.9 covers 94.7, 97.0 and 96.3 %; judged on others (palpation_coverage_test).
constexpr Q24 kOfRows = Q24::from_double(0.9);

constexpr std::int32_t kPerRow = 20;  // cycles: noise turns more often than the motion, and every turn is phase I
constexpr Q24 kRowS = Q24::from_double(0.001 * kPerRow);

constexpr Q24 kOne = Q24::from_int(1);
constexpr int kShift = 8;  // Q24 to 2^-16
// What keeps every sum in 64 bits: at most 16 N m and 16 rad from where a stretch begins, over as many rows.
constexpr std::int32_t kFarthest = std::int32_t{1} << 20;
constexpr std::int32_t kMostRows = 1024;
constexpr std::int32_t kMostStretches = 4096;  // of a group

/// 97.5 % of Student's t with 1 to 11 degrees of freedom.
constexpr std::array<Q24, 11> kStudent = {Q24::from_double(12.706), Q24::from_double(4.303), Q24::from_double(3.182),
                                          Q24::from_double(2.776),  Q24::from_double(2.571), Q24::from_double(2.447),
                                          Q24::from_double(2.365),  Q24::from_double(2.306), Q24::from_double(2.262),
                                          Q24::from_double(2.228),  Q24::from_double(2.201)};

// Out of line: in place they take twice the flash, and no cycle waits for them.

/// a / b as Q24's own.
[[gnu::noinline]] auto over(Q24 a, Q24 b) -> Q24 {
  return a / b;
}

/// Straight between the table's rows, and within 0.2 % of the true one beyond its end.
auto student(Q24 freedom) -> Q24 {
  const Q24 from_one = std::max(freedom - kOne, Q24{});
  const auto row = static_cast<std::size_t>(from_one.raw() >> Q24::kFrac);
  if (row + 1 < kStudent.size()) {
    const Q24 share = from_one - Q24::from_int(static_cast<std::int32_t>(row));
    return kStudent[row] + share * (kStudent[row + 1] - kStudent[row]);
  }
  constexpr Q24 kNormal = Q24::from_double(1.96);
  constexpr Q24 kMore = Q24::from_double(2.65);
  return kNormal + over(kMore, freedom);
}

/// above / below; both lose the same bits where the quotient would not fit otherwise.
[[gnu::noinline]] auto quotient(std::int64_t above, std::int64_t below) -> Q24 {
  constexpr std::int64_t kFits = std::int64_t{1} << 38;
  while (above > kFits || above < -kFits) {
    above /= 2;
    below /= 2;
  }
  return below == 0 ? Q24::max() : Q24::from_wide((above << Q24::kFrac) / below);
}

/// x c, exact but for the last bit. @pre it fits
[[gnu::noinline]] auto times(std::int64_t x, Q24 c) -> std::int64_t {
  constexpr std::int64_t kPart = (std::int64_t{1} << Q24::kFrac) - 1;
  return (x >> Q24::kFrac) * c.raw() + ((x & kPart) * c.raw() >> Q24::kFrac);
}

[[gnu::noinline]] auto square_root(std::uint64_t square) -> std::int64_t {
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 31; bit != 0; bit >>= 1) {
    const std::uint64_t more = root | bit;
    root = more * more <= square ? more : root;
  }
  return static_cast<std::int64_t>(root);
}

auto square(Q24 x) -> std::uint64_t {
  return static_cast<std::uint64_t>(std::int64_t{x.raw()} * x.raw());
}

[[gnu::noinline]] auto hypotenuse(Q24 a, Q24 b) -> Q24 {
  return Q24::from_wide(square_root(square(a) + square(b)));
}

/// Root of above / below, both positive.
auto root_of_quotient(std::int64_t above, std::int64_t below) -> Q24 {
  int room = 2 * Q24::kFrac;
  for (; room > 0 && above < std::int64_t{1} << 61; --room) {
    above *= 2;
  }
  below >>= room;
  return below == 0 ? Q24::max() : Q24::from_wide(square_root(static_cast<std::uint64_t>(above / below)));
}

auto parameters_of(const ForceConfig& force) -> TensionStateParameters<Q24> {
  return {.eta_top = force.eta_top,
          .eta_bottom = force.eta_bottom,
          .pretension_nm = force.pretension_nm,
          .compliance_top = over(kOne, force.stiffness_top_nm_per_rad),
          .compliance_bottom = over(kOne, force.stiffness_bottom_nm_per_rad),
          .beta = over(kOne, force.ratio),
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

void Palpation::begin(const ForceConfig& force, const Pressing& pressing) {
  CAPSTAN_EXPECT(check(force) == nullptr);
  const TensionStateParameters<Q24> parameters = parameters_of(force);
  // One pull to either end shows what reaches the joint there.
  state_ = TensionState<Q24>(parameters);
  largest_ = abs(state_.update(Q24{}, pressing.largest_nm, true).joint_torque);
  largest_ = std::max(largest_, abs(state_.update(Q24{}, -pressing.largest_nm, false).joint_torque));
  state_ = TensionState<Q24>(parameters);
  moved_forward_ = true;
  extreme_ = Q24::lowest();
  q1_sum_ = tau_sum_ = averaged_ = 0;
  time_ = in_stretch_ = 0;
  stretch_ = {};
  groups_ = {};
  site_ = pressing.site;
}

void Palpation::add(Q24 q1_rad, Q24 tau_nm) {
  q1_sum_ += q1_rad.raw();
  tau_sum_ += tau_nm.raw();
  if (++averaged_ < kPerRow) {
    return;
  }
  const Q24 q1 = Q24::from_wide(q1_sum_ / kPerRow);
  const Q24 tau = Q24::from_wide(tau_sum_ / kPerRow);
  q1_sum_ = tau_sum_ = averaged_ = 0;
  // As in SampleConditioner: the direction turns after a return that is no noise.
  constexpr Q24 kReturn = Q24::from_double(0.001);
  const Q24 beyond = moved_forward_ ? q1 - extreme_ : extreme_ - q1;
  moved_forward_ = -beyond > kReturn ? !moved_forward_ : moved_forward_;
  extreme_ = beyond > Q24{} || -beyond > kReturn ? q1 : extreme_;
  take(state_.update(q1, tau, moved_forward_), moved_forward_);
}

void Palpation::take(const TensionStateEstimate<Q24>& estimate, bool forward) {
  constexpr std::int32_t kMostGap = 2;  // noise of the torque now and then shows another phase
  time_ += 1;
  const bool slides = estimate.phase == ForcePhase::kBothActive || estimate.phase == ForcePhase::kOneSlack;
  const bool forward_side = estimate.joint_torque > Q24{};
  const Kind kind = {forward_side, forward == forward_side, estimate.phase == ForcePhase::kOneSlack};
  const Q24 least = largest_ * kPressed * (kind.pressing ? kOne : kReleasedShare);
  const bool counts = estimate.known && slides && abs(estimate.joint_torque) > least;
  const Row& newest = held_[static_cast<std::size_t>(in_stretch_ + kHeld - 1) % kHeld];
  if (in_stretch_ > 0 && (time_ - newest.time > kMostGap || in_stretch_ == kMostRows)) {
    close_stretch();
  }
  if (!counts || (in_stretch_ > 0 && kind != kind_)) {
    return;
  }
  Row row = {estimate.joint_torque.raw() >> kShift, estimate.q2.raw() >> kShift, time_};
  if (in_stretch_ == 0) {
    kind_ = kind;
    origin_ = row;
  }
  row.torque -= origin_.torque;
  row.angle -= origin_.angle;
  if (std::max(std::abs(row.torque), std::abs(row.angle)) < kFarthest) {
    hold(row);
  }
}

void Palpation::hold(const Row& row) {
  Row& oldest = held_[static_cast<std::size_t>(in_stretch_) % kHeld];
  if (in_stretch_ >= kHeld + kEdge) {
    add_row(oldest);
  }
  oldest = row;
  ++in_stretch_;
}

void Palpation::Products::add(std::int64_t t, std::int64_t q) {
  tt += t * t;
  tq += t * q;
  qq += q * q;
}

void Palpation::Products::add(const Products& other) {
  tt += other.tt;
  tq += other.tq;
  qq += other.qq;
}

void Palpation::add_row(const Row& row) {
  Stretch& s = stretch_;
  if (s.count == 0) {
    s.first = row;
  } else {
    s.steps.add(row.torque - s.last.torque, row.angle - s.last.angle);
  }
  s.last = row;
  s.t += row.torque;
  s.q += row.angle;
  s.rows.add(row.torque, row.angle);
  s.count += 1;
}

auto Palpation::place_of(const Kind& kind) -> std::size_t {
  return (kind.forward_side ? 4U : 0U) + (kind.pressing ? 2U : 0U) + (kind.one_slack ? 1U : 0U);
}

void Palpation::close_stretch() {
  constexpr std::int32_t kFewest = 6;
  const std::int32_t edge = std::min(kEdge, in_stretch_ / 6);
  for (std::int32_t i = std::max(edge, in_stretch_ - kHeld); i < in_stretch_ - edge; ++i) {
    add_row(held_[static_cast<std::size_t>(i) % kHeld]);
  }
  const Stretch s = stretch_;
  in_stretch_ = 0;
  stretch_ = {};
  Group& into = groups_[place_of(kind_)];
  if (s.count < kFewest || into.stretches == kMostStretches) {
    return;
  }
  into.rows.add({s.rows.tt - s.t * s.t / s.count, s.rows.tq - s.t * s.q / s.count, s.rows.qq - s.q * s.q / s.count});
  into.steps.add(s.steps);
  into.count += s.count;
  into.stretches += 1;
  into.travel += std::abs(s.last.angle - s.first.angle);
  into.span += s.last.time - s.first.time;
}

/// Slope of angle over torque, and half the 95 % interval of its inverse. Neighbouring rows err alike, so they count as
/// fewer: by the residual's first autocorrelation, as of a process of first order. The mean square of the steps says it
/// (von Neumann's ratio), but for what the ends of the stretches lack.
auto Palpation::stiffness_of(const Group& group) -> std::optional<Estimate> {
  const Products& rows = group.rows;
  if (rows.tt <= 0 || rows.tq <= 0) {
    return std::nullopt;
  }
  const Q24 compliance = quotient(rows.tq, rows.tt);
  const auto left = [compliance](const Products& p) {
    return std::max(std::int64_t{1}, p.qq - 2 * times(p.tq, compliance) + times(times(p.tt, compliance), compliance));
  };
  const std::int64_t residual = left(rows);
  constexpr Q24 kHalf = Q24::from_double(0.5);
  const Q24 ends = quotient(group.stretches, group.count);
  const Q24 alike = clamp(kOne - quotient(left(group.steps), residual) * kHalf - ends, Q24{}, kMostAlike);
  const Q24 inflation = over(kOne + alike, kOne - alike);
  const std::int32_t freedom = std::max(std::int32_t{1}, group.count - group.stretches - 1);
  const Q24 counted = quotient(std::int64_t{freedom} << Q24::kFrac, inflation.raw());
  const Q24 root_of_freedom = Q24::from_wide(square_root(static_cast<std::uint64_t>(freedom) << 40) << 4);
  const Q24 error =
      over(root_of_quotient(times(residual, inflation), rows.tt), root_of_freedom) * student(counted) * kOfRows;
  const Q24 value = over(kOne, compliance);
  const Q24 half = error * value * value;
  return value.is_saturated() || half.is_saturated() ? std::nullopt : std::optional(Estimate{value, half});
}

/// What the strokes in and out of one side and phase say about it at rest. A stroke in alone has an error that nobody
/// knows, and a wider interval.
auto Palpation::at_rest(bool forward_side, bool one_slack) const -> std::optional<Estimate> {
  const Group& inward = groups_[place_of({forward_side, true, one_slack})];
  const Group& outward = groups_[place_of({forward_side, false, one_slack})];
  const auto in = stiffness_of(inward);
  const auto out = stiffness_of(outward);
  if (!in) {
    return std::nullopt;
  }
  if (!out) {
    const Q24 speed = Q24::from_wide((std::int64_t{inward.travel} << kShift) / inward.span) / kRowS;
    return Estimate{in->value, hypotenuse(in->half, kMostDampingSPerRad * speed * in->value)};
  }
  const std::int64_t speed_in = std::int64_t{inward.travel} * outward.span;
  const std::int64_t speed_out = std::int64_t{outward.travel} * inward.span;
  const Q24 share = quotient(speed_in, speed_in + speed_out);
  return Estimate{(kOne - share) * in->value + share * out->value,
                  hypotenuse((kOne - share) * in->half, share * out->half)};
}

auto Palpation::fit() const -> std::optional<SiteStiffness> {
  const auto combine = [](const std::optional<Estimate>& a, const std::optional<Estimate>& b) {
    if (!a || !b) {
      return a ? a : b;
    }
    const Q24 both = hypotenuse(a->half, b->half);
    const Q24 share = both > Q24{} ? over(a->half, both) : Q24{};  // of b, its root
    const Q24 of_b = share * share;
    return std::optional(Estimate{(kOne - of_b) * a->value + of_b * b->value, share * b->half});
  };
  const auto in = [&](bool one_slack) { return combine(at_rest(true, one_slack), at_rest(false, one_slack)); };
  const auto site = combine(in(false), in(true));
  if (!site || site->half >= site->value) {
    return std::nullopt;
  }
  std::int32_t strokes = 0;
  for (const Group& group : groups_) {
    strokes += group.stretches;
  }
  return SiteStiffness{site_, site->value, hypotenuse(site->half, site->value * kModelShare), strokes};
}

auto Palpation::stiff_from(Q24 factor) const -> std::optional<Q24> {
  if (count_ < 3) {
    return std::nullopt;  // no rest to compare with
  }
  // Not std::sort, which calls itself: the stack has to be bounded.
  const std::span sites(sites_.data(), count_);
  const auto median = std::find_if(sites.begin(), sites.end(), [&](const SiteStiffness& site) {
    const auto softer = std::count_if(sites.begin(), sites.end(), [&](const SiteStiffness& other) {
      return other.value_nm_per_rad < site.value_nm_per_rad;
    });
    const auto as_stiff = std::count_if(sites.begin(), sites.end(), [&](const SiteStiffness& other) {
      return other.value_nm_per_rad == site.value_nm_per_rad;
    });
    const auto middle = static_cast<std::ptrdiff_t>(count_ / 2);
    return softer <= middle && middle < softer + as_stiff;
  });
  return factor * median->value_nm_per_rad;
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
