// SPDX-License-Identifier: Apache-2.0
// Encoder timer, analogue converter, set value and the joint I/O made of them, on registers that behave as RM0090 says.
#include "hal/stm32f4/motor_board_io.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

constexpr Pin kEnable{.port = Port::kC, .number = 10, .mode = PinMode::kOutput};
constexpr Pin kStop{.port = Port::kB, .number = 12, .mode = PinMode::kAlternate};
constexpr std::uint32_t kPeriod = 33'600;
constexpr Q24 kFullScale = Q24::from_int(5);

TEST(PwmScale, ZeroIsHalfAndTheEndsAreTenAndNinetyPercent) {
  const PwmScale scale{.period = kPeriod, .full_scale_a = kFullScale};
  EXPECT_EQ(scale.compare(Q24{}), kPeriod / 2);
  EXPECT_EQ(scale.compare(kFullScale), kPeriod * 9 / 10);
  EXPECT_EQ(scale.compare(-kFullScale), kPeriod / 10);
}

TEST(PwmScale, NothingLeavesTheBandOfTenToNinetyPercent) {
  const PwmScale scale{.period = kPeriod, .full_scale_a = kFullScale};
  for (const Q24 current : {Q24::max(), Q24::lowest(), Q24::from_int(6), Q24::from_int(-6)}) {
    EXPECT_GE(scale.compare(current), kPeriod / 10);
    EXPECT_LE(scale.compare(current), kPeriod * 9 / 10);
  }
}

TEST(PwmScale, IsLinearWithinHalfACount) {
  const PwmScale scale{.period = kPeriod, .full_scale_a = kFullScale};
  for (double current = -5.0; current <= 5.0; current += 0.0137) {
    const double wanted = kPeriod * (0.5 + 0.4 * current / 5.0);
    EXPECT_NEAR(scale.compare(Q24::from_double(current)), wanted, 0.51) << current;
  }
}

TEST(CurrentScale, MidIsZeroAndTheSlopeIsTheMonitors) {
  const CurrentScale scale{.full_scale_a = Q24::from_int(6)};
  EXPECT_EQ(scale.current(2048).raw(), 0);
  for (std::uint32_t raw = 0; raw <= kAdcFullScale; raw += 13) {
    EXPECT_NEAR(scale.current(raw).to_double(), (raw - 2048.0) / 2048.0 * 6.0, 1e-7);
  }
}

TEST(CurrentScale, ReadingsAtTheRailsAreNotPlausible) {
  const CurrentScale scale;
  EXPECT_FALSE(scale.plausible(0));
  EXPECT_FALSE(scale.plausible(4095));
  EXPECT_TRUE(scale.plausible(2048));
}

