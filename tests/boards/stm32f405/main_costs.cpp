// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator: what each law and term costs on this core. Prints "cost NAME MEAN MAX", instructions of
// one call over random and adversarial input; tools/law_table makes the table of model/README.md of it.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "boards/stm32f405/host_sink.hpp"
#include "firmware/text.hpp"
#include "hal/stm32f4/memory_map.hpp"
#include "hal/stm32f4/semihosting.hpp"
#include "hal/stm32f4/tick.hpp"
#include "model/coupled_axes.hpp"
#include "model/effort_catalogue.hpp"
#include "model/motion_law.hpp"
#include "model/preisach.hpp"
#include "model/pull_push.hpp"
#include "model/tension_state.hpp"

namespace {

using namespace capstan;
namespace semihosting = stm32f4::semihosting;

constexpr std::uint32_t kCoreHz = 168'000'000;  // at which the emulator's timer counts
constexpr int kCalls = 1000;

stm32f4::Tick<stm32f4::MemoryRegister> tick{stm32f4::systick_registers()};

/// Numbers that look like chance, the same every run.
class Chance {
 public:
  /// In [-size, size).
  auto within(Q24 size) -> Q24 {
    state_ = state_ * 1664525U + 1013904223U;
    return size * Q30::from_raw(static_cast<std::int32_t>(state_) / 2);
  }

 private:
  std::uint32_t state_ = 12345;
};
Chance chance;

/// Keeps the compiler from working anything out beforehand, or from leaving it out.
template <typename T>
void touch(T& value) {
  asm volatile("" : : "r"(&value) : "memory");
}

/// Ticks of one call, or nothing if the timer began anew meanwhile. The timer's interrupt is held off.
template <typename Work>
auto ticks_of(Work&& work, std::uint32_t& ticks) -> bool {
  asm volatile("cpsid i" : : : "memory");
  const std::uint32_t begin = tick.since_edge();
  asm volatile("" : : : "memory");
  work();
  asm volatile("" : : : "memory");
  const std::uint32_t end = tick.since_edge();
  asm volatile("cpsie i" : : : "memory");
  ticks = end - begin;
  return end > begin;
}

/// @param prepare  called before each call and not counted
template <typename Prepare, typename Work>
void measure(Print& out, std::string_view name, Prepare&& prepare, Work&& work) {
  static std::uint32_t overhead = 0;
  if (overhead == 0) {
    overhead = std::numeric_limits<std::uint32_t>::max();
    for (int i = 0; i < 100; ++i) {
      std::uint32_t ticks = 0;
      overhead = ticks_of([] {}, ticks) ? std::min(overhead, ticks) : overhead;
    }
  }
  std::uint32_t sum = 0;
  std::uint32_t max = 0;
  std::uint32_t calls = 0;
  for (int i = 0; i < kCalls; ++i) {
    prepare(i);
    std::uint32_t ticks = 0;
    if (ticks_of(work, ticks)) {
      const std::uint32_t own = ticks > overhead ? ticks - overhead : 0;
      sum += own;
      max = std::max(max, own);
      ++calls;
    }
  }
  out << "cost " << name << " " << stm32f4::emulated_instructions(sum, kCoreHz) / std::max<std::uint32_t>(1, calls)
      << " " << stm32f4::emulated_instructions(max, kCoreHz) << "\n";
}

/// One motion for all: a walk with reversals, torque and angle.
struct Walk {
  Q24 q1{};
  Q24 tau{};
  void step(int i) {
    const Q24 stride =
        chance.within(Q24::from_double(0.02)) + (i % 200 < 100 ? Q24::from_double(0.01) : Q24::from_double(-0.01));
    q1 += stride;
    tau = clamp(tau + stride * Q24::from_double(0.3) + chance.within(Q24::from_double(0.01)), Q24::from_double(-0.2),
                Q24::from_double(0.2));
  }
};

/// Every effect on, so that nothing is left out.
constexpr auto law_parameters() -> LawParameters<Q24> {
  LawParameters<Q24> parameters;
  parameters.coefficients.fill(Q24::from_double(0.05));
  parameters.coefficients[0] = Q24::from_double(1.08);
  std::size_t next = 0;
  const auto add = [&]<typename Term>() {
    for (const auto& shape : Term::kInfo.shapes) {
      parameters.shapes[next++] = Q24::from_double(shape.initial);
    }
  };
  SumTerms::for_each<Q24>(add);
  OutputTerms::for_each<Q24>(add);
  return parameters;
}
constexpr LawParameters<Q24> kLaw = law_parameters();
MotionLaw<Q24> law(SamplePeriod<Q24>(1000), kLaw);

void measure_motion_law(Print& out) {
  Walk walk;
  Estimate<Q24> estimate;
  measure(
      out, "motion_law", [&](int i) { walk.step(i); },
      [&] {
        estimate = law.update(walk.q1, walk.tau);
        touch(estimate);
      });
  Q24 angle;
  measure(
      out, "motion_law_inverse", [&](int i) { walk.step(i); },
      [&] {
        angle = law.invert(walk.q1, law.sample());
        touch(angle);
      });
}

template <typename Term>
constexpr auto initial_shape() -> std::array<Q24, kShapesOf<Term>> {
  std::array<Q24, kShapesOf<Term>> shape{};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    shape[i] = Q24::from_double(Term::kInfo.shapes[i].initial);
  }
  return shape;
}

