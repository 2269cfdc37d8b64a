// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/forward_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/model/terms/table.hpp"
#include "capstan/tests/tools/select/small_selection.hpp"

namespace capstan::tools {
namespace {

using test::few_parts;
using test::law_of;
using test::normals;
using test::play_of;
using test::SmallSelection;
using test::two_sines;

constexpr Eigen::Index kRows = 400;

const LawCandidate kRatio = test::ratio_law();

/// What a least squares fit of the columns to some rows leaves of others.
auto left_of(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const std::vector<Eigen::Index>& fit,
             const std::vector<Eigen::Index>& judge) -> Eigen::VectorXd {
  const Eigen::MatrixXd seen = x(fit, Eigen::all);
  const Eigen::VectorXd theta = seen.colPivHouseholderQr().solve(Eigen::VectorXd(y(fit)));
  return y(judge) - x(judge, Eigen::all) * theta;
}

auto rows_between(Eigen::Index begin, Eigen::Index end) -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = begin; i < end; ++i) {
    rows.push_back(i);
  }
  return rows;
}

/// Forward: the third part by the first two, the fourth by the first three. Left out: each half by the other.
auto score_by_hand(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) -> double {
  const Eigen::Index part = y.size() / 4;
  double forward = 0.0;
  for (const Eigen::Index first : {2, 3}) {
    forward +=
        left_of(x, y, rows_between(0, first * part), rows_between(first * part, (first + 1) * part)).squaredNorm();
  }
  const double left_out = left_of(x, y, rows_between(2 * part, 4 * part), rows_between(0, 2 * part)).squaredNorm() +
                          left_of(x, y, rows_between(0, 2 * part), rows_between(2 * part, 4 * part)).squaredNorm();
  return 0.5 * (forward / static_cast<double>(2 * part) + left_out / static_cast<double>(4 * part));
}

TEST(ForwardScore, IsTheMeanOfWhatComesAfterAndWhatIsLeftOut) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Eigen::VectorXd y = 0.8 * q1 + 0.1 * q1.cwiseAbs2() + 0.05 * normals(kRows, 1, 1);
  SmallSelection small(q1, y);
  Eigen::MatrixXd x(kRows, 2);
  x << q1, Eigen::VectorXd::Ones(kRows);
  EXPECT_NEAR(small.forward.score(kRatio), score_by_hand(x, y), 1e-9);
  EXPECT_EQ(small.forward.score(kRatio), small.forward.score(kRatio));
}

TEST(ForwardScore, ThePlaysOfALawAreColumnsBesideTheRatio) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Eigen::VectorXd play = play_of(q1, 0.3);
  const Eigen::VectorXd y = 0.6 * q1 + 0.2 * play + 0.05 * normals(kRows, 1, 2);
  DecidingNumbers numbers = few_parts();
  numbers.ridge = 1e-12;
  SmallSelection small(q1, y, numbers);
  Eigen::MatrixXd x(kRows, 3);
  x << q1, Eigen::VectorXd::Ones(kRows), play - q1;
  const LawCandidate law = with_play(kRatio, 0.3);
  EXPECT_NEAR(small.forward.score(law), score_by_hand(x, y), 1e-6);
  const FittedCandidate fitted = small.forward.fitted(law);
  EXPECT_TRUE(fitted.valid);
  EXPECT_NEAR(fitted.theta[0], 0.8, 0.02);         // as far as both go together
  EXPECT_NEAR(fitted.play_weights[0], 0.2, 0.02);  // c of beta q1 + c (P - q1)
  EXPECT_NEAR(fitted.mean_square, 0.0025, 0.0004);
}

TEST(ForwardScore, LossesAreThoseOfEachPieceOfTheJudgedParts) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Eigen::VectorXd y = 0.8 * q1 + 0.05 * normals(kRows, 1, 3);
  SmallSelection small(q1, y);
  Eigen::MatrixXd x(kRows, 2);
  x << q1, Eigen::VectorXd::Ones(kRows);
  const Eigen::VectorXd losses = small.forward.losses(kRatio);
  ASSERT_EQ(losses.size(), 4);  // two parts of two pieces
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Index known = i < 2 ? 200 : 300;
    const Eigen::VectorXd left = left_of(x, y, rows_between(0, known), rows_between(200 + 50 * i, 250 + 50 * i));
    EXPECT_NEAR(losses[i], left.squaredNorm() / 50.0, 1e-9) << i;
  }
}

TEST(ForwardScore, OfALogThatIsTooShortForItsPiecesAreNothing) {
  const Eigen::VectorXd q1 = two_sines(6);
  SmallSelection small(q1, q1);
  EXPECT_EQ(small.forward.losses(kRatio).size(), 4);
  EXPECT_EQ(small.forward.losses(kRatio)[0], 0.0);
}