/// One axis of the board. The break input clears the main output at once and latches its flag, which software clears by
/// writing 0 and which comes back while the input is low.
class MotorBoard : public testing::Test {
 protected:
  using Io = MotorBoardIo<FakeRegister, 1>;
  MotorBoard()
      : encoder(tim2),
        set_value(tim1, 0),
        adc(adc1, adc_common),
        io({AxisHardware<FakeRegister>{encoder, set_value, port_c, kEnable, 10, {Q24::from_int(6)}}}, adc, port_b,
           kStop) {
    port_b.idr.value = kStop.mask();
    tim1.bdtr.on_write = [this](std::uint32_t, std::uint32_t written) {
      return stop_pressed() ? written & ~timer::kBdtrMainOutput : written;
    };
    tim1.sr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      return stop_pressed() ? old : write_zero_to_clear(timer::kSrBreak)(old, written);
    };
    port_c.bsrr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      enabled = (written & kEnable.mask()) != 0 || (enabled && (written & (kEnable.mask() << 16U)) == 0);
      return old;
    };
    adc1.cr2.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((written & adc::kCr2Start) != 0 && adc_answers) {
        adc1.sr.value |= adc::kSrEndOfConversion | (adc_overruns ? adc::kSrOverrun : 0U);
        adc1.dr.value = channel_values.at(adc1.sqr[2].value & 0x1FU);
      }
      return written & ~adc::kCr2Start;
    };
    adc1.dr.on_read = [this](std::uint32_t value) {
      adc1.sr.value &= ~adc::kSrEndOfConversion;
      return value;
    };
    adc.start();
    EXPECT_TRUE(encoder.start(5, false));
    set_value.start({.period = kPeriod, .full_scale_a = kFullScale});
  }

  [[nodiscard]] auto stop_pressed() const -> bool { return (port_b.idr.value & kStop.mask()) == 0; }
  void press_stop() {
    port_b.idr.value = 0;
    tim1.bdtr.value &= ~timer::kBdtrMainOutput;
    tim1.sr.value |= timer::kSrBreak;
  }
  void let_go_of_stop() { port_b.idr.value = kStop.mask(); }
  [[nodiscard]] auto output_on() const -> bool { return (tim1.bdtr.value & timer::kBdtrMainOutput) != 0; }
  auto drive(double current_a, bool on) -> Status {
    Drive<1> out;
    out.axis[0] = {.current_a = Q24::from_double(current_a), .enabled = on};
    return io.write(out);
  }

  TimerRegisters<FakeRegister> tim1, tim2;
  AdcRegisters<FakeRegister> adc1;
  AdcCommonRegisters<FakeRegister> adc_common;
  GpioRegisters<FakeRegister> port_b, port_c;
  QuadratureEncoder<FakeRegister> encoder;
  PwmSetValue<FakeRegister> set_value;
  Adc<FakeRegister> adc;
  Io io;
  std::vector<std::uint32_t> channel_values = std::vector<std::uint32_t>(19, 2048);
  bool adc_answers = true;
  bool adc_overruns = false;
  bool enabled = false;
  Sensed<1> in;
};

TEST_F(MotorBoard, EncoderCountsBothEdgesOfBothInputsOver32Bits) {
  EXPECT_EQ(tim2.smcr.value & 7U, 3U);
  EXPECT_EQ(tim2.arr.value, 0xFFFF'FFFFU);
  EXPECT_EQ(tim2.ccmr[0].value, 0x5151U);
  tim2.cnt.value = 0xFFFF'FFFE;
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_EQ(in.axis[0].encoder_counts, -2);
  EXPECT_EQ(in.axis[0].encoder, Quality::kOk);
}

TEST_F(MotorBoard, EncoderDirectionCanBeTurnedRound) {
  EXPECT_EQ(tim2.ccer.value, 0U);
  ASSERT_TRUE(encoder.start(0, true));
  EXPECT_EQ(tim2.ccer.value, 2U);
}

TEST_F(MotorBoard, EncoderTimerThatLostItsSettingIsMissingNotAtRest) {
  tim2.smcr.value = 0;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[0].encoder, Quality::kMissing);
  EXPECT_EQ(in.axis[0].current, Quality::kOk);
}

TEST_F(MotorBoard, EncoderWithoutAClockDoesNotStart) {
  TimerRegisters<FakeRegister> dead;
  dead.cr1.on_write = [](std::uint32_t, std::uint32_t) { return 0U; };
  QuadratureEncoder<FakeRegister> other(dead);
  EXPECT_FALSE(other.start(5, false));
}

TEST_F(MotorBoard, CurrentComesFromItsOwnChannel) {
  channel_values[10] = 2048 + 512;
  channel_values[11] = 100;
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_NEAR(in.axis[0].current_a.to_double(), 1.5, 1e-6);
  EXPECT_EQ(in.axis[0].current, Quality::kOk);
}

TEST_F(MotorBoard, ConverterThatNeverFinishesIsMissingAfterABoundedWait) {
  adc_answers = false;
  const std::uint32_t before = adc1.sr.reads;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[0].current, Quality::kMissing);
  EXPECT_LE(adc1.sr.reads - before, 1000U);
}

