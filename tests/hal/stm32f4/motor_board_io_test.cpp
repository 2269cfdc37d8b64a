// SPDX-License-Identifier: Apache-2.0
// Encoder timer, analogue converter, set value and the joint I/O made of them, on registers that behave as RM0090 says.
#include "capstan/hal/stm32f4/motor_board_io.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/hal/stm32f4/fake_analogue.hpp"
#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

constexpr Pin kStop1{.port = Port::kB, .number = 12, .mode = PinMode::kAlternate};
constexpr Pin kStop8{.port = Port::kB, .number = 6, .mode = PinMode::kAlternate};
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

TEST(SupplyScale, FullRangeIsFullScale) {
  const SupplyScale scale{.full_scale_v = Q24::from_double(36.3)};
  EXPECT_EQ(scale.voltage(0).raw(), 0);
  EXPECT_NEAR(scale.voltage(2708).to_double(), 24.0, 0.01);  // 24 V behind 11:1 are 2.1818 V of 3.3 V
}

/// The board with four axes, two on each advanced timer. A break input clears its timer's main output at once and
/// latches the flag, which software clears by writing 0 and which comes back while the input is low.
class MotorBoard : public testing::Test {
 protected:
  static constexpr std::size_t kAxes = 4;
  using Io = MotorBoardIo<FakeRegister, kAxes>;
  using Encoder = QuadratureEncoder<FakeRegister>;
  using SetValue = PwmSetValue<FakeRegister>;
  static constexpr std::array<std::uint32_t, kAxes> kChannels = {0, 3, 2, 3};

  MotorBoard()
      : io({AxisHardware<FakeRegister>{encoders[0], set_values[0], port_c, enables[0]},
            AxisHardware<FakeRegister>{encoders[1], set_values[1], port_c, enables[1]},
            AxisHardware<FakeRegister>{encoders[2], set_values[2], port_c, enables[2]},
            AxisHardware<FakeRegister>{encoders[3], set_values[3], port_c, enables[3]}},
           analogue, {StopInput<FakeRegister>{port_b, kStop1}, StopInput<FakeRegister>{port_b, kStop8}},
           {.current = {Q24::from_int(6)}, .supply = {Q24::from_int(36)}, .thermometer = {10'000, 500'000}}) {
    chip.memory_neighbour = this;
    port_b.idr.value = kStop1.mask() | kStop8.mask();
    behave(tim1, kStop1);
    behave(tim8, kStop8);
    port_c.bsrr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      lines = (lines & ~(written >> 16U)) | (written & 0xFFFFU);
      return old;
    };
    chip.channel_values[15] = volts(0.75);  // 25 C
    analogue.start({10, 11, 12, 13, 14, 15});
    for (std::size_t i = 0; i < kAxes; ++i) {
      EXPECT_TRUE(encoders[i].start(5, false));
      set_values[i].start({.period = kPeriod, .full_scale_a = kFullScale});
    }
  }

  static auto volts(double v) -> std::uint32_t { return static_cast<std::uint32_t>(std::lround(v / 3.3 * 4096.0)); }
  void behave(TimerRegisters<FakeRegister>& timer, const Pin& stop) {
    timer.bdtr.on_write = [this, &stop](std::uint32_t, std::uint32_t written) {
      return pressed(stop) ? written & ~timer::kBdtrMainOutput : written;
    };
    timer.sr.on_write = [this, &stop](std::uint32_t old, std::uint32_t written) {
      return pressed(stop) ? old : write_zero_to_clear(0xFFFF)(old, written);
    };
  }
  [[nodiscard]] auto pressed(const Pin& stop) const -> bool { return (port_b.idr.value & stop.mask()) == 0; }
  void press(TimerRegisters<FakeRegister>& timer, const Pin& stop) {
    port_b.idr.value &= ~stop.mask();
    timer.bdtr.value &= ~timer::kBdtrMainOutput;
    timer.sr.value |= timer::kSrBreak;
  }
  void press_stop() {
    press(tim1, kStop1);
    press(tim8, kStop8);
  }
  void let_go_of_stop() { port_b.idr.value = kStop1.mask() | kStop8.mask(); }
  [[nodiscard]] auto timer_of(std::size_t axis) const -> const TimerRegisters<FakeRegister>& {
    return axis < 2 ? tim1 : tim8;
  }
  [[nodiscard]] auto output_on(std::size_t axis) const -> bool {
    const auto& timer = timer_of(axis);
    return (timer.bdtr.value & timer::kBdtrMainOutput) != 0 &&
           (timer.ccer.value & (1U << (4 * kChannels.at(axis)))) != 0;
  }
  [[nodiscard]] auto enabled(std::size_t axis) const -> bool { return (lines & enables.at(axis).mask()) != 0; }
  void expect_off() {
    for (std::size_t i = 0; i < kAxes; ++i) {
      EXPECT_FALSE(output_on(i)) << i;
      EXPECT_FALSE(enabled(i)) << i;
      EXPECT_EQ(timer_of(i).ccr.at(kChannels.at(i)).value, kPeriod / 2) << i;
    }
    EXPECT_EQ(tim1.bdtr.value & timer::kBdtrMainOutput, 0U);
    EXPECT_EQ(tim8.bdtr.value & timer::kBdtrMainOutput, 0U);
  }
  /// The axes of the mask `on` get 0.5 A more each.
  auto drive(double current_a, unsigned on = 0xF) -> Status {
    Drive<kAxes> out;
    for (std::size_t i = 0; i < kAxes; ++i) {
      out.axis[i] = {.current_a = Q24::from_double(current_a + 0.5 * static_cast<double>(i)),
                     .enabled = ((on >> i) & 1U) != 0};
    }
    return io.write(out);
  }

  const std::array<Pin, kAxes> enables = {{{.port = Port::kC, .number = 10, .mode = PinMode::kOutput},
                                           {.port = Port::kC, .number = 11, .mode = PinMode::kOutput},
                                           {.port = Port::kC, .number = 12, .mode = PinMode::kOutput},
                                           {.port = Port::kC, .number = 2, .mode = PinMode::kOutput}}};
  TimerRegisters<FakeRegister> tim1, tim8, tim2, tim3, tim4, tim5;
  FakeAnalogue chip;
  GpioRegisters<FakeRegister> port_b, port_c;
  std::array<Encoder, kAxes> encoders = {
      {{tim2, CounterWidth::k32}, {tim5, CounterWidth::k32}, {tim3, CounterWidth::k16}, {tim4, CounterWidth::k16}}};
  std::array<SetValue, kAxes> set_values = {{{tim1, 0}, {tim1, 3}, {tim8, 2}, {tim8, 3}}};
  Io::Analogue analogue{chip.adc1, chip.adc_common, chip.dma2};
  Io io;
  std::uint32_t lines = 0;
  Sensed<kAxes> in;
};