TEST(ForwardScore, WithoutRowsThereIsNoLaw) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  SmallSelection small(q1, q1);
  ForwardScore nowhere(small.data, {});
  EXPECT_EQ(nowhere.score(kRatio), std::numeric_limits<double>::infinity());
  EXPECT_EQ(nowhere.fitted(kRatio).mean_square, 0.0);
}

TEST(ForwardScore, EachLogHasAZeroOfItsOwnAndTheLawTheirMean) {
  const Eigen::VectorXd q1 = two_sines(200);
  Eigen::VectorXd target(400);
  target << 0.8 * q1, (0.8 * q1).array() + 0.6;
  const Preparation p = test::preparation_of_both(q1, q1, target);
  SelectionData data(p, term_catalogue(), few_parts());
  ForwardScore forward(data, data.logs());
  EXPECT_NEAR(forward.score(kRatio), 0.0, 1e-15);
  const FittedCandidate fitted = forward.fitted(kRatio);
  EXPECT_NEAR(fitted.theta[0], 0.8, 1e-9);
  EXPECT_NEAR(fitted.theta[1], 0.3, 1e-9);
}

TEST(ForwardScore, APlayWhoseWeightNoInputStageHoldsIsNoLaw) {
  // The joint follows a play alone, against the ratio: its weight is many times beta.
  const Eigen::VectorXd q1 = two_sines(kRows);
  SmallSelection small(q1, play_of(q1, 0.3) - 0.99 * q1);
  const LawCandidate law = with_play(kRatio, 0.3);
  EXPECT_EQ(small.forward.score(law), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(small.forward.fitted(law).valid);
  EXPECT_TRUE(std::isfinite(small.forward.score(kRatio)));
}

TEST(ForwardScore, PlaysBehindARatioOfNothingAreNoLaw) {
  // The joint stands: whatever the plays do has no weight against the ratio.
  SmallSelection small(two_sines(kRows), Eigen::VectorXd::Zero(kRows));
  const LawCandidate law = law_of({{"motor_angle", {}}, {"curved_ratio", {0.0, 1.0}}}, {0.3});
  EXPECT_EQ(small.forward.score(law), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(small.forward.fitted(law).valid);
}

TEST(ForwardScore, ALimitHoldsUnlessTheBaseLawIsBeyondIt) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  const LawCandidate curved = law_of({{"motor_angle", {}}, {"curved_ratio", {0.0, 1.0}}});
  SmallSelection large(q1, 300.0 * q1);
  large.forward.limit_as(kRatio);  // 300 is in no joint file: then the unit is not a board's
  EXPECT_TRUE(std::isfinite(large.forward.score(curved)));
  SmallSelection curve(q1, q1 + 300.0 * q1.cwiseAbs2());
  EXPECT_TRUE(std::isfinite(curve.forward.score(curved)));
  curve.forward.limit_as(law_of({{"joint_offset", {}}}));
  EXPECT_TRUE(std::isfinite(curve.forward.score(curved)));  // the offset is beyond it too
  SmallSelection even(two_sines(kRows), q1 + 300.0 * (q1.cwiseAbs2().array() - q1.cwiseAbs2().mean()).matrix());
  even.forward.limit_as(law_of({{"joint_offset", {}}}));
  EXPECT_EQ(even.forward.score(curved), std::numeric_limits<double>::infinity());
}

TEST(ForwardScore, ACurveIsDrawnOverWhatComesOutOfThePlays) {
  // h = 0.5 q1 + 0.5 play(q1, 0.4), q2 = h + 0.2 h^2.
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Eigen::VectorXd h = 0.5 * q1 + 0.5 * play_of(q1, 0.4);
  const Eigen::VectorXd y = h + 0.2 * h.cwiseAbs2();
  SmallSelection small(q1, y);
  const LawCandidate law = law_of({{"motor_angle", {}}, {"joint_offset", {}}, {"curved_ratio", {0.0, 1.0}}}, {0.4});
  EXPECT_LT(std::sqrt(small.forward.score(law)), 0.01);
  EXPECT_GT(std::sqrt(small.forward.score(with_play(kRatio, 0.4))), 0.05);
  const FittedCandidate fitted = small.forward.fitted(law);
  ASSERT_TRUE(fitted.valid);
  EXPECT_NEAR(fitted.play_weights[0] / fitted.theta[0], 0.5, 0.03);
  const Shapes& placed = fitted.law.find("curved_ratio")->shapes;  // centre and half of what the plays let through
  EXPECT_NEAR(placed[0], 0.5 * (h.maxCoeff() + h.minCoeff()), 0.02);
  EXPECT_NEAR(placed[1], 0.5 * (h.maxCoeff() - h.minCoeff()), 0.02);
  EXPECT_NEAR(small.forward.losses(law).mean(), 0.0, 1e-4);
}

/// {signal, knots, low, high, factor}
auto table_over(TableSignal signal, double knots, double low, double high) -> TermChoice {
  return {"table", {static_cast<double>(signal), knots, low, high, 0.0}};
}

TEST(ForwardScore, ATableOverTheMotorAngleBendsWithoutPlays) {
  // A roof over the motor angle: straight lines between knots at the ends and the middle.
  const Eigen::VectorXd q1 = two_sines(kRows);
  const double end = std::max(q1.maxCoeff(), -q1.minCoeff());
  const Eigen::VectorXd y = 0.7 * q1 + 0.3 * q1.cwiseAbs();
  SmallSelection small(q1, y);
  TermChoice table = table_over(TableSignal::kMotorAngle, 17.0, -end, end);
  const LawCandidate law = law_of({{"motor_angle", {}}, {"joint_offset", {}}, table});
  EXPECT_LT(std::sqrt(small.forward.score(law)), 0.03);
  EXPECT_GT(std::sqrt(small.forward.score(kRatio)), 0.08);
  // Values of one direction alone say the same twice.
  table.by_direction = true;
  EXPECT_LT(std::sqrt(small.forward.score(law_of({{"motor_angle", {}}, {"joint_offset", {}}, table}))), 0.03);
  const FittedCandidate fitted = small.forward.fitted(law);
  EXPECT_NEAR(fitted.theta.segment(2, 17).maxCoeff(), fitted.theta.segment(2 + 17, 17).maxCoeff(), 1e-12);
}

TEST(ForwardScore, ATableOverTorqueDoesNotMindPlays) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  Samples samples = test::samples_of(q1);
  Eigen::VectorXd y = 0.6 * q1 + 0.2 * play_of(q1, 0.3);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double tau = std::sin(0.37 * static_cast<double>(i));
    samples[static_cast<std::size_t>(i)].tau = tau;
    y[i] += 0.1 * std::abs(tau);
  }
  SmallSelection small(samples, y);
  const TermChoice table = table_over(TableSignal::kTorque, 17.0, -1.0, 1.0);
  const LawCandidate law = law_of({{"motor_angle", {}}, {"joint_offset", {}}, table}, {0.3});
  EXPECT_LT(std::sqrt(small.forward.score(law)), 0.01);
  EXPECT_GT(std::sqrt(small.forward.score(with_play(kRatio, 0.3))), 0.02);
  const FittedCandidate fitted = small.forward.fitted(law);
  EXPECT_NEAR(fitted.play_weights[0], 0.2, 0.02);
  EXPECT_EQ(fitted.law.find("table")->shapes[3], 1.0);  // where it was laid, not where the plays reach
}

