// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/part_laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 1200;
const Shapes kNone = {};

/// An axis in a motion of two sines and its effort: viscous 0.3, dry 0.5, offset 0.2, noise.
auto made_log() -> AxisLog {
  AxisLog log;
  log.period_s = 0.01;
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(kRows, 0.0, 0.01 * (kRows - 1));
  log.time_s = t.matrix();
  log.q1_rad = (0.8 * (1.7 * t).sin() + 0.3 * (4.1 * t).sin()).matrix();
  const Eigen::ArrayXd speed = 1.36 * (1.7 * t).cos() + 1.23 * (4.1 * t).cos();
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  log.effort = (0.3 * speed + 0.5 * speed.sign() + 0.2).matrix();
  for (double& value : log.effort) {
    value += 0.02 * normal(engine);
  }
  log.tau_nm = Eigen::VectorXd::Zero(kRows);
  return log;
}

const std::vector<LawPart> kParts = {{"viscous_friction", {0}, {kNone}},
                                     {"coulomb_friction", {0}, {kNone}},
                                     {"offset", {0}, {kNone}},
                                     {"spring", {0}, {{0.0, 1.0}}},
                                     {"load_friction", {2}, {{0.0, 1.0}, {0.5, 1.0}, {1.0, 1.0}}, "spring"},
                                     {"friction_asymmetry", {0}, {kNone}},
                                     {"friction_asymmetry", {0, 1}, {kNone}},
                                     {"friction_asymmetry", {1}, {kNone}}};

struct Made {
  AxisLog log = made_log();
  EffortDesign design{{log}, {.window_s = 0.05, .standstill = 1e-6}};
  const Catalogue& catalogue = effort_law_catalogue(AxisKind::kRotary);
  PartProducts products{PartColumns(design, log.effort, catalogue, kParts), 1.0};
  EffortNumbers numbers;
  PartLaws laws{products, numbers};

  /// The columns of the first three parts, as the terms give them.
  [[nodiscard]] auto columns() const -> Eigen::MatrixXd {
    Eigen::MatrixXd x(kRows, 3);
    for (Eigen::Index i = 0; i < 3; ++i) {
      x.col(i) = design.columns(catalogue.term(kParts[static_cast<std::size_t>(i)].term), {}).col(0);
    }
    return x;
  }
};

const PartLaw kTruth = {{0, 0}, {1, 0}, {2, 0}};

TEST(PartProducts, FoldsAreSixSixthsLeftOutAndThreeLooksForward) {
  const Made made;
  const Eigen::MatrixXd x = made.columns();
  const Eigen::VectorXd& y = made.log.effort;
  const Eigen::VectorXd errors = made.products.fold_errors(kTruth, 0.0);
  ASSERT_EQ(errors.size(), 9);
  const auto error_of = [&](const std::vector<Eigen::Index>& fit, const std::vector<Eigen::Index>& check) {
    const Eigen::MatrixXd seen = x(fit, Eigen::all);
    const Eigen::VectorXd theta = seen.colPivHouseholderQr().solve(Eigen::VectorXd(y(fit)));
    return (y(check) - x(check, Eigen::all) * theta).squaredNorm() / static_cast<double>(check.size());
  };
  const auto rows = [](Eigen::Index begin, Eigen::Index end) {
    std::vector<Eigen::Index> list;
    for (Eigen::Index i = begin; i < end; ++i) {
      list.push_back(i);
    }
    return list;
  };
  const Eigen::Index block = kRows / 12;
  for (Eigen::Index fold = 0; fold < 6; ++fold) {
    auto fit = rows(0, 2 * fold * block);
    const auto behind = rows(2 * (fold + 1) * block, kRows);
    fit.insert(fit.end(), behind.begin(), behind.end());
    EXPECT_NEAR(errors[fold], error_of(fit, rows(2 * fold * block, 2 * (fold + 1) * block)), 1e-9) << fold;
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index known = (6 + 2 * i) * block;
    EXPECT_NEAR(errors[6 + i], error_of(rows(0, known), rows(known, known + 2 * block)), 1e-9) << i;
  }
}

