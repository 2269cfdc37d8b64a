// SPDX-License-Identifier: Apache-2.0
// What the terms outside the catalogue say of themselves, by the same rules as the catalogue's.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "capstan/model/catalogue.hpp"
#include "capstan/model/effort_catalogue.hpp"
#include "capstan/model/terms/angle_periodic.hpp"
#include "capstan/model/terms/axis_coupling.hpp"
#include "capstan/model/terms/gravity.hpp"
#include "capstan/model/terms/load_inertia.hpp"
#include "capstan/model/terms/presliding.hpp"
#include "capstan/model/terms/reversal_memory.hpp"
#include "capstan/model/terms/stiffness_hardening.hpp"
#include "capstan/model/terms/thermal_drift.hpp"
#include "capstan/model/terms/viscoelastic_creep.hpp"
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

// The inverse asks such a term once for both directions.
TEST(TermInfo, WhatHasTheSameSteadyStateHasItWhateverDirectionAndTorque) {
  int alike = 0;
  SumTerms::for_each<Q24>([&alike]<typename Term>() {
    std::array<Q24, kShapesOf<Term>> shape{};
    std::transform(Term::kInfo.shapes.begin(), Term::kInfo.shapes.end(), shape.begin(),
                   [](const ShapeInfo& info) { return Q24::from_double(info.initial); });
    Term term(test::one_khz<Q24>(), shape);
    const auto on = [](bool forward, double tau) {
      return Sample<Q24>{.q1 = test::number<Q24>(0.7),
                         .dq1 = test::number<Q24>(1.5),
                         .tau = test::number<Q24>(tau),
                         .forward = forward,
                         .tau_reversal = test::number<Q24>(-tau),
                         .q2 = test::number<Q24>(0.3)};
    };
    term.update(on(true, 0.1));
    const bool same = term.steady_state(on(true, 0.2)) == term.steady_state(on(false, -0.3));
    EXPECT_EQ(same, same_steady_state<Term>() || std::string_view(Term::kInfo.name) == "motor_angle")
        << Term::kInfo.name;
    alike += same_steady_state<Term>() ? 1 : 0;
  });
  EXPECT_EQ(alike, 12);
}

TEST(TermInfo, NoTermMindsShapesOfZero) {
  for_each_term([]<typename Term>() { expect_finite_with_no_shape<Term, double>(); });
  const auto fixed = []<typename Term>() { expect_finite_with_no_shape<Term, Q24>(); };
  Candidates::for_each<Q24>(fixed);
  EffortTerms::for_each<Q24>(fixed);
}

}  // namespace
}  // namespace capstan
