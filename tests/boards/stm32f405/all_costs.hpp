// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tests/boards/stm32f405/costs.hpp"
#include "capstan/tests/boards/stm32f405/torque_costs.hpp"

namespace capstan::costs {

/// Every law and term in one number format; does not return.
template <typename Scalar>
[[noreturn]] void measure_everything() {
  stm32f405::HostSink sink;
  Print out(sink);
  if (!tick.start(kCoreHz, 1000)) {
    stm32f4::semihosting::exit(21);
  }
  measure_axis<Scalar>(out);
  measure_motion_law<Scalar>(out);
  measure_terms<Scalar, InputTerms>(out);
  measure_terms<Scalar, SumTerms>(out);
  measure_terms<Scalar, EffortTerms>(out);
  measure_torque_law<Scalar, false>(out, "servo_effort_law", "servo_effort_feedforward");
  measure_torque_law<Scalar, true>(out, "whole_effort_law", "whole_effort_feedforward");
  measure_preisach<Scalar, 11>(out, "preisach_11", "preisach_11_inverse");
  measure_preisach<Scalar, 41>(out, "preisach_41", "preisach_41_inverse");
  measure_force_laws<Scalar>(out);
  measure_tendon_law<Scalar>(out);
  stm32f4::semihosting::exit(0);
}

}  // namespace capstan::costs