TEST(PartProducts, CoefficientsAreThoseOfAllRowsInTheTermsUnits) {
  const Made made;
  const Eigen::VectorXd theta = made.products.coefficients(kTruth, 0.0);
  const Eigen::VectorXd expected = made.columns().colPivHouseholderQr().solve(made.log.effort);
  EXPECT_LT((theta - expected).norm(), 1e-9);
  EXPECT_NEAR(theta[0], 0.3, 0.01);
  EXPECT_NEAR(theta[1], 0.5, 0.01);
  EXPECT_NEAR(theta[2], 0.2, 0.01);
}

TEST(PartProducts, RowsBehindTheShareTakeNoPart) {
  Made made;
  Eigen::VectorXd target = made.log.effort;
  target.tail(kRows / 2).array() += 100.0;
  const PartProducts half(PartColumns(made.design, target, made.catalogue, kParts), 0.5);
  EXPECT_NEAR(half.coefficients(kTruth, 0.0)[2], 0.2, 0.02);
}

TEST(PartProducts, TheLargestShareIsThatOfAPartInTheEffort) {
  const Made made;
  const Eigen::MatrixXd x = made.columns();
  const Eigen::VectorXd theta = x.colPivHouseholderQr().solve(made.log.effort);
  const double dry = rms(theta[1] * x.col(1));
  EXPECT_NEAR(made.products.largest_share(kTruth, 0.0), dry / rms(made.log.effort), 1e-9);
  EXPECT_GT(dry, rms(theta[0] * x.col(0)));
  EXPECT_EQ(made.products.largest_share({}, 0.0), 0.0);
}

// A weight in the law of two of its angles is as large as the effort, wherever they are counted from; over a tenth
// of a radian a cosine alone is an offset.
TEST(PartLaws, AWeightFarLargerThanTheEffortIsNoPartOfALaw) {
  const std::vector<LawPart> parts = {{"offset", {0}, {kNone}}, {"gravity", {0, 1}, {kNone}}};
  const EffortNumbers numbers;
  const auto score = [&](double pull, double balanced) {
    AxisLog log = made_log();
    log.q1_rad *= 0.1;
    log.effort = (pull * log.q1_rad.array().sin() + balanced * (1.0 - log.q1_rad.array().cos())).matrix();
    log.q1_rad.array() += 1.0;
    const EffortDesign design({log}, {.window_s = 0.05, .standstill = 1e-6});
    const PartProducts products(PartColumns(design, log.effort, effort_law_catalogue(AxisKind::kRotary), parts), 1.0);
    PartLaws laws(products, numbers);
    EXPECT_TRUE(std::isfinite(laws.score({{0, 0}})));
    return laws.score({{0, 0}, {1, 0}});
  };
  EXPECT_TRUE(std::isfinite(score(100.0, 0.0)));
  EXPECT_FALSE(std::isfinite(score(0.0, 100.0)));
}

TEST(PartProducts, TheLawOfNothingLeavesTheTarget) {
  const Made made;
  const Eigen::VectorXd errors = made.products.fold_errors({}, 0.0);
  EXPECT_NEAR(errors[0], made.log.effort.head(kRows / 6).squaredNorm() / (kRows / 6.0), 1e-9);
}

TEST(PartLaws, TheScoreIsTheGeometricMeanOfMeanAndSingleFolds) {
  Made made;
  const Eigen::VectorXd errors = made.products.fold_errors(kTruth, made.numbers.ridge);
  double product = 1.0;
  for (const double error : errors) {
    product *= error;
  }
  EXPECT_NEAR(made.laws.score(kTruth), std::sqrt(errors.mean() * std::pow(product, 1.0 / 9.0)), 1e-12);
  EXPECT_LT(made.laws.score(kTruth), made.laws.score({{0, 0}, {1, 0}}));
}

