// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/load_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 960;
constexpr double kFriction = 0.1;

/// A load on a joint that swings to and fro, and what the tendons make of it, by (2.16) and (2.18) written out: taut,
/// the load comes through one to one; beyond the friction F of the tendons one is slack, and the other passes the load
/// on by e^eta against the motion and by e^-eta with it.
struct Swing {
  double load = 0.05, eta = 0.5, elsewhere = 0.0, lean = 0.0, noise = 0.001, offset = 0.02;

  [[nodiscard]] auto rows() const -> LoadRows {
    LoadRows rows;
    rows.regressor.resize(kRows);
    rows.sense.resize(kRows);
    rows.change.resize(kRows);
    rows.lean.resize(lean != 0.0 ? kRows : 0);
    std::mt19937_64 engine(2);
    std::normal_distribution<double> normal(0.0, noise);
    for (Eigen::Index i = 0; i < kRows; ++i) {
      const double t = 0.05 * static_cast<double>(i);
      const double angle = 1.2 * std::sin(t);
      rows.regressor[i] = std::sin(angle);
      rows.sense[i] = std::cos(t) > 0.0 ? 1.0 : -1.0;
      if (lean != 0.0) {
        rows.lean[i] = std::cos(angle);
      }
      const double pull = load * (rows.regressor[i] + lean * std::cos(angle));
      const double tendons = kFriction - elsewhere;
      double torque = pull;
      if (rows.sense[i] * pull > 0.0) {  // against the motion
        torque = rows.sense[i] * std::max(rows.sense[i] * pull, std::abs(pull) * std::exp(eta) - tendons);
      } else {
        torque = rows.sense[i] * std::max(rows.sense[i] * pull, -std::abs(pull) * std::exp(-eta) - tendons);
      }
      rows.change[i] = torque + offset + normal(engine);
    }
    return rows;
  }
};

TEST(ToldLoad, ASmallLoadComesThroughOneToOne) {
  const Swing swing{.load = 0.03};
  const LoadAnswer answer = told_load(swing.rows(), kFriction, 0.03);
  EXPECT_NEAR(answer.load, 0.03, 0.0005);
  EXPECT_LT(answer.half_95, 0.003);
}

TEST(ToldLoad, ALoadThatMakesATendonSlackIsToldByWhatTheOtherPassesOn) {
  for (const double load : {0.2, 0.4}) {
    Swing swing;
    swing.load = load;
    const LoadRows rows = swing.rows();
    const double start = fitted(with_offset(rows.regressor), rows.change).theta[0];
    EXPECT_GT(std::abs(start - load), 0.02 * load);  // which a straight line does not know
    const LoadAnswer answer = told_load(rows, kFriction, start);
    EXPECT_NEAR(answer.load, load, 0.04 * load);
    EXPECT_GT(answer.half_95, 0.0);
  }
}

TEST(ToldLoad, AnotherFrictionBesideItIsNoLoad) {
  const Swing swing{.load = 0.3};
  LoadRows rows = swing.rows();
  rows.change += 0.05 * rows.sense;
  rows.other_friction = true;
  EXPECT_NEAR(told_load(rows, kFriction, 0.3).load, 0.3, 0.03);
}

TEST(ToldLoad, AWeightThatLeansIsFoundByItsLean) {
  Swing swing;
  swing.load = 0.2;
  swing.lean = 0.4;
  const LoadAnswer answer = told_load(swing.rows(), kFriction, 0.2);
  EXPECT_NEAR(answer.load, 0.2, 0.02);
  EXPECT_GE(answer.half_95, 0.2 * answer.load);  // how well a leaning weight is known
  LoadRows upright = Swing{.load = 0.2}.rows();
  upright.lean = swing.rows().lean;  // it might, and does not
  EXPECT_NEAR(told_load(upright, kFriction, 0.2).load, 0.2, 0.01);
}

TEST(Fitted, IsLeastSquaresAndAnOffsetBesideItCountsForNothing) {
  Eigen::VectorXd x(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    x[i] = std::sin(0.05 * static_cast<double>(i));
  }
  const Eigen::VectorXd y = (2.0 * x.array() + 7.0).matrix();
  const LinearFit fit = fitted(with_offset(x), y);
  EXPECT_NEAR(fit.theta[0], 2.0, 1e-9);
  EXPECT_NEAR(fit.theta[1], 7.0, 1e-9);
}

}  // namespace
}  // namespace capstan::tools
