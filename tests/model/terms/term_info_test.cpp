// SPDX-License-Identifier: Apache-2.0
// What the terms outside the catalogue say of themselves, by the same rules as the catalogue's.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "capstan/model/catalogue.hpp"
#include "capstan/model/terms/angle_periodic.hpp"
#include "capstan/model/terms/axis_coupling.hpp"
#include "capstan/model/terms/gravity.hpp"
#include "capstan/model/terms/load_inertia.hpp"
#include "capstan/model/terms/presliding.hpp"
#include "capstan/model/terms/reversal_memory.hpp"
#include "capstan/model/terms/stiffness_hardening.hpp"
#include "capstan/model/terms/thermal_drift.hpp"
#include "capstan/model/terms/viscoelastic_creep.hpp"
#include "capstan/model/torque_law.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using Candidates = TermList<ReversalMemory, Presliding, Gravity, AxisCoupling, ViscoelasticCreep, ThermalDrift,
                            AnglePeriodic, StiffnessHardening, LoadInertia>;

template <typename Visit>
void for_each_term(Visit&& visit) {
  Candidates::for_each<double>(visit);
  EffortTerms::for_each<double>(visit);
}

auto snake_case(std::string_view name) -> bool {
  return !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string_view::npos;
}
auto written(const char* text) -> bool {
  return text != nullptr && *text != '\0';
}

TEST(TermInfo, NamesAreSnakeCaseAndNoneRepeats) {
  std::vector<std::string_view> names;
  const auto collect = [&names]<typename Term>() { names.emplace_back(Term::kInfo.name); };
  for_each_term(collect);
  OutputTerms::for_each<double>(collect);
  for (const auto name : names) {
    EXPECT_TRUE(snake_case(name)) << name;
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  }
}

TEST(TermInfo, EveryTextIsWritten) {
  for_each_term([]<typename Term>() {
    const auto& info = Term::kInfo;
    EXPECT_TRUE(written(info.equation) && written(info.source) && written(info.confusable_with) &&
                written(info.exciting_motion))
        << info.name;
    for (const auto& c : info.coefficients) {
      EXPECT_TRUE(snake_case(c.name) && written(c.unit) && written(c.doc)) << info.name;
    }
    for (const auto& s : info.shapes) {
      EXPECT_TRUE(snake_case(s.name) && written(s.unit) && written(s.doc)) << info.name;
    }
  });
}

TEST(TermInfo, EveryShapeStartsInsideItsRangeAndTheRangeFitsFixedPoint) {
  for_each_term([]<typename Term>() {
    for (const ShapeInfo& shape : Term::kInfo.shapes) {
      EXPECT_LT(shape.minimum, shape.initial) << Term::kInfo.name;
      EXPECT_LT(shape.initial, shape.maximum) << Term::kInfo.name;
      EXPECT_GT(shape.minimum, 0.0) << Term::kInfo.name << ": a grid in equal ratios needs a start";
      EXPECT_FALSE(Q24::from_double(shape.maximum).is_saturated()) << Term::kInfo.name;
    }
  });
}

/// A term whose shapes are all zero, as in a parameter table nobody has written to.
template <typename Term, typename Scalar>
void expect_finite_with_no_shape() {
  Term term(test::one_khz<Scalar>(), {});
  for (const double q1 : {0.0, 0.5, -0.25}) {
    const auto phi = term.update({.q1 = test::number<Scalar>(q1), .dq1 = test::number<Scalar>(q1)});
    for (std::size_t k = 0; k < phi.size(); ++k) {
      EXPECT_FALSE(ScalarTraits<Scalar>::is_missing(phi[k])) << Term::kInfo.name;
    }
  }
}

/// A term after two updates, with shapes that do something.
template <typename Term>
auto used_term(const Sample<Q24>& first, const Sample<Q24>& second) -> Term {
  std::array<Q24, kShapesOf<Term>> shape{};
  std::transform(Term::kInfo.shapes.begin(), Term::kInfo.shapes.end(), shape.begin(),
                 [](const ShapeInfo& info) { return Q24::from_double(info.initial); });
  Term term(test::one_khz<Q24>(), shape);
  term.update(first);
  term.update(second);
  return term;
}

/// A motion at a place; the other motors and the temperature are where they are.
auto motion_at(double place, bool forward, double tau) -> Sample<Q24> {
  Sample<Q24> motion{.q1 = test::number<Q24>(place),
                     .dq1 = test::number<Q24>(0.05 + place / 10.0),
                     .tau = test::number<Q24>(tau),
                     .forward = forward,
                     .h = test::number<Q24>(place - 0.01),
                     .dh = test::number<Q24>(0.04 + place / 10.0),
                     .ddq1 = test::number<Q24>(place / 3.0),
                     .tau_reversal = test::number<Q24>(-tau - place),
                     .q2 = test::number<Q24>(place / 2.0),
                     .warmth = test::number<Q24>(7.0)};
  motion.others[0] = motion.others[1] = motion.others[2] = {test::number<Q24>(0.4), test::number<Q24>(0.05), false};
  return motion;
}

// The inverse believes what a term says of its steady state, and asks no more than that.
TEST(TermInfo, SteadyStatesDependOnWhatTheTermSays) {
  std::array<int, 4> kinds{};
  const auto check = [&kinds]<typename Term>() {
    const Term term = used_term<Term>(motion_at(0.2, true, 0.1), motion_at(0.7, true, 0.1));
    const Term other = used_term<Term>(motion_at(0.2, false, -0.1), motion_at(-0.4, false, -0.1));
    const std::string_view name = Term::kInfo.name;
    const auto kind = steady_state_of<Term>();
    ++kinds[static_cast<std::size_t>(kind)];
    const bool either_way =
        term.steady_state(motion_at(0.7, true, 0.2)) == term.steady_state(motion_at(0.7, false, -0.3));
    const bool said = kind == SteadyState::kEitherWay || kind == SteadyState::kAsItIs || name == "motor_angle";
    EXPECT_EQ(either_way, said) << name;
    if (kind == SteadyState::kAsItIs) {
      Term updated = term;
      const auto now = updated.update(motion_at(0.9, true, 0.2));
      EXPECT_EQ(now, updated.steady_state(motion_at(-0.3, false, -0.3))) << name;
    }
    if (kind == SteadyState::kOfDirection) {
      EXPECT_EQ(term.steady_state(motion_at(0.7, true, 0.2)), other.steady_state(motion_at(-0.4, true, 0.2))) << name;
    }
  };
  SumTerms::for_each<Q24>(check);
  EXPECT_EQ(kinds, (std::array{6, 5, 7, 6}));
  kinds = {};
  TorqueTerms::for_each<Q24>(check);
  EXPECT_EQ(kinds, (std::array{4, 9, 1, 3}));
}

TEST(TermInfo, NoTermMindsShapesOfZero) {
  for_each_term([]<typename Term>() { expect_finite_with_no_shape<Term, double>(); });
  const auto fixed = []<typename Term>() { expect_finite_with_no_shape<Term, Q24>(); };
  Candidates::for_each<Q24>(fixed);
  EffortTerms::for_each<Q24>(fixed);
}

}  // namespace
}  // namespace capstan