TEST_F(MotorBoard, OverrunConversionIsMissingAndTheNextOneIsFine) {
  adc_overruns = true;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[0].current, Quality::kMissing);
  adc_overruns = false;
  EXPECT_EQ(io.read(in), Status::kOk);
}

TEST_F(MotorBoard, MonitorAtTheRailIsInvalid) {
  channel_values[10] = 0;
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_EQ(in.axis[0].current, Quality::kInvalid);
}

TEST_F(MotorBoard, StartsWithEveryOutputOff) {
  EXPECT_FALSE(output_on());
  EXPECT_FALSE(enabled);
  EXPECT_NE(tim1.bdtr.value & timer::kBdtrBreakEnable, 0U);
  EXPECT_EQ(tim1.bdtr.value & timer::kBdtrBreakHigh, 0U) << "an open wire must stop the board";
}

TEST_F(MotorBoard, EnabledAxisGetsItsSetValueAndItsEnableLine) {
  EXPECT_EQ(drive(2.5, true), Status::kOk);
  EXPECT_EQ(tim1.ccr[0].value, kPeriod * 7 / 10);
  EXPECT_TRUE(output_on());
  EXPECT_TRUE(enabled);
}

TEST_F(MotorBoard, DisabledAxisIsOffWhateverTheCurrentSays) {
  ASSERT_EQ(drive(2.5, true), Status::kOk);
  EXPECT_EQ(drive(2.5, false), Status::kOk);
  EXPECT_FALSE(output_on());
  EXPECT_FALSE(enabled);
  EXPECT_EQ(tim1.ccr[0].value, kPeriod / 2);
}

TEST_F(MotorBoard, ReleaseIsLegalAtAnyTimeAndTurnsEverythingOff) {
  ASSERT_EQ(drive(1.0, true), Status::kOk);
  io.release();
  EXPECT_FALSE(output_on());
  EXPECT_FALSE(enabled);
  io.release();
  EXPECT_FALSE(output_on());
}

TEST_F(MotorBoard, EmergencyStopIsSensedAndHoldsTheOutputOff) {
  ASSERT_EQ(drive(1.0, true), Status::kOk);
  press_stop();
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop);
  EXPECT_EQ(drive(1.0, true), Status::kFailed);
  EXPECT_FALSE(output_on());
  EXPECT_FALSE(enabled);
}

TEST_F(MotorBoard, StopShorterThanACycleIsStillSeenAndKeepsTheOutputOff) {
  ASSERT_EQ(drive(1.0, true), Status::kOk);
  press_stop();
  let_go_of_stop();
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop);
  EXPECT_EQ(drive(1.0, true), Status::kFailed);
  EXPECT_FALSE(output_on());
}

TEST_F(MotorBoard, AfterAStopTheAxisComesBackOnlyThroughDisabled) {
  ASSERT_EQ(drive(1.0, true), Status::kOk);
  press_stop();
  EXPECT_EQ(drive(0.0, false), Status::kOk);
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop) << "still pressed";
  let_go_of_stop();
  EXPECT_EQ(drive(0.0, false), Status::kOk);
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_FALSE(in.estop);
  EXPECT_EQ(drive(1.0, true), Status::kOk);
  EXPECT_TRUE(output_on());
}

TEST_F(MotorBoard, BreakRegisterIsNotRewrittenWhileTheOutputIsOn) {
  ASSERT_EQ(drive(1.0, true), Status::kOk);
  const std::uint32_t writes = tim1.bdtr.writes;
  ASSERT_EQ(drive(1.1, true), Status::kOk);
  EXPECT_EQ(tim1.bdtr.writes, writes);
}

TEST_F(MotorBoard, OverrunsOfTheBoardAreInEverySnapshot) {
  io.set_overruns(3);
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_EQ(in.overruns, 3U);
}

}  // namespace
}  // namespace capstan::stm32f4
