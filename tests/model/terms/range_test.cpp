// SPDX-License-Identifier: Apache-2.0
// No number of a law is cut in silence: what a term does not promise to keep in its range, the law asks about.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "capstan/model/effort_catalogue.hpp"
#include "capstan/model/motion_law.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::one_khz;

constexpr std::int32_t kLowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kHighest = std::numeric_limits<std::int32_t>::max();

/// A walk that no motor makes: ends of the range and their neighbours, anything, rest, and steps of every size.
auto next_after(std::int32_t before) -> std::int32_t {
  switch (*rc::gen::inRange(0, 5)) {
    case 0:
      return *rc::gen::element(kLowest, kHighest, kLowest + 1, kHighest - 1, 0);
    case 1:
      return *rc::gen::inRange(kLowest, kHighest);
    case 2:
      return before;
    default: {
      const std::int64_t step = std::int64_t{*rc::gen::inRange(-(1 << 24), 1 << 24)} >> *rc::gen::inRange(0, 24);
      return narrow_saturating<std::int64_t, std::int32_t>(before + step);
    }
  }
}
auto next_after(Q24 before) -> Q24 {
  return Q24::from_raw(next_after(before.raw()));
}

auto next_after(const OtherMotor<Q24>& before) -> OtherMotor<Q24> {
  return {.q1 = next_after(before.q1), .tau = next_after(before.tau), .forward = *rc::gen::arbitrary<bool>()};
}

auto next_after(const Measured<Q24>& before) -> Measured<Q24> {
  return {.q1 = next_after(before.q1),
          .tau = next_after(before.tau),
          .q2 = next_after(before.q2),
          .others = {next_after(before.others[0]), next_after(before.others[1]), next_after(before.others[2])},
          .temperature = next_after(before.temperature)};
}

/// Shapes within their limits, the limits themselves often.
template <typename Term>
auto any_shape() -> std::array<Q24, kShapesOf<Term>> {
  std::array<Q24, kShapesOf<Term>> shape{};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const auto& info = Term::kInfo.shapes[i];
    const double part = 0.01 * *rc::gen::element(0, 100, 1, *rc::gen::inRange(0, 101));
    shape[i] = Q24::from_double(info.minimum + part * (info.maximum - info.minimum));
  }
  return shape;
}

template <typename Term>
void verify_one() {
  if constexpr (stays_in_range<Term>()) {
    Term term(one_khz<Q24>(), any_shape<Term>());
    SampleConditioner<Q24> conditioner(one_khz<Q24>(), {});
    Measured<Q24> now;
    for (int i = 0; i < 20; ++i) {
      now = next_after(now);
      const Sample<Q24>& sample = conditioner.update(now);
      const auto regressors = term.update(sample);
      const auto steady_state = term.steady_state(sample);
      for (std::size_t k = 0; k < regressors.size(); ++k) {
        RC_ASSERT(sample.saturated || !regressors[k].is_saturated());
        RC_ASSERT(sample.saturated || !steady_state[k].is_saturated());
      }
    }
  }
}

RC_GTEST_PROP(TermsThatStayInRange, NeverMeetAnEndOfItUnlessTheSampleDid, ()) {
  SumTerms::for_each<Q24>([]<typename Term>() { verify_one<Term>(); });
  EffortTerms::for_each<Q24>([]<typename Term>() { verify_one<Term>(); });
  MachineEffortTerms::for_each<Q24>([]<typename Term>() { verify_one<Term>(); });
  CouplingEffortTerms::for_each<Q24>([]<typename Term>() { verify_one<Term>(); });
  GearTerms::for_each<Q24>([]<typename Term>() { verify_one<Term>(); });
}

TEST(TermsThatStayInRange, AreMostOfThem) {
  int staying = 0;
  SumTerms::for_each<Q24>([&staying]<typename Term>() { staying += stays_in_range<Term>() ? 1 : 0; });
  EXPECT_EQ(staying, 12) << "or the law asks about more than it need";
}

// All effects at once beside double, with torques up to the end of the range: until the first flag the two agree. Just
// at the torque that tendons bear at most they may decide otherwise; a little less of it and double does, too.
RC_GTEST_PROP(MotionLawSaturation, IsFlaggedInTheCycleInWhichSomethingIsCut, ()) {
  LawParameters<Q24> parameters;
  LawParameters<double> exact;
  std::size_t next = 0;
  for (std::size_t k = 0; k < kCoefficientCount; ++k) {
    // Up to a half: gravity's pair must stay below 1 together, or the law's own estimate diverges in either format.
    parameters.coefficients[k] = Q24::from_double(0.01 * *rc::gen::inRange(-50, 51));
  }
  const auto add = [&]<typename Term>() {
    for (const Q24 value : any_shape<Term>()) {
      parameters.shapes[next++] = value;
    }
  };
  for_each_term<Q24>(add);
  for (std::size_t k = 0; k < kCoefficientCount; ++k) {
    exact.coefficients[k] = parameters.coefficients[k].to_double();
  }
  for (std::size_t k = 0; k < kShapeCount; ++k) {
    exact.shapes[k] = parameters.shapes[k].to_double();
  }
  MotionLaw<Q24> law(one_khz<Q24>(), parameters);
  MotionLaw<double> reference(one_khz<double>(), exact);
  MotionLaw<double> with_less_torque(one_khz<double>(), exact);
  const double size = 0.01 * *rc::gen::inRange(1, 12000);
  bool flagged = false;
  for (int i = 0; i < 40 && !flagged; ++i) {  // beyond the first flag a state may remember what was cut
    // Angles that a rate of 128 rad/s allows, no two of them just the direction's threshold apart.
    const Q24 q1 = Q24::from_double(3e-6 * *rc::gen::inRange(-20000, 20001));
    const Q24 tau = Q24::from_double(1e-6 * *rc::gen::inRange(-1000000, 1000001) * size);
    const auto fixed = law.update(q1, tau);
    const auto wanted = reference.update(q1.to_double(), tau.to_double());
    const auto nearly = with_less_torque.update(q1.to_double(), (1.0 - 1e-5) * tau.to_double());
    flagged = fixed.saturated;
    const auto agrees = [&fixed](const Estimate<double>& law, double within) {
      return std::fabs(fixed.q2.to_double() - law.q2) < within &&
             std::fabs(fixed.q2_reported.to_double() - law.q2_reported) < within;
    };
    RC_ASSERT(flagged || agrees(wanted, 1e-3) || agrees(nearly, 5e-3));
  }
}

}  // namespace
}  // namespace capstan