/// Parts that additions() offers beside a law.
auto offered(const Made& made, const PartLaw& law) -> std::vector<std::size_t> {
  std::vector<std::size_t> parts;
  for (const auto& more : made.laws.additions(law)) {
    EXPECT_EQ(more.size(), law.size() + 1);
    parts.push_back(more.back().part);
  }
  return parts;
}

auto holds(const std::vector<std::size_t>& parts, std::size_t part) -> bool {
  return std::find(parts.begin(), parts.end(), part) != parts.end();
}

TEST(PartLaws, APartIsOfferedWhereItHelpsInMostFolds) {
  const Made made;
  const auto beside_drag = offered(made, {{0, 0}});
  EXPECT_TRUE(holds(beside_drag, 1));
  EXPECT_FALSE(holds(beside_drag, 0));  // it is there
  // Every fold may be asked for more than any part brings.
  Made strict;
  strict.numbers.folds_better = 1.1;
  EXPECT_TRUE(strict.laws.additions({{0, 0}}).empty());
}

TEST(PartLaws, FrictionOfALoadIsOfferedBesideTheLoadOnly) {
  Made made;
  made.numbers.folds_better = 0.0;
  EXPECT_FALSE(holds(offered(made, {{0, 0}}), 4));
  const auto beside_spring = offered(made, {{3, 0}});
  EXPECT_EQ(std::count(beside_spring.begin(), beside_spring.end(), 4u), 3);  // with each of its settings
}

TEST(PartLaws, TwoPartsOfOneTermGoTogetherWhereTheyShareNothing) {
  Made made;
  made.numbers.folds_better = 0.0;
  const auto beside_first = offered(made, {{5, 0}});
  EXPECT_FALSE(holds(beside_first, 5));
  EXPECT_FALSE(holds(beside_first, 6));  // has the same coefficient in it
  EXPECT_TRUE(holds(beside_first, 7));
  EXPECT_FALSE(holds(offered(made, {{3, 0}, {4, 0}}), 4));  // a term has one shape
}

TEST(PartLaws, NoLawHasMorePartsThanAllowed) {
  Made made;
  made.numbers.folds_better = 0.0;
  made.numbers.most_parts = 1;
  EXPECT_TRUE(made.laws.additions({{0, 0}}).empty());
}

TEST(PartLaws, OnePartLessUnlessItIsTheLast) {
  const Made made;
  const auto less = made.laws.reductions(kTruth);
  ASSERT_EQ(less.size(), 3u);
  EXPECT_EQ(less[1].size(), 2u);
  EXPECT_EQ(less[1][1].part, 2u);
  EXPECT_TRUE(made.laws.reductions({{0, 0}}).empty());
}

TEST(PartLaws, SettingsMoveToTheirNeighbours) {
  const Made made;
  const auto settings = [&](std::size_t setting) {
    std::vector<std::size_t> moved;
    for (const auto& law : made.laws.variations({{3, 0}, {4, setting}})) {
      moved.push_back(law[1].setting);
    }
    return moved;
  };
  EXPECT_EQ(settings(0), std::vector<std::size_t>{1});
  EXPECT_EQ(settings(1), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(settings(2), std::vector<std::size_t>{1});
}

TEST(PartLaws, GrowFromDragToTheTruth) {
  Made made;
  // Friction that differs by direction is an offset by another name, so it does not stand here.
  const PartProducts products(
      PartColumns(made.design, made.log.effort, made.catalogue, {kParts.begin(), kParts.begin() + 5}), 1.0);
  PartLaws laws(products, made.numbers);
  Grower<PartLaw> grower(laws, made.numbers.growth);
  const auto path = grower.run({{0, 0}});
  std::vector<std::size_t> parts;
  for (const auto& chosen : path.back().law) {
    parts.push_back(chosen.part);
  }
  std::sort(parts.begin(), parts.end());
  EXPECT_EQ(parts, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_NEAR(std::sqrt(path.back().score), 0.02, 0.005);
}

}  // namespace
}  // namespace capstan::tools
