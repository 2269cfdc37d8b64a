// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_course.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

/// A joint that follows a triangle of the motor with a play of its own, while the motor overcomes a friction. Both
/// change with the share of the log that has gone by.
template <typename Width, typename Torque>
auto course(Width&& width, Torque&& torque) -> Course {
  constexpr Eigen::Index kRows = 4000;
  constexpr double kPeriodS = 0.01;
  Samples samples(kRows);
  Eigen::VectorXd target(kRows);
  double place = 0.0;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = kPeriodS * static_cast<double>(i);
    const double gone = static_cast<double>(i) / kRows;
    const double phase = std::fmod(0.5 * t, 1.0);
    Sample<double>& sample = samples[static_cast<std::size_t>(i)];
    sample.q1 = sample.h = phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase;
    sample.dq1 = sample.dh = phase < 0.5 ? 2.0 : -2.0;
    sample.forward = phase < 0.5;
    sample.tau = (sample.forward ? 1.0 : -1.0) * torque(gone);
    place = std::clamp(place, sample.q1 - width(gone), sample.q1 + width(gone));
    target[i] = place;
  }
  const Preparation p =
      test::preparation_of(samples, target, test::split_of(40, kRows / 40, {Role::kFit, Role::kChoose}), kPeriodS);
  LawForm loop;
  loop.terms = {"motor_angle", "joint_offset", "play"};
  loop.set_shapes(loop.catalogue->term("play"), {0.1});
  return course_of(p, loop);
}

TEST(LoopCourse, OfALoopThatStaysIsOne) {
  const Course same = course([](double) { return 0.1; }, [](double) { return 0.05; });
  EXPECT_NEAR(same.width, 1.0, 0.01);
  EXPECT_NEAR(same.torque, 1.0, 0.01);
  EXPECT_FALSE(same.narrows());
  EXPECT_FALSE(same.widens());
}

TEST(LoopCourse, ALoopThatWearsWidens) {
  // From 0.1 to 0.2: on average 0.11 in the first fifth, 0.19 in the last.
  const auto grown = [](double gone) { return 0.1 * (1.0 + gone); };
  const Course wear = course(grown, grown);
  EXPECT_NEAR(wear.width, 0.19 / 0.11, 0.08);
  EXPECT_NEAR(wear.torque, 0.19 / 0.11, 0.02);
  EXPECT_TRUE(wear.widens());
  EXPECT_FALSE(wear.narrows());
  EXPECT_FALSE(wear.early);
}

TEST(LoopCourse, ALoopThatCreepsNarrowsEarly) {
  const auto creep = [](double gone) { return 0.1 * (1.0 + std::exp(-8.0 * gone)); };
  const Course relaxed = course(creep, creep);
  EXPECT_TRUE(relaxed.narrows());
  EXPECT_TRUE(relaxed.early);
  EXPECT_FALSE(relaxed.widens());
}

TEST(LoopCourse, WidthWithoutTorqueIsNoCourseOfTendons) {
  const Course gap = course([](double gone) { return 0.1 * (1.0 + gone); }, [](double) { return 0.05; });
  EXPECT_GT(gap.width, 1.5);
  EXPECT_FALSE(gap.widens());
  EXPECT_FALSE(gap.narrows());
}

}  // namespace
}  // namespace capstan::tools
