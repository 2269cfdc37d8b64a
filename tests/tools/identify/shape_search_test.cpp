// SPDX-License-Identifier: Apache-2.0
// Searches of shapes against dense scans that know nothing of them: formulas and normal equations written down here.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 400;
constexpr double kPeriodS = 0.025;

/// Least sum of squares that columns leave of a target, no coefficient below zero: of all subsets the best that obeys.
auto squares_left(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) -> double {
  double least = target.squaredNorm();
  for (unsigned subset = 1; subset < (1U << static_cast<unsigned>(columns.cols())); ++subset) {
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      if ((subset >> static_cast<unsigned>(i) & 1U) != 0U) {
        chosen.push_back(i);
      }
    }
    const Eigen::MatrixXd x = columns(Eigen::all, chosen);
    const Eigen::VectorXd theta = (x.transpose() * x).inverse() * (x.transpose() * target);
    if (theta.minCoeff() >= 0.0) {
      least = std::min(least, (target - x * theta).squaredNorm());
    }
  }
  return least;
}

auto relaxation(double time_s) -> Eigen::VectorXd {
  return Eigen::ArrayXd::LinSpaced(kRows, 0.0, kPeriodS * (kRows - 1)).unaryExpr([&](double t) {
    return std::exp(-t / time_s);
  });
}

constexpr double kFast[] = {0.05, 2.0};  // ranges of the two time constants, s
constexpr double kSlow[] = {0.5, 50.0};

auto relaxation_term(const char* name, const double (&range)[2], const std::shared_ptr<int>& asked) -> CatalogueTerm {
  CatalogueTerm term;
  term.name = name;
  term.coefficients = {{"height", "rad", Sign::kNonNegative, ""}};
  term.shapes = {{"time", "s", range[0], range[1], range[1], ""}};
  term.columns = [asked](const Samples& /*samples*/, double /*period_s*/, const Shapes& shapes) {
    ++*asked;
    return Eigen::MatrixXd(relaxation(shapes[0]));
  };
  return term;
}

struct Scanned {
  double fast, slow, squares;
};

/// Best of 80 x 80 pairs over the ranges, then three times over a tenth of what was searched around the best.
auto scan(const Eigen::VectorXd& target) -> Scanned {
  constexpr int kPlaces = 80;
  Scanned best{0.0, 0.0, target.squaredNorm() * 2.0};
  double low[] = {std::log(kFast[0]), std::log(kSlow[0])};
  double high[] = {std::log(kFast[1]), std::log(kSlow[1])};
  for (int zoom = 0; zoom < 4; ++zoom) {
    for (int i = 0; i <= kPlaces; ++i) {
      Eigen::MatrixXd columns(kRows, 2);
      const double fast = std::exp(low[0] + (high[0] - low[0]) * i / kPlaces);
      columns.col(0) = relaxation(fast);
      for (int k = 0; k <= kPlaces; ++k) {
        const double slow = std::exp(low[1] + (high[1] - low[1]) * k / kPlaces);
        columns.col(1) = relaxation(slow);
        const double squares = squares_left(columns, target);
        best = squares < best.squares ? Scanned{fast, slow, squares} : best;
      }
    }
    const double reach[] = {0.05 * (high[0] - low[0]), 0.05 * (high[1] - low[1])};
    low[0] = std::max(std::log(kFast[0]), std::log(best.fast) - reach[0]);
    high[0] = std::min(std::log(kFast[1]), std::log(best.fast) + reach[0]);
    low[1] = std::max(std::log(kSlow[0]), std::log(best.slow) - reach[1]);
    high[1] = std::min(std::log(kSlow[1]), std::log(best.slow) + reach[1]);
  }
  return best;
}

auto log_of_rows(Eigen::Index rows, double period_s) -> AxisLog {
  AxisLog log;
  log.period_s = period_s;
  log.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, period_s * static_cast<double>(rows - 1));
  return log;
}

struct Searched {
  double fast, slow, squares;
  int asked;
};

auto search(const Eigen::VectorXd& target) -> Searched {
  const auto asked = std::make_shared<int>(0);
  const Catalogue catalogue(TargetKind::kAngle, "rad", "rad",
                            {relaxation_term("fast", kFast, asked), relaxation_term("slow", kSlow, asked)});
  LawForm form{&catalogue, {"fast", "slow"}, catalogue.initial_shapes()};
  const LawDesign design({log_of_rows(kRows, kPeriodS)}, {Samples(kRows)});
  const Blocks blocks = even_blocks(design.log_rows(), 2);
  form = search_shapes(design, target, blocks, form);
  const int evaluations = *asked / 2;
  return {form.shapes[0], form.shapes[1], std::pow(fit_law(design, target, blocks, form).rmse, 2.0) * kRows,
          evaluations};
}

auto noisy(const Eigen::VectorXd& clean) -> Eigen::VectorXd {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.01);
  return clean.unaryExpr([&](double value) { return value + normal(random); });
}

void expect_at_the_optimum(const Searched& found, const Scanned& scanned) {
  EXPECT_LE(found.squares, scanned.squares * (1.0 + 1e-6));
  EXPECT_NEAR(std::log(found.fast / scanned.fast), 0.0, 2e-3);
  EXPECT_LE(found.asked, 260);  // laws worked out: 24 starts and five descents
}

TEST(SearchShapes, TwoShapesAtOnceEndAtTheOptimumOfADenseScan) {
  const Eigen::VectorXd target = noisy(relaxation(0.3) + 0.7 * relaxation(4.0));
  const Searched found = search(target);
  const Scanned scanned = scan(target);
  expect_at_the_optimum(found, scanned);
  EXPECT_NEAR(std::log(found.slow / scanned.slow), 0.0, 2e-3);
  EXPECT_NEAR(found.fast, 0.3, 0.03);  // the scan itself is where it should be
}

