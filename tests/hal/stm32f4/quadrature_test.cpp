// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/quadrature.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

/// An encoder timer: the counter has its own width, passing either end raises the update flag, which software clears by
/// writing 0 (RM0090 section 18.4.5).
class EncoderTimer {
 public:
  explicit EncoderTimer(std::uint32_t width) : mask_(0xFFFF'FFFFU >> (32 - width)) {
    registers.cnt.on_write = [this](std::uint32_t, std::uint32_t written) { return written & mask_; };
    registers.arr.on_write = registers.cnt.on_write;
    registers.sr.on_write = write_zero_to_clear(0x1F);
  }
  void turn(std::int64_t counts) {
    const std::int64_t sum = registers.cnt.value + counts;
    registers.cnt.value = static_cast<std::uint32_t>(sum) & mask_;
    if (sum < 0 || sum > mask_) {
      registers.sr.value |= timer::kSrUpdate;
    }
  }
  TimerRegisters<FakeRegister> registers;

 private:
  std::uint32_t mask_;
};

class Quadrature : public testing::TestWithParam<CounterWidth> {
 protected:
  Quadrature() : timer(static_cast<std::uint32_t>(GetParam())), encoder(timer.registers, GetParam()) {
    EXPECT_TRUE(encoder.start(5, false));
  }
  auto counts() -> std::int32_t {
    std::int32_t value = 0;
    EXPECT_TRUE(encoder.rt_read(value));
    return value;
  }
  EncoderTimer timer;
  QuadratureEncoder<FakeRegister> encoder;
};
INSTANTIATE_TEST_SUITE_P(Widths, Quadrature, testing::Values(CounterWidth::k16, CounterWidth::k32));

