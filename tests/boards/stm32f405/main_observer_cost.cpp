// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator: what the motor observer of one joint costs in a cycle while it works. The replayed run
// of the cycle has joints that are not commissioned.
#include <algorithm>

#include "capstan/firmware/safety/motor_observer.hpp"
#include "capstan/tests/boards/stm32f405/cost_meter.hpp"

namespace capstan::costs {
namespace {

/// The forceps as `commission` finds them.
auto forceps() -> AxisConfig {
  AxisConfig config;
  config.observer = {.inertia_gm2 = from<Q24>(0.02),
                     .coulomb_nm = from<Q24>(0.005),
                     .against_nm = from<Q24>(0.02),
                     .slack_counts = from<Q24>(2.0),
                     .noise_a = from<Q24>(0.004),
                     .stiffness_nm_per_rad = from<Q24>(2.5),
                     .excess_nm = from<Q24>(0.02),
                     .answer_rad_per_a = from<Q24>(0.005)};
  config.observer.answer_gains = LookAnswer::mark(config.control);
  return config;
}

/// A motor on a spring that slides: at rest with looks, or to and fro.
struct Motor {
  std::int32_t top_speed;  ///< counts in a cycle
  Q24 torque{};
  std::int32_t speed = 0;
  std::int32_t pushed = 0;  ///< by the look, counts
  MotorState state;

  void step(int i, Q24 look) {
    constexpr int kPeriod = 400;
    constexpr Q24 kCount = from<Q24>(0.0038);  // A
    constexpr Q24 kFriction = from<Q24>(0.9);
    const int place = i % kPeriod;
    const int up = place < kPeriod / 2 ? 1 : -1;
    const int since = place % (kPeriod / 2);
    speed = up * std::min<std::int32_t>({since / 4, top_speed, (kPeriod / 2 - 1 - since) / 4});
    const std::int32_t answer = (look * from<Q24>(100.0)).raw() >> 24;
    torque = clamp(torque + kCount * Q24::from_raw(speed << 20) * from<Q24>(16.0), -kFriction, kFriction);
    state.counts += speed + answer - pushed;
    pushed = answer;
    state.current_a = torque + look + chance<Q24>.within(from<Q24>(0.008));
  }
};

/// 1000 cycles. Any fault would make the figure one of a joint that has stopped.
void measure_observer(Print& out, std::string_view name, std::int32_t top_speed) {
  static const AxisConfig config = forceps();
  MotorObserver observer(config);
  Motor motor{.top_speed = top_speed, .state = {}};
  static_cast<void>(observer.rt_step(motor.state, Q24{}, false));
  observer.rt_arm();
  Q24 drive{};
  Q24 look{};
  FaultSet faults = 0;
  measure(
      out, name,
      [&](int i) {
        motor.step(i, look);
        drive = motor.torque + look;
      },
      [&] {
        faults |= observer.rt_step(motor.state, drive, true);
        look = observer.rt_look();
        touch(observer);
      });
  if (faults != 0) {
    out << "the observer stopped a healthy motor: " << faults << "\n";
    stm32f4::semihosting::exit(22);
  }
}

}  // namespace
}  // namespace capstan::costs

int main() {
  using namespace capstan;
  using namespace capstan::costs;
  stm32f405::HostSink sink;
  Print out(sink);
  if (!tick.start(kCoreHz, 1000)) {
    semihosting::exit(21);
  }
  measure_observer(out, "observer_at_rest", 0);
  measure_observer(out, "observer_slow", 3);
  measure_observer(out, "observer_fast", 40);
  semihosting::exit(0);
}