TEST(SearchShapes, AShapeBeyondItsRangeEndsAtTheLimitAndTheOtherAtTheOptimumThere) {
  const Eigen::VectorXd target = noisy(relaxation(0.02) + 0.7 * relaxation(1.0));
  const Searched found = search(target);
  const Scanned scanned = scan(target);
  expect_at_the_optimum(found, scanned);
  EXPECT_DOUBLE_EQ(found.fast, kFast[0]);
  EXPECT_NEAR(std::log(found.slow / scanned.slow), 0.0, 2e-3);
}

TEST(SearchShapes, ACoefficientHeldAtZeroLeavesTheOtherShapeAtItsOptimum) {
  const Eigen::VectorXd target = noisy(relaxation(0.3) - 0.7 * relaxation(20.0));
  expect_at_the_optimum(search(target), scan(target));
}

/// Joint behind a gap, motor seen through a coarse encoder: as the width grows the error changes in steps.
TEST(SearchShapes, AGapBehindACoarseEncoderEndsNextToTheBestOfADenseScan) {
  constexpr Eigen::Index kSamples = 4000;
  constexpr double kStep = 0.004;
  constexpr double kHalfGap = 0.021;
  AxisLog log = log_of_rows(kSamples, 0.01);
  Samples samples(kSamples);
  const auto follow = [&](double half_width, const auto& motor) {
    Eigen::VectorXd follower(kSamples);
    double p = motor(0);
    for (Eigen::Index i = 0; i < kSamples; ++i) {
      p = std::min(std::max(p, motor(i) - half_width), motor(i) + half_width);
      follower[i] = p;
    }
    return follower;
  };
  const auto motor = [&](Eigen::Index i) {
    const double t = log.time_s[i];
    return 0.4 * std::sin(0.7 * t) + 0.2 * std::sin(1.9 * t + 1.0);
  };
  const auto seen = [&](Eigen::Index i) { return kStep * std::round(motor(i) / kStep); };
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0.0, 2e-4);
  Eigen::VectorXd target = follow(kHalfGap, motor);
  for (double& value : target) {
    value = 0.02 + 1.1 * value + normal(random);
  }
  Eigen::MatrixXd columns(kSamples, 3);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    samples[static_cast<std::size_t>(i)].q1 = samples[static_cast<std::size_t>(i)].h = seen(i);
    columns.row(i) << seen(i), 1.0, 0.0;
  }
  double least = target.squaredNorm();
  double best = 0.0;
  for (double width = 0.002; width < 0.2; width *= 1.002) {
    columns.col(2) = follow(width, seen);
    const double left = squares_left(columns, target);
    best = left < least ? width : best;
    least = std::min(least, left);
  }
  LawForm form;
  form.terms = {"motor_angle", "joint_offset", "play"};
  const LawDesign design({log}, {samples});
  const Blocks blocks = even_blocks(design.log_rows(), 2);
  form = search_shapes(design, target, blocks, form);
  EXPECT_LE(std::pow(fit_law(design, target, blocks, form).rmse, 2.0) * kSamples, least * 1.001);
  EXPECT_NEAR(form.shapes_of(catalogue_term("play"))[0], best, 0.02 * best);
  EXPECT_NEAR(best, kHalfGap, 0.1 * kHalfGap);
}

/// A noisy motor angle, interpolated between samples, is quietest halfway: a valley in each sample.
TEST(RefineShapes, ADelayIsFoundFromTheNextSampleButOne) {
  constexpr Eigen::Index kSamples = 5000;
  constexpr double kPeriod = 0.001;
  AxisLog log = log_of_rows(kSamples, kPeriod);
  Samples samples(kSamples);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 8e-4);
  Eigen::VectorXd seen(kSamples);
  Eigen::VectorXd target(kSamples);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    seen[i] = 0.3 * std::sin(4.0 * log.time_s[i]) + normal(random);
    samples[static_cast<std::size_t>(i)].q1 = samples[static_cast<std::size_t>(i)].h = seen[i];
    target[i] = 0.33 * std::sin(4.0 * (log.time_s[i] - 1.4 * kPeriod));
  }
  double least = target.squaredNorm();
  double best = 0.0;
  Eigen::MatrixXd columns(kSamples, 2);
  for (double delay = 0.0; delay < 6.0; delay += 0.002) {  // samples
    for (Eigen::Index i = 0; i < kSamples; ++i) {
      const auto whole = static_cast<Eigen::Index>(delay);
      const double share = delay - static_cast<double>(whole);
      columns.row(i) << (1.0 - share) * seen[std::max<Eigen::Index>(0, i - whole)] +
                            share * seen[std::max<Eigen::Index>(0, i - whole - 1)],
          1.0;
    }
    const double left = squares_left(columns, target);
    best = left < least ? delay : best;
    least = std::min(least, left);
  }
  LawForm form;
  form.terms = {"motor_angle", "joint_offset", "transport_delay"};
  const LawDesign design({log}, {samples});
  for (const double start : {0.0, 0.4, 1.6, 2.5, 3.2, 8.0}) {
    form.set_shapes(catalogue_term("transport_delay"), {start * kPeriod});
    const LawForm found = refine_shapes(design, target, even_blocks(design.log_rows(), 2), form);
    EXPECT_NEAR(found.shapes_of(catalogue_term("transport_delay"))[0], best * kPeriod, 0.004 * kPeriod) << start;
  }
}

}  // namespace
}  // namespace capstan::tools
