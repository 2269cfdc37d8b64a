// SPDX-License-Identifier: Apache-2.0
// The lines themselves need a chip: tests/boards/linux_rt/can_bench has one.
#include "capstan/hal/linux/gpio_lines.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace capstan {
namespace {

TEST(EstopContact, IsOpenUntilItHasBeenClosedFor20Cycles) {
  EstopContact contact;
  for (int i = 0; i < 19; ++i) {
    EXPECT_TRUE(contact.rt_step(false, true));
  }
  EXPECT_FALSE(contact.rt_step(false, true));
}

TEST(EstopContact, OpensAtOnceOnTheLevelOrOnAnEdgeThatIsOverAlready) {
  for (const auto& [edge, level] : {std::pair{false, false}, {true, false}, {true, true}}) {
    EstopContact contact;
    for (int i = 0; i < 30; ++i) {
      static_cast<void>(contact.rt_step(false, true));
    }
    EXPECT_TRUE(contact.rt_step(edge, level));
    EXPECT_TRUE(contact.rt_step(false, true)) << "a contact that bounces does not close";
  }
}

TEST(EstopContact, BouncingKeepsItOpen) {
  EstopContact contact;
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(contact.rt_step(i % 19 == 0, true));
  }
}

TEST(GpioLines, WithoutAChipNothingIsOpenAndNothingFails) {
  GpioLines lines{GpioSetup{}};
  EXPECT_FALSE(lines.rt_estop());
  EXPECT_TRUE(lines.rt_drive(true, true));
  EXPECT_FALSE(lines.has_estop());
}

TEST(GpioLines, AChipThatIsNoneIsASentenceWithTheCure) {
  for (const char* chip : {"/dev/gpiochip99", "/dev/null"}) {
    try {
      GpioSetup setup;
      setup.chip = chip;
      setup.estop = GpioSetup::Line{.offset = 3};
      const GpioLines lines(setup);
      FAIL() << chip;
    } catch (const std::runtime_error& problem) {
      EXPECT_NE(std::string(problem.what()).find(chip), std::string::npos);
      EXPECT_NE(std::string(problem.what()).find("; "), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace capstan
