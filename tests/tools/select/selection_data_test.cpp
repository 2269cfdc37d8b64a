// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/selection_data.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/select/small_selection.hpp"

namespace capstan::tools {
namespace {

using test::few_parts;
using test::samples_of;
using test::SmallSelection;
using test::two_sines;

TEST(SelectionData, ACoarseRowIsTheMeanOfItsSamplesAndTheDirectionOfMost) {
  Samples samples(6);
  for (std::size_t i = 0; i < 6; ++i) {
    samples[i].q1 = samples[i].h = static_cast<double>(i * i);  // 0 1 4 | 9 16 25
    samples[i].tau = 2.0 * static_cast<double>(i);
    samples[i].forward = i == 1 || i > 3;  // one of three, two of three
    samples[i].warmth = i < 3 ? 1.0 : 4.0;
    samples[i].others[1].q1 = static_cast<double>(i);
  }
  Preparation p = test::preparation_of(samples, Eigen::VectorXd::LinSpaced(6, 0.0, 5.0), {});
  p.factor = 3;
  p.coarse_period_s = 3.0;
  SelectionData data(p, term_catalogue(), few_parts());
  ASSERT_EQ(data.rows(), 2);
  EXPECT_NEAR(data.q1()[0], 5.0 / 3.0, 1e-12);
  EXPECT_NEAR(data.q1()[1], 50.0 / 3.0, 1e-12);
  EXPECT_NEAR(data.target()[1], 4.0, 1e-12);
  const SignalRanges& ranges = data.ranges();
  EXPECT_NEAR(ranges.q1, 15.0, 1e-12);
  EXPECT_NEAR(ranges.q1_centre, 55.0 / 6.0, 1e-12);
  EXPECT_NEAR(ranges.tau, 6.0, 1e-12);  // 2 and 8
  EXPECT_NEAR(ranges.tau_centre, 5.0, 1e-12);
  EXPECT_NEAR(ranges.warmth, 3.0, 1e-12);
  EXPECT_NEAR(ranges.others[1], 3.0, 1e-12);
  EXPECT_NEAR(ranges.others[0], 0.0, 1e-12);
  EXPECT_NEAR(ranges.length_s, 6.0, 1e-12);
  EXPECT_NEAR(ranges.period_s, 1.0, 1e-12);
  // The ratio without memory, at given angles.
  const Eigen::MatrixXd columns = data.columns_at({"motor_angle", {}}, Eigen::Vector2d(7.0, 8.0));
  EXPECT_NEAR(columns(1, 0), 8.0, 1e-12);
  // Elongation by direction: the first row goes backward with a torque of 2, the second forward with 8.
  const Eigen::MatrixXd by_direction = data.columns_at({"tendon_elongation", {}}, Eigen::Vector2d(7.0, 8.0));
  EXPECT_NEAR(by_direction(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(by_direction(0, 1), 2.0, 1e-12);
  EXPECT_NEAR(by_direction(1, 0), 8.0, 1e-12);
  EXPECT_NEAR(by_direction(1, 1), 0.0, 1e-12);
}

TEST(SelectionData, RangesOfTheTimeAndWaySinceAReversal) {
  // Strokes of ten rows of 0.1 rad each: nine rows behind a turn at most.
  Samples samples(100);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t in_stroke = i % 20;
    samples[i].q1 = samples[i].h = 0.1 * static_cast<double>(in_stroke < 10 ? in_stroke : 20 - in_stroke);
    samples[i].forward = in_stroke < 10;
    samples[i].q1_reversal = samples[i].forward ? 0.0 : 1.0;
    samples[i].dq1 = samples[i].forward ? 0.1 : -0.1;
  }
  const SmallSelection small(samples, Eigen::VectorXd::Zero(100));
  EXPECT_NEAR(small.data.ranges().since_s, 9.0, 1e-12);
  EXPECT_NEAR(small.data.ranges().travelled, 0.9, 1e-12);
  EXPECT_NEAR(small.data.ranges().rate, 0.2, 1e-12);
  EXPECT_NEAR(small.data.ranges().rate_centre, 0.0, 1e-12);
}

TEST(SelectionData, ColumnsAreThoseOfTheTermAndThroughTheOutputTermOfTheLaw) {
  const Eigen::VectorXd q1 = two_sines(200);
  SmallSelection small(q1, q1);
  EXPECT_LT((small.data.columns({"motor_angle", {}}, nullptr).col(0) - q1).norm(), 1e-12);
  const TermChoice late{"transport_delay", {1.0}};  // a sample
  const Eigen::VectorXd through = small.data.columns({"motor_angle", {}}, &late).col(0);
  EXPECT_LT((through.tail(198) - q1.segment(1, 198)).norm(), 1e-9);
  // The one is not taken for the other when it is asked for again.
  EXPECT_LT((small.data.columns({"motor_angle", {}}, nullptr).col(0) - q1).norm(), 1e-12);
}

TEST(SelectionData, APlayIsTriedWhereTheMotionTurnsItRound) {
  // Plays of a sine turn up to its amplitude, the widest by a hundredth of its range.
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(1000, 0.0, 40.0);
  DecidingNumbers numbers = few_parts();
  const auto widths = [&](double way_of_a_turn) {
    numbers.way_of_a_turn = way_of_a_turn;
    SmallSelection small((t.sin()).matrix(), Eigen::VectorXd::Zero(1000), numbers);
    return small.data.play_widths();
  };
  ASSERT_EQ(widths(0.005).size(), numbers.play_widths);
  EXPECT_NEAR(widths(0.005).front(), 2.0 / 200.0, 1e-3);
  EXPECT_NEAR(widths(0.005).back(), 2.0 / 2.02, 1e-3);
  EXPECT_EQ(widths(0.02).size(), numbers.play_widths - 1);
  EXPECT_EQ(widths(0.02).back(), widths(0.005)[numbers.play_widths - 2]);
  // A motor that goes one way only turns none.
  SmallSelection one_way(Eigen::VectorXd::LinSpaced(1000, 0.0, 1.0), Eigen::VectorXd::Zero(1000));
  EXPECT_TRUE(one_way.data.play_widths().empty());
  // Nor does one that stands.
  SmallSelection still(Eigen::VectorXd::Constant(100, 0.3), Eigen::VectorXd::Zero(100));
  EXPECT_TRUE(still.data.play_widths().empty());
}

TEST(SelectionData, ALawThatReadsTheJointSeesTheEstimateOfTheCycleBefore) {
  const Eigen::VectorXd q1 = two_sines(50);
  const Eigen::VectorXd estimate = Eigen::VectorXd::LinSpaced(100, 0.5, 1.5);
  Samples both = samples_of(q1);
  both.resize(100);  // the second log is as long; its samples come below
  Preparation p = test::preparation_of(both, Eigen::VectorXd::Zero(100), {});
  p.logs.front().time_s.conservativeResize(50);
  p.logs.push_back(p.logs.front());
  p.causal = LawDesign(p.logs, {samples_of(q1), samples_of(q1)});
  SelectionData data(p, term_catalogue(), few_parts(), estimate);
  const Eigen::VectorXd gravity = data.columns({"gravity", {}}, nullptr).col(0);
  const auto sine_or_cosine = [&](Eigen::Index row, Eigen::Index seen) {
    return std::abs(gravity[row] - std::sin(estimate[seen])) < 1e-9 ||
           std::abs(gravity[row] - std::cos(estimate[seen])) < 1e-9;
  };
  EXPECT_TRUE(sine_or_cosine(0, 0));
  EXPECT_TRUE(sine_or_cosine(20, 19));
  EXPECT_TRUE(sine_or_cosine(50, 50));  // the second log begins with its own
  EXPECT_TRUE(sine_or_cosine(51, 50));
}

}  // namespace
}  // namespace capstan::tools