TEST_F(MotorBoard, EveryAxisReadsItsOwnEncoderAndItsOwnCurrent) {
  tim2.cnt.value -= 2;
  tim5.cnt.value += 3;
  tim3.cnt.value -= 4;
  tim4.cnt.value += 5;
  chip.channel_values[10] = 2048 + 512;
  chip.channel_values[11] = 2048 - 512;
  chip.channel_values[12] = 2048 + 1024;
  chip.channel_values[13] = 2048 - 1024;
  ASSERT_EQ(io.read(in), Status::kOk);
  const std::array<std::int32_t, kAxes> counts = {-2, 3, -4, 5};
  const std::array<double, kAxes> currents = {1.5, -1.5, 3.0, -3.0};
  for (std::size_t i = 0; i < kAxes; ++i) {
    EXPECT_EQ(in.axis[i].encoder, Quality::kOk);
    EXPECT_EQ(in.axis[i].encoder_counts, counts.at(i));
    EXPECT_EQ(in.axis[i].current, Quality::kOk);
    EXPECT_NEAR(in.axis[i].current_a.to_double(), currents.at(i), 1e-6);
  }
}

TEST_F(MotorBoard, SupplyIsMeasuredBesideTheCurrents) {
  chip.channel_values[14] = 2731;
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_NEAR(io.supply_v().to_double(), 24.0, 0.01);
  chip.converter_answers = false;
  static_cast<void>(io.read(in));
  EXPECT_EQ(io.supply_v().raw(), 0) << "no old voltage is shown as today's";
  for (const AxisSensed& axis : in.axis) {
    EXPECT_EQ(axis.supply, Quality::kMissing);
  }
}

TEST_F(MotorBoard, EveryAmplifierHasTheSupplyOfTheBoard) {
  chip.channel_values[14] = 2731;
  ASSERT_EQ(io.read(in), Status::kOk);
  for (const AxisSensed& axis : in.axis) {
    EXPECT_EQ(axis.supply, Quality::kOk);
    EXPECT_NEAR(axis.supply_v.to_double(), 24.0, 0.01);
  }
}

