// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/hysteresis.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(InputTerm<Hysteresis<double>, double> && InputTerm<Hysteresis<Q24>, Q24>);

constexpr std::size_t kPlays = Hysteresis<double>::kPlays;
struct OnePlay {
  double half_width;
  double weight;
};
using Plays = std::vector<OnePlay>;

template <typename Scalar>
auto stage_of(const Plays& plays) -> Hysteresis<Scalar> {
  std::array<Scalar, 2 * kPlays> shape{};
  for (std::size_t i = 0; i < plays.size(); ++i) {
    shape[2 * i] = number<Scalar>(plays[i].half_width);
    shape[2 * i + 1] = number<Scalar>(plays[i].weight);
  }
  return {one_khz<Scalar>(), shape};
}

template <typename Scalar>
auto sample_at(double q1, bool forward = true) -> Sample<Scalar> {
  return {.q1 = number<Scalar>(q1), .forward = forward, .h = number<Scalar>(q1)};
}

/// A play by Madelung's rule on its turning points alone: the joint stands still until the motor has come back by 2 r
/// from the extreme at which it last pushed. No clamp and no position of the last sample in it.
class PlayByExtremes {
 public:
  PlayByExtremes(double start, double half_width) : extreme_(start), half_width_(half_width) {}
  auto position(double q) -> double {
    if (side_ == 0 && std::fabs(q - extreme_) > half_width_) {
      side_ = q > extreme_ ? 1 : -1;
      extreme_ = q;
    }
    if (side_ == 0) {
      return extreme_;
    }
    if (side_ * (q - extreme_) >= 0.0) {
      extreme_ = q;
    } else if (side_ * (extreme_ - q) > 2.0 * half_width_) {
      side_ = -side_;
      extreme_ = q;
    }
    return extreme_ - side_ * half_width_;
  }

 private:
  double extreme_;
  double half_width_;
  int side_ = 0;  ///< which wall pushed last; 0: none yet
};

auto any_plays() -> Plays {
  Plays plays;
  const int count = *rc::gen::inRange(0, static_cast<int>(kPlays) + 1);
  for (int i = 0; i < count; ++i) {
    plays.push_back({1e-4 * *rc::gen::inRange(1, 20000), 0.01 * *rc::gen::inRange(-100, 101)});
  }
  return plays;
}

RC_GTEST_PROP(HysteresisStage, IsTheWeightedSumOfPlaysByTheirTurningPoints, ()) {
  const Plays plays = any_plays();
  auto exact = stage_of<double>(plays);
  auto fixed = stage_of<Q24>(plays);
  double q = 0.37;
  std::vector<PlayByExtremes> reference;
  for (const auto& play : plays) {
    reference.emplace_back(q, play.half_width);
  }
  for (const int step : *rc::gen::container<std::vector<int>>(rc::gen::inRange(-5000, 5000))) {
    double wanted = q;
    for (std::size_t i = 0; i < plays.size(); ++i) {
      wanted += plays[i].weight * (reference[i].position(q) - q);
    }
    RC_ASSERT(std::fabs(exact.update(sample_at<double>(q)) - wanted) < 1e-10);
    // Widths and weights are rounded once each, and the sum once: nothing accumulates.
    RC_ASSERT(std::fabs(fixed.update(sample_at<Q24>(q)).to_double() - wanted) < 40.0 * test::kLsb);
    q += 1e-4 * step;
  }
}

TEST(HysteresisStage, IsOffWhereNoPlayHasBothWidthAndWeight) {
  EXPECT_FALSE(stage_of<Q24>({}).is_on());
  EXPECT_FALSE(stage_of<Q24>({{0.1, 0.0}, {0.0, 0.5}}).is_on());
  EXPECT_TRUE(stage_of<Q24>({{0.1, 0.0}, {0.02, 0.5}}).is_on());
}

template <typename Scalar>
class HysteresisIn : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(HysteresisIn, Formats);

// One play of weight 1 rests in its gap of 2 r; two of them, each with half the motion, do so one after the other.
TYPED_TEST(HysteresisIn, HasAKneeForEveryPlay) {
  auto stage = stage_of<TypeParam>({{0.1, 0.5}, {0.2, 0.5}});
  const auto go = [&stage](double from, double to) {
    double h = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      h = value_of(stage.update(sample_at<TypeParam>(from + (to - from) * i / 1000.0)));
    }
    return h;
  };
  const double top = go(0.0, 1.0);
  EXPECT_NEAR(top, 1.0 - 0.5 * 0.1 - 0.5 * 0.2, 1e-6);
  EXPECT_NEAR(go(1.0, 0.8), top, 1e-6) << "both plays rest for the first 0.2 rad";
  EXPECT_NEAR(go(0.8, 0.6), top - 0.5 * 0.2, 1e-6) << "one of them for 0.2 rad more";
  EXPECT_NEAR(go(0.6, 0.0), top - 0.5 * 0.8 - 0.5 * 0.6, 1e-6) << "then none";
}

TYPED_TEST(HysteresisIn, SettlesToWhatALongMotionShowsAndIsUndoneThere) {
  auto stage = stage_of<TypeParam>({{0.1, 0.7}, {0.3, -0.2}, {0.02, 0.3}});
  for (const bool forward : {true, false}) {
    double h = 0.0;
    double q = 0.0;
    for (int i = 0; i <= 2000; ++i) {
      q = (forward ? 1.0 : -1.0) * 0.001 * i;
      h = value_of(stage.update(sample_at<TypeParam>(q, forward)));
    }
    EXPECT_NEAR(value_of(stage.steady_state(sample_at<TypeParam>(q, forward))), h, 2e-6);
    EXPECT_NEAR(value_of(stage.undone(number<TypeParam>(h), forward)), q, 2e-6);
    stage.restart();
  }
}

TYPED_TEST(HysteresisIn, ForgetsWhatItIsToldToForget) {
  auto used = stage_of<TypeParam>({{0.1, 0.7}});
  auto fresh = stage_of<TypeParam>({{0.1, 0.7}});
  used.update(sample_at<TypeParam>(0.0));
  used.update(sample_at<TypeParam>(2.0));
  used.restart();
  for (const double q : {0.5, 0.55, 0.3, 0.9}) {
    EXPECT_EQ(used.update(sample_at<TypeParam>(q)), fresh.update(sample_at<TypeParam>(q)));
  }
}

TEST(HysteresisStage, TakesNoWidthOrWeightThatItsNumbersDoNotHold) {
  auto stage = stage_of<Q24>({{127.0, 100.0}, {127.0, -100.0}});
  for (const double q : {0.0, 100.0, -100.0, 3.0}) {
    EXPECT_FALSE(stage.update(sample_at<Q24>(q)).is_saturated() && std::fabs(q) < 1.0);
  }
}

}  // namespace
}  // namespace capstan
