// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/thinned_design.hpp"

#include <gtest/gtest.h>

namespace capstan::tools {
namespace {

/// A ramp: sample i is at i rad with a torque of 10 i Nm.
auto ramp(std::size_t count) -> Samples {
  Samples samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    samples[i].q1 = samples[i].h = static_cast<double>(i);
    samples[i].tau = 10.0 * static_cast<double>(i);
    samples[i].forward = i % 4 > 1;
    samples[i].advance = 0.001 * static_cast<double>(i);
    samples[i].advance_late = 2.0 * samples[i].advance;
  }
  return samples;
}

TEST(Thinned, IsMeansOverAsManySamplesAsLeaveTheRowsWanted) {
  const LawDesign design({ramp(9)}, {0.5});
  const Eigen::VectorXd target = Eigen::VectorXd::LinSpaced(9, 0.0, 8.0);
  const Thinned few = thinned(design, target, {{0, 9}}, 4);  // 9 / 4: two at a time, and one left over
  ASSERT_EQ(few.design.rows(), 4);
  EXPECT_EQ(few.design.period_s(0), 1.0);
  const Samples& means = few.design.samples()[0];
  EXPECT_NEAR(means[1].q1, 2.5, 1e-12);
  EXPECT_NEAR(means[1].tau, 25.0, 1e-12);
  EXPECT_NEAR(few.target[1], 2.5, 1e-12);
  EXPECT_TRUE(means[1].forward);
  EXPECT_NEAR(means[1].advance, 0.005, 1e-12);  // ways add up
  EXPECT_NEAR(means[1].advance_late, 0.010, 1e-12);
}

TEST(Thinned, NeverMakesMoreOfALog) {
  const LawDesign design({ramp(9)}, {0.5});
  const Thinned same = thinned(design, Eigen::VectorXd::LinSpaced(9, 0.0, 8.0), {{0, 9}}, 1000);
  ASSERT_EQ(same.design.rows(), 9);
  EXPECT_EQ(same.design.period_s(0), 0.5);
}

TEST(Thinned, TakesEachLogByItself) {
  const LawDesign design({ramp(5), ramp(4)}, {0.5, 0.5});
  Eigen::VectorXd target(9);
  target << 0, 1, 2, 3, 4, 100, 101, 102, 103;
  const Thinned few = thinned(design, target, {{0, 9}}, 4);
  ASSERT_EQ(few.design.rows(), 4);
  EXPECT_NEAR(few.target[1], 2.5, 1e-12);
  EXPECT_NEAR(few.target[2], 100.5, 1e-12);  // not 52
}

TEST(Thinned, BlocksAreThoseOfTheMeansThatTheyBeginAndEndIn) {
  const LawDesign design({ramp(20)}, {0.5});
  const Eigen::VectorXd target = Eigen::VectorXd::LinSpaced(20, 0.0, 19.0);
  const Thinned few = thinned(design, target, {{4, 9}, {10, 16}}, 5);  // 11 rows: two at a time
  ASSERT_EQ(few.design.rows(), 10);
  ASSERT_EQ(few.rows.size(), 2u);
  EXPECT_EQ(few.rows[0].begin, 2);
  EXPECT_EQ(few.rows[0].end, 4);  // the mean of rows 8 and 9 has one of another block in it
  EXPECT_EQ(few.rows[1].begin, 5);
  EXPECT_EQ(few.rows[1].end, 7);
  EXPECT_TRUE(thinned(design, target, {{4, 5}, {8, 9}}, 1).rows.empty());  // none holds a mean
}

TEST(LawDesignWithLines, StraightLinesJoinWhatIsBesideAndStayInTheirLog) {
  AxisLog log;
  log.period_s = 0.01;
  log.time_s = log.q1_rad = log.tau_nm = log.q2_rad = Eigen::VectorXd::LinSpaced(6, 0.0, 5.0);
  const LawDesign design({log, log}, ConditionerShape<double>{});
  Eigen::MatrixXd signals(12, 2);
  signals.col(0) << 0, 1, 9, 9, 4, 5, 9, 9, 2, 3, 4, 9;
  signals.col(1) = 10.0 * signals.col(0);
  const LawDesign lined = design.with_lines({{2, 4}, {6, 8}, {11, 12}});
  Eigen::VectorXd expected(12);
  expected << 0, 1, 2, 3, 4, 5, 2, 2, 2, 3, 4, 4;  // flat at the ends of a log
  EXPECT_NEAR((lined.lined(signals).col(0) - expected).norm(), 0.0, 1e-12);
  EXPECT_NEAR((lined.lined(signals).col(1) - 10.0 * expected).norm(), 0.0, 1e-12);
  EXPECT_EQ(design.lined(signals), signals);
  LawForm form;
  form.terms = {"motor_angle"};
  const Eigen::MatrixXd columns = law_columns(lined, form);
  EXPECT_EQ(columns, lined.lined(law_columns(design, form)));
  EXPECT_NE(columns, law_columns(design, form));
}

}  // namespace
}  // namespace capstan::tools