template <typename List>
void measure_terms(Print& out) {
  List::template for_each<Q24>([&out]<typename Term>() {
    static constexpr auto kShape = initial_shape<Term>();
    static Term term(SamplePeriod<Q24>(1000), kShape);
    SampleConditioner<Q24> conditioner(SamplePeriod<Q24>(1000), kLaw.conditioner);
    Walk walk;
    measure(
        out, Term::kInfo.name,
        [&](int i) {
          walk.step(i);
          conditioner.update(walk.q1, walk.tau);
        },
        [&] {
          auto regressors = term.update(conditioner.sample());
          touch(regressors);
        });
  });
}

/// Relays spread evenly: f_ab is the area below a and b.
template <std::size_t Levels>
auto even_table() -> const ReversalTable<Q24, Levels>& {
  static ReversalTable<Q24, Levels> table;
  table.levels = Levels;
  for (std::size_t a = 0; a < Levels; ++a) {
    const auto ia = static_cast<std::int32_t>(a);
    table.inputs[a] = Q24::from_raw((2 * ia - static_cast<std::int32_t>(Levels) + 1) * 100'000);
    for (std::size_t b = 0; b <= a; ++b) {
      const auto ib = static_cast<std::int32_t>(b);
      table.set_force(a, b, Q24::from_raw((2 * ia * ib - ib * ib) * 1000));
    }
  }
  return table;
}

// Worst: a memory full of nested loops, wiped out by one step to the end of the table.
template <std::size_t Levels>
void measure_preisach(Print& out, std::string_view name, std::string_view inverse) {
  const auto& table = even_table<Levels>();
  static Preisach<Q24, Levels> preisach(table);
  const Q24 end = table.inputs[Levels - 1];
  const auto nest = [&](int i) {
    if (i % 50 == 0) {
      preisach.reset(StartState::kNegativeSaturation);
      for (std::int32_t k = 0; k < 61; ++k) {
        const Q24 size = Q24::from_raw(end.raw() / 64 * (63 - k));
        preisach.update(k % 2 == 0 ? size : -size);
      }
    }
  };
  Q24 input;
  ForceEstimate<Q24> estimate;
  measure(
      out, name,
      [&](int i) {
        nest(i);
        input = i % 50 == 0 ? end : chance.within(end);
      },
      [&] {
        estimate = preisach.update(input);
        touch(estimate);
      });
  const Q24 largest = table.force(Levels - 1, Levels - 1);
  InputCommand<Q24> command;
  measure(
      out, inverse,
      [&](int i) {
        nest(i);
        input = i % 50 == 0 ? largest : (chance.within(largest) + largest) * Q24::from_double(0.5);
      },
      [&] {
        command = preisach.input_for(input);
        touch(command);
      });
}

void measure_force_laws(Print& out) {
  constexpr PullPushParameters<Q24> kForceps = {Q24::from_double(1.1414), Q24::from_double(1.1404),
                                                Q24::from_double(0.072),  Q24::from_double(0.923),
                                                Q24::from_double(0.59),   Q24::from_double(0.47)};
  static PullPush<Q24> pull_push(kForceps);
  Walk walk;
  ForceEstimate<Q24> estimate;
  measure(
      out, "pull_push", [&](int i) { walk.step(i); },
      [&] {
        estimate = pull_push.update(walk.tau, true);
        touch(estimate);
      });
  constexpr TensionStateParameters<Q24> kState = {Q24::from_double(1.1414), Q24::from_double(1.1404),
                                                  Q24::from_double(0.072),  Q24::from_double(2.92),
                                                  Q24::from_double(2.91),   Q24::from_double(1.083)};
  static TensionState<Q24> state(kState);
  TensionStateEstimate<Q24> both;
  Q24 tau;
  measure(
      out, "tension_state", [&](int i) { walk.step(i); },
      [&] {
        both = state.update(walk.q1, walk.tau, true);
        touch(both);
      });
  measure(
      out, "tension_state_jumps", [&](int) { tau = chance.within(Q24::from_double(0.25)); },
      [&] {
        both = state.update(walk.q1, tau, true);
        touch(both);
      });
}

void measure_coupled_axes(Print& out) {
  constexpr CouplingMatrices<Q24, 3> kWrist =
      coupling_of(WristTransmission<Q24>{Q24::from_double(0.996),
                                         Q24::from_double(1.109),
                                         Q24::from_double(1.138),
                                         Q24::from_double(0.674),
                                         Q24::from_double(0.664),
                                         {Q24::from_double(-0.424), Q24::from_double(-2.828)},
                                         {Q24::from_double(-1.907), Q24::from_double(-1.054)},
                                         {Q24::from_double(-1.047), Q24::from_double(-0.541)}});
  static CoupledAxes<Q24, 3> wrist(kWrist);
  std::array<Q24, 3> q{};
  std::array<Q24, 3> tau{};
  std::array<Q24, 3> theta{};
  const auto draw = [&](int) {
    for (std::size_t i = 0; i < 3; ++i) {
      q[i] = chance.within(Q24::from_int(3));
      tau[i] = chance.within(Q24::from_double(0.2));
    }
  };
  measure(out, "coupled_axes_3", draw, [&] {
    theta = wrist.joints(q, tau, {true, false, true});
    touch(theta);
  });
  measure(out, "coupled_axes_3_inverse", draw, [&] {
    theta = wrist.motors(q, tau, {true, false, true});
    touch(theta);
  });
}

}  // namespace

extern "C" {

void rt_release_outputs() {
  semihosting::exit(20);
}
void rt_systick_isr() {
  tick.rt_isr();
}
void rt_cycle_isr() {
  semihosting::exit(20);
}
void rt_usart1_isr() {
  semihosting::exit(20);
}

}  // extern "C"

int main() {
  stm32f405::HostSink sink;
  Print out(sink);
  if (!tick.start(kCoreHz, 1000)) {
    semihosting::exit(21);
  }
  measure_motion_law(out);
  measure_terms<SumTerms>(out);
  measure_terms<EffortTerms>(out);
  measure_preisach<11>(out, "preisach_11", "preisach_11_inverse");
  measure_preisach<41>(out, "preisach_41", "preisach_41_inverse");
  measure_force_laws(out);
  measure_coupled_axes(out);
  semihosting::exit(0);
}
