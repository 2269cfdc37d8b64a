// SPDX-License-Identifier: Apache-2.0
// The board's own palpation where nothing can be said, and over all that it may be given.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/run/tissues.hpp"

namespace capstan::tools {
namespace {

using test::felt_by_board;
using test::on_board;
using test::servo_log;
using test::torque_log;

class PalpationOfBoard : public testing::Test {
 protected:
  static void SetUpTestSuite() { parameters_ = test::calibrated(760000); }
  inline static TensionStateParameters<double> parameters_;
};

TEST_F(PalpationOfBoard, FreeAndLockedTipsHaveNoStiffness) {
  sim::PlantParameters p;
  const auto free = felt_by_board(servo_log(p, 10.0, 0.2, 0.15, 0.2, 760001), parameters_);
  EXPECT_LT(free.value_or(Stiffness{}).value, 0.01);
  p.environment.kind = sim::EnvironmentKind::kLocked;
  const auto locked = felt_by_board(torque_log(p, 10.0, 0.2, 0.2, 760002), parameters_);
  EXPECT_FALSE(locked.has_value() && locked->half_interval < 0.5 * locked->value)
      << locked->value << " +- " << locked->half_interval << ": stiffer than the instrument can tell";
}

TEST_F(PalpationOfBoard, OneStrokeInAnswersWithTheDoubtOfAResistanceThatItCouldNotSee) {
  sim::PlantParameters p;
  p.environment = test::tissue(760003);
  const AxisLog whole = servo_log(p, 10.0, 0.2, 0.15, 0.2, 760003);
  AxisLog in = whole;
  constexpr Eigen::Index kEnd = 6250;  // the second stroke in has come to its end, and none out is whole
  constexpr Eigen::Index kBegin = 3750;
  for (auto* values : {&in.time_s, &in.q1_rad, &in.tau_nm, &in.effort}) {
    *values = values->segment(kBegin, kEnd - kBegin).eval();
  }
  const auto both = felt_by_board(whole, parameters_);
  const auto one = felt_by_board(in, parameters_);
  ASSERT_TRUE(both.has_value());
  ASSERT_TRUE(one.has_value());
  EXPECT_GT(one->half_interval, 1.5 * both->half_interval);
  EXPECT_NEAR(one->value, p.environment.deep_stiffness, one->half_interval);
}

TEST_F(PalpationOfBoard, ASiteBeginsWithoutAnythingOfTheLastOne) {
  sim::PlantParameters p;
  p.environment = test::tissue(760004);
  const AxisLog log = servo_log(p, 10.0, 0.2, 0.15, 0.2, 760004);
  const Q24 amplitude = Q24::from_double(log.tau_nm.cwiseAbs().maxCoeff());
  Palpation palpation;
  for (int site = 1; site <= 2; ++site) {
    palpation.begin(on_board(parameters_), {.site = site, .largest_nm = amplitude});
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      palpation.add(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i]));
    }
    ASSERT_TRUE(palpation.end().has_value());
  }
  ASSERT_EQ(palpation.map().size(), 2U);
  EXPECT_EQ(palpation.map()[0].value_nm_per_rad, palpation.map()[1].value_nm_per_rad);
  EXPECT_EQ(palpation.map()[0].half_interval, palpation.map()[1].half_interval);
  EXPECT_EQ(palpation.map()[1].site, 2);
  palpation.begin(on_board(parameters_), {.site = 3, .largest_nm = amplitude});
  EXPECT_FALSE(palpation.end().has_value()) << "nothing was pressed";
  EXPECT_EQ(palpation.map().size(), 2U);
}

TEST_F(PalpationOfBoard, TheMapMarksTheSitesThatTheHostMarks) {
  Palpation palpation;
  std::vector<SiteStiffness> felt;  // of the host, from the board's own figures
  int site = 0;
  for (const double stiffness : {0.05, 0.08, 0.055, 0.052}) {
    EXPECT_EQ(palpation.stiff_from(Palpation::kStiffFactor).has_value(), site >= 3) << "fewer have no rest";
    sim::PlantParameters p;
    p.environment = test::tissue(760010);
    p.environment.deep_stiffness = stiffness;
    const AxisLog log = servo_log(p, 10.0, 0.2, 0.15, 0.2, 760010 + static_cast<std::uint64_t>(site));
    palpation.begin(on_board(parameters_),
                    {.site = ++site, .largest_nm = Q24::from_double(log.tau_nm.cwiseAbs().maxCoeff())});
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      palpation.add(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i]));
    }
    const auto one = palpation.end();
    ASSERT_TRUE(one.has_value());
    felt.emplace_back().combined = Stiffness{one->value_nm_per_rad.to_double(), one->half_interval.to_double()};
  }
  for (const double factor : {1.02, 1.2, 1.4, 2.0}) {
    const auto marked = stiff_sites(felt, factor);
    const auto from = palpation.stiff_from(Q24::from_double(factor));
    ASSERT_TRUE(from.has_value());
    for (std::size_t i = 0; i < felt.size(); ++i) {
      const auto& board = palpation.map()[i];
      EXPECT_EQ(board.value_nm_per_rad - board.half_interval > *from,
                std::find(marked.begin(), marked.end(), i) != marked.end())
          << factor << ", site " << i + 1;
    }
  }
  EXPECT_EQ(stiff_sites(felt), std::vector<std::size_t>{1});
}

TEST_F(PalpationOfBoard, RowsAtTheEndsOfTheNumbersEndInAnAnswerOrNone) {
  // Steps, ramps and noise over all that Q24 holds; the sanitizers watch the sums.
  Random random(760005);
  for (const double most : {0.1, 5.0, 40.0, 127.0}) {
    Palpation palpation;
    palpation.begin(on_board(parameters_), {.site = 0, .largest_nm = Q24::from_double(most)});
    for (int i = 0; i < 60000; ++i) {
      const double ramp = std::asin(std::sin(1e-3 * i)) * 2.0 / std::numbers::pi;
      palpation.add(Q24::from_double(most * ramp + 1e-4 * random.normal()), Q24::from_double(0.7 * most * ramp));
    }
    if (const auto site = palpation.end()) {
      EXPECT_GT(site->value_nm_per_rad, Q24{});
      EXPECT_GT(site->half_interval, Q24{});
    }
  }
}

}  // namespace
}  // namespace capstan::tools