TEST_F(MotorBoard, ThermometerGivesTheTemperatureOfItsVoltageAtOnceAndFollowsWithinSomeSeconds) {
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_EQ(in.temperature, Quality::kOk);
  EXPECT_NEAR(in.temperature_c.to_double(), 25.0, 0.05);
  for (const double celsius : {-40.0, 0.0, 37.0, 120.0}) {
    chip.channel_values[15] = volts(0.5 + 0.01 * celsius);
    for (int i = 0; i < 12'000; ++i) {
      ASSERT_EQ(io.read(in), Status::kOk);
    }
    EXPECT_NEAR(in.temperature_c.to_double(), celsius, 0.05 + 1e-3 * 100.0 / 10.0) << "half a step of the converter";
  }
}

TEST_F(MotorBoard, ThermometersNoiseIsAveraged) {
  for (int i = 0; i < 20'000; ++i) {
    chip.channel_values[15] = volts(0.75) + (i % 2 == 0 ? 8 : 0) - 4;
    ASSERT_EQ(io.read(in), Status::kOk);
    if (i > 10'000) {
      ASSERT_NEAR(in.temperature_c.to_double(), 25.0, 0.05) << "one reading alone would be off by 0.32 K";
    }
  }
}

TEST_F(MotorBoard, BrokenOrShortedThermometerIsInvalidAndStopsNothingAndComesBackAfresh) {
  for (const std::uint32_t raw : {0U, 20U, 4080U, 4095U, volts(0.5 + 0.01 * 130.0)}) {
    chip.channel_values[15] = raw;
    for (int i = 0; i < 10'000; ++i) {
      ASSERT_EQ(io.read(in), Status::kOk);
    }
    EXPECT_EQ(in.temperature, Quality::kInvalid) << raw;
    chip.channel_values[15] = 0;
    ASSERT_EQ(io.read(in), Status::kOk);
    chip.channel_values[15] = volts(0.75);
    ASSERT_EQ(io.read(in), Status::kOk);
    EXPECT_EQ(in.temperature, Quality::kOk);
    EXPECT_NEAR(in.temperature_c.to_double(), 25.0, 0.05);
  }
}

TEST(Thermometer, WithoutOneItIsMissingWhateverThePinSays) {
  Thermometer none{0, 500'000};
  Q24 celsius;
  for (std::uint32_t raw = 0; raw <= kAdcFullScale; raw += 91) {
    EXPECT_EQ(none.rt_read(raw, celsius), Quality::kMissing);
  }
}

TEST(Thermometer, SensorWithoutOffsetReadsFromZeroUp) {
  Thermometer lm35{10'000, 0};
  Q24 celsius;
  EXPECT_EQ(lm35.rt_read(310, celsius), Quality::kOk);
  EXPECT_NEAR(celsius.to_double(), 310.0 / 4096.0 * 330.0, 1e-3);
}

TEST_F(MotorBoard, EncoderThatLostItsSettingsIsMissingForItsAxisOnly) {
  tim3.smcr.value = 0;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[2].encoder, Quality::kMissing);
  EXPECT_EQ(in.axis[2].current, Quality::kOk);
  EXPECT_EQ(in.axis[1].encoder, Quality::kOk);
  EXPECT_EQ(in.axis[3].encoder, Quality::kOk);
}

TEST_F(MotorBoard, ConverterThatNeverFinishesLeavesEveryCurrentMissing) {
  chip.converter_answers = false;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  for (const AxisSensed& axis : in.axis) {
    EXPECT_EQ(axis.current, Quality::kMissing);
    EXPECT_EQ(axis.encoder, Quality::kOk);
  }
}

TEST_F(MotorBoard, OverrunConversionIsMissingAndTheNextOneIsFine) {
  chip.overrun_at = 1;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[0].current, Quality::kMissing);
  EXPECT_EQ(io.read(in), Status::kOk);
}

TEST_F(MotorBoard, MonitorAtTheRailIsInvalidForItsAxisOnly) {
  chip.channel_values[12] = 0;
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_EQ(in.axis[2].current, Quality::kInvalid);
  EXPECT_EQ(in.axis[3].current, Quality::kOk);
}

TEST_F(MotorBoard, StartsWithEveryOutputOffAndBreaksThatAnOpenWireTrips) {
  expect_off();
  for (const auto* timer : {&tim1, &tim8}) {
    EXPECT_NE(timer->bdtr.value & timer::kBdtrBreakEnable, 0U);
    EXPECT_EQ(timer->bdtr.value & timer::kBdtrBreakHigh, 0U);
  }
}