TEST(ForwardScore, ATableBehindPlaysReachesAsFarAsTheirOutput) {
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Eigen::VectorXd h = 0.5 * q1 + 0.5 * play_of(q1, 0.4);
  SmallSelection small(q1, h + 0.3 * h.cwiseAbs());
  const LawCandidate law =
      law_of({{"motor_angle", {}}, {"joint_offset", {}}, table_over(TableSignal::kMotorAngle, 9.0, -9.0, 9.0)}, {0.4});
  const FittedCandidate fitted = small.forward.fitted(law);
  EXPECT_NEAR(fitted.law.find("table")->shapes[2], h.minCoeff(), 0.05);
  EXPECT_NEAR(fitted.law.find("table")->shapes[3], h.maxCoeff(), 0.05);
  EXPECT_LT(std::sqrt(small.forward.score(law)), 0.05);
}

TEST(ForwardScore, ADelayActsOnEverythingInTheSum) {
  // The joint a sample of 1 s late behind ratio, play and curve.
  const Eigen::VectorXd q1 = two_sines(kRows);
  const Eigen::VectorXd sum = 0.6 * q1 + 0.2 * play_of(q1, 0.3);
  Eigen::VectorXd y = sum;
  y.tail(kRows - 1) = sum.head(kRows - 1).eval();
  SmallSelection small(q1, y);
  const LawCandidate prompt = with_play(kRatio, 0.3);
  const LawCandidate late = with_term(term_catalogue(), prompt, {"transport_delay", {1.0}});
  EXPECT_LT(std::sqrt(small.forward.score(late)), 0.2 * std::sqrt(small.forward.score(prompt)));
  const TermChoice curve{"curved_ratio", {0.0, 1.0}};
  EXPECT_TRUE(std::isfinite(small.forward.score(with_term(term_catalogue(), late, curve))));
}

}  // namespace
}  // namespace capstan::tools