TEST_P(Quadrature, CountsBothEdgesOfBothInputsOverTheWholeCounter) {
  EXPECT_EQ(timer.registers.smcr.value & 7U, 3U);
  EXPECT_EQ(timer.registers.arr.value, GetParam() == CounterWidth::k16 ? 0xFFFFU : 0xFFFF'FFFFU);
  EXPECT_EQ(timer.registers.ccmr[0].value, 0x5151U) << "inputs on their own pins, filter 5 on both";
}

TEST_P(Quadrature, DirectionCanBeTurnedRound) {
  EXPECT_EQ(timer.registers.ccer.value, 0U);
  ASSERT_TRUE(encoder.start(0, true));
  EXPECT_EQ(timer.registers.ccer.value, 2U);
}

TEST_P(Quadrature, PositionIsTheSumOfTheMotionForManyTurnsOfTheCounter) {
  std::int64_t truth = 0;
  for (int cycle = 0; cycle < 2000; ++cycle) {
    const std::int64_t step = cycle < 1000 ? 391 : -777;  // 391: the speed limit at 40960 counts a turn
    timer.turn(step);
    truth += step;
    ASSERT_EQ(counts(), truth) << cycle;
  }
}

TEST_P(Quadrature, TremblingOnTheEndOfTheRangeCountsNothing) {
  while (timer.registers.cnt.value > 2) {  // 16 bits: down to 2; 32 bits start there as well
    timer.turn(-std::min<std::int64_t>(timer.registers.cnt.value - 2, 5000));
    static_cast<void>(counts());
  }
  const std::int32_t before = counts();
  for (int i = 0; i < 100; ++i) {
    timer.turn(-5);
    EXPECT_EQ(counts(), before - 5);
    timer.turn(5);
    EXPECT_EQ(counts(), before);
    timer.turn(-5);  // there and back between two reads
    timer.turn(5);
    EXPECT_EQ(counts(), before);
  }
}

TEST_P(Quadrature, TimerThatLostItsSettingIsMissingAndComesBackFarAway) {
  timer.turn(1000);
  EXPECT_EQ(counts(), 1000);
  timer.registers.smcr.value = 0;
  std::int32_t value = 77;
  EXPECT_FALSE(encoder.rt_read(value));
  EXPECT_EQ(value, 77);
  EXPECT_EQ(counts(), 1000 + 0x4000'0000) << "what moved meanwhile is not known, and the firmware must see a jump";
  timer.turn(5);
  EXPECT_EQ(counts(), 1005 + 0x4000'0000);
}

TEST_P(Quadrature, TimerWithoutAClockDoesNotStartAndNeverPassesForAJointAtRest) {
  timer.registers.cr1.on_write = [](std::uint32_t, std::uint32_t) { return 0U; };
  EXPECT_FALSE(encoder.start(5, false));
  std::int32_t value = 0;
  for (int i = 0; i < 4; ++i) {  // four jumps of a quarter of the range would lead back to the start
    EXPECT_FALSE(encoder.rt_read(value));
  }
  timer.registers.cr1.on_write = nullptr;
  EXPECT_FALSE(encoder.rt_read(value));  // starts it
  EXPECT_EQ(counts(), 0x4000'0000);
}

/// An encoder with an index every 1000 counts, first at 300, that its interrupt sees `late` counts behind. The disc and
/// the counter part when counts get lost.
class QuadratureWithIndex : public Quadrature {
 protected:
  static constexpr std::int64_t kEvery = 1000;
  QuadratureWithIndex() { EXPECT_TRUE(encoder.start(5, false, kEvery)); }

  void turn(std::int64_t counts, std::int64_t late = 0) {
    const std::int64_t direction = counts < 0 ? -1 : 1;
    for (std::int64_t i = 0; i < direction * counts; ++i) {
      disc_ += direction;
      timer.turn(direction);
      if (((disc_ - 300) % kEvery + kEvery) % kEvery == 0) {
        timer.turn(direction * late);
        encoder.rt_index();
        timer.turn(-direction * late);
      }
    }
  }
  void lose(std::int64_t counts) { disc_ += counts; }
  /// Turns on in cycles of 90 counts; how many were read until the position was lost, or -1.
  auto cycles_until_lost(int cycles, std::int64_t lost_per_cycle = 0) -> int {
    std::int32_t value = 0;
    for (int i = 0; i < cycles; ++i) {
      lose(lost_per_cycle);
      turn(90, i % 4);
      if (!encoder.rt_read(value)) {
        return i;
      }
    }
    return -1;
  }

 private:
  std::int64_t disc_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Widths, QuadratureWithIndex, testing::Values(CounterWidth::k16, CounterWidth::k32));

TEST_P(QuadratureWithIndex, WholeTurnsInBothDirectionsAreNeverTakenForALoss) {
  std::int64_t truth = 0;
  for (int cycle = 0; cycle < 3000; ++cycle) {
    const std::int64_t step = cycle % 700 < 400 ? 391 : -500;
    turn(step, cycle % 5);
    truth += step;
    ASSERT_EQ(counts(), truth) << cycle;
  }
}

TEST_P(QuadratureWithIndex, CountsThatGotLostAreFoundAtTheNextIndexAndThePositionIsLost) {
  ASSERT_EQ(cycles_until_lost(50), -1);
  const std::int32_t before = counts();
  lose(40);
  const int took = cycles_until_lost(50);
  EXPECT_GE(took, 0);
  EXPECT_LE(took, 1000 / 90 + 1);
  EXPECT_GT(counts(), before + 0x3000'0000) << "the firmware must see a jump";
  EXPECT_EQ(cycles_until_lost(50), -1) << "and goes on from there";
}

TEST_P(QuadratureWithIndex, ALossThatCreepsIsFoundToo) {
  ASSERT_EQ(cycles_until_lost(50), -1);
  EXPECT_GE(cycles_until_lost(100, 1), 0);
}

TEST_P(QuadratureWithIndex, WithoutItsDistanceTheIndexIsNotLookedAt) {
  ASSERT_TRUE(encoder.start(5, false));
  EXPECT_EQ(cycles_until_lost(200, 1), -1);
}

class Quadrature16 : public Quadrature {};
INSTANTIATE_TEST_SUITE_P(Sixteen, Quadrature16, testing::Values(CounterWidth::k16));

TEST_P(Quadrature16, CounterThatWentRoundUnreadIsLostNotAtRest) {
  std::int32_t value = 0;
  timer.turn(0x1'0000 + 5);  // a hand turned the joint while flash was erased
  EXPECT_FALSE(encoder.rt_read(value));
  EXPECT_EQ(counts(), 5 + 0x4000'0000);
}

TEST_P(Quadrature16, MotionOfHalfTheRangeCouldBeEitherWayAndIsLost) {
  std::int32_t value = 0;
  timer.turn(40'000);
  EXPECT_FALSE(encoder.rt_read(value));
}

TEST_P(Quadrature16, EdgeThatPassesBetweenFlagAndCounterIsNotLost) {
  while (timer.registers.cnt.value < 0xFFF0) {
    timer.turn(std::min<std::int64_t>(0xFFF0 - timer.registers.cnt.value, 5000));
    static_cast<void>(counts());
  }
  const std::int32_t before = counts();
  bool turned = false;
  timer.registers.cnt.on_read = [&](std::uint32_t value) {
    if (!turned) {
      turned = true;
      timer.turn(0x20);  // after the flag was read, before the counter is
      return timer.registers.cnt.value;
    }
    return value;
  };
  EXPECT_EQ(counts(), before + 0x20);
  EXPECT_EQ(counts(), before + 0x20) << "the flag of then is seen now";
}

}  // namespace
}  // namespace capstan::stm32f4
