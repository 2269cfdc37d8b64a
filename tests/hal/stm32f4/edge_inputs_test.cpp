// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/edge_inputs.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {
namespace {

class EdgeInputs : public testing::Test {
 protected:
  EdgeInputs() { exti.pr.on_write = write_one_to_clear(0x7F'FFFF); }
  ExtiRegisters<FakeRegister> exti;
  SyscfgRegisters<FakeRegister> syscfg;
};

TEST_F(EdgeInputs, EachPinGetsItsPortAndOnlyItsRisingEdge) {
  syscfg.exticr[2].value = 0x1234;
  exti.imr.value = 0x3;
  exti.pr.value = 0x401;  // line 10 had an edge before
  start_rising_edge(exti, syscfg, Pin{Port::kB, 10, PinMode::kInput});
  EXPECT_EQ(syscfg.exticr[2].value, 0x1134U) << "line 10 is the third of its register, port B is 1";
  start_rising_edge(exti, syscfg, Pin{Port::kD, 15, PinMode::kInput});
  EXPECT_EQ(syscfg.exticr[3].value, 0x3000U);
  EXPECT_EQ(exti.rtsr.value, 0x8400U);
  EXPECT_EQ(exti.ftsr.value, 0U);
  EXPECT_EQ(exti.imr.value, 0x8403U);
  EXPECT_EQ(exti.pr.value, 0x1U) << "the old edge is forgotten, another line's is not";
}

TEST_F(EdgeInputs, AnEdgeIsTakenOnceAndTheOthersStay) {
  exti.pr.value = 0xA400;
  const Pin pin{Port::kB, 13, PinMode::kInput};
  EXPECT_TRUE(rt_take_edge(exti, pin));
  EXPECT_EQ(exti.pr.value, 0x8400U);
  EXPECT_FALSE(rt_take_edge(exti, pin));
  EXPECT_EQ(exti.pr.value, 0x8400U);
}

}  // namespace
}  // namespace capstan::stm32f4