TEST_F(MotorBoard, EnabledAxesGetTheirSetValuesAndTheirEnableLines) {
  EXPECT_EQ(drive(2.5), Status::kOk);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const double duty = 0.5 + 0.4 * (2.5 + 0.5 * static_cast<double>(i)) / 5.0;
    EXPECT_NEAR(timer_of(i).ccr.at(kChannels.at(i)).value, kPeriod * duty, 0.51) << i;
    EXPECT_TRUE(output_on(i)) << i;
    EXPECT_TRUE(enabled(i)) << i;
  }
}

TEST_F(MotorBoard, DisabledAxisIsOffAndItsNeighbourOnTheSameTimerGoesOn) {
  ASSERT_EQ(drive(2.5), Status::kOk);
  EXPECT_EQ(drive(2.5, 0b1101), Status::kOk);
  EXPECT_FALSE(output_on(1));
  EXPECT_FALSE(enabled(1));
  EXPECT_EQ(tim1.ccr[3].value, kPeriod / 2);
  EXPECT_TRUE(output_on(0));
  EXPECT_TRUE(enabled(0));
  EXPECT_EQ(drive(2.5, 0b1100), Status::kOk);
  EXPECT_EQ(tim1.bdtr.value & timer::kBdtrMainOutput, 0U) << "the main output goes with its last channel";
  EXPECT_TRUE(output_on(2));
}

TEST_F(MotorBoard, ReleaseIsLegalAtAnyTimeAndTurnsEverythingOff) {
  ASSERT_EQ(drive(1.0), Status::kOk);
  io.release();
  expect_off();
  io.release();
  expect_off();
}

TEST_F(MotorBoard, EmergencyStopIsSensedAndHoldsEveryOutputOff) {
  ASSERT_EQ(drive(1.0), Status::kOk);
  press_stop();
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop);
  EXPECT_EQ(drive(1.0), Status::kFailed);
  expect_off();
}

TEST_F(MotorBoard, StopWireOfOneTimerAloneIsAnEmergencyStop) {
  for (const Pin* stop : {&kStop1, &kStop8}) {
    port_b.idr.value = (kStop1.mask() | kStop8.mask()) & ~stop->mask();
    EXPECT_EQ(io.read(in), Status::kOk);
    EXPECT_TRUE(in.estop);
  }
}

TEST_F(MotorBoard, StopShorterThanACycleIsStillSeenAndKeepsTheOutputsOff) {
  ASSERT_EQ(drive(1.0), Status::kOk);
  press_stop();
  let_go_of_stop();
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop);
  EXPECT_EQ(drive(1.0), Status::kFailed);
  expect_off();
}

TEST_F(MotorBoard, BreakOfOneTimerIsNotForgottenWhileAnyAxisIsToBeDriven) {
  ASSERT_EQ(drive(1.0), Status::kOk);
  press(tim8, kStop8);
  let_go_of_stop();
  EXPECT_EQ(drive(1.0, 0b0111), Status::kFailed);  // axis 3 is off, which alone must not re-arm the timer of axis 2
  EXPECT_EQ(drive(1.0, 0b0111), Status::kFailed);
  EXPECT_FALSE(output_on(2));
}

TEST_F(MotorBoard, AfterAStopTheAxesComeBackOnlyThroughDisabled) {
  ASSERT_EQ(drive(1.0), Status::kOk);
  press_stop();
  EXPECT_EQ(drive(0.0, 0), Status::kOk);
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop) << "still pressed";
  let_go_of_stop();
  EXPECT_EQ(drive(0.0, 0), Status::kOk);
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_FALSE(in.estop);
  EXPECT_EQ(drive(1.0), Status::kOk);
  EXPECT_TRUE(output_on(0));
  EXPECT_TRUE(output_on(3));
}

TEST_F(MotorBoard, BreakRegisterIsNotRewrittenWhileTheOutputIsOn) {
  ASSERT_EQ(drive(1.0), Status::kOk);
  const std::uint32_t writes = tim1.bdtr.writes + tim8.bdtr.writes;
  ASSERT_EQ(drive(1.1), Status::kOk);
  EXPECT_EQ(tim1.bdtr.writes + tim8.bdtr.writes, writes);
}

TEST_F(MotorBoard, OverrunsOfTheBoardAreInEverySnapshot) {
  io.set_overruns(3);
  ASSERT_EQ(io.read(in), Status::kOk);
  EXPECT_EQ(in.overruns, 3U);
}

}  // namespace
}  // namespace capstan::stm32f4
