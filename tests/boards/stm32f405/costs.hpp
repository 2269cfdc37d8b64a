// SPDX-License-Identifier: Apache-2.0
#pragma once

// What each law and term costs on this core, in one number format; tools/law_table makes the table of
// docs/laws_measured.md of it.
#include <array>
#include <cstdint>
#include <string_view>

#include "capstan/model/effort_catalogue.hpp"
#include "capstan/model/motion_law.hpp"
#include "capstan/model/preisach.hpp"
#include "capstan/model/pull_push.hpp"
#include "capstan/model/tension_state.hpp"
#include "capstan/tests/boards/stm32f405/cost_meter.hpp"

namespace capstan::costs {

/// A measured number as a law of this format can take it. Fixed point takes all there are. In float one that is not
/// finite would stay in every state for ever, and fixed point's +-128 have to be looked at: the same duty, no more.
template <typename Scalar>
auto admitted(Scalar x, bool& beyond) -> Scalar {
  if constexpr (std::is_same_v<Scalar, float>) {
    constexpr float kEnd = 128.0F;
    if (!(abs(x) < kEnd)) [[unlikely]] {
      beyond = true;
      return x >= kEnd ? kEnd : (x <= -kEnd ? -kEnd : 0.0F);
    }
  }
  return x;
}
/// One cycle of a motion law with its flag.
template <typename Scalar>
[[gnu::always_inline]] inline auto update(MotionLaw<Scalar>& law, Scalar q1, Scalar tau) -> Estimate<Scalar> {
  bool beyond = false;
  const Scalar angle = admitted(q1, beyond);
  const Scalar torque = admitted(tau, beyond);
  Estimate<Scalar> estimate = law.update(angle, torque);
  admitted(estimate.q2, beyond);
  estimate.saturated |= beyond;
  return estimate;
}

/// Where the coefficient of the tendons stands.
template <typename Scalar>
consteval auto place_of_tendons() -> std::size_t {
  std::size_t next = 0;
  std::size_t place = 0;
  SumTerms::for_each<Scalar>([&]<typename Term>() {
    place = std::is_same_v<Term, Tendons<Scalar>> ? next : place;
    next += kCoefficientsOf<Term>;
  });
  return place;
}

/// Every effect on, so that nothing is left out, but for the tendons themselves: they stand for the elongation and most
/// of what builds on it, in laws of their own.
template <typename Scalar>
consteval auto law_parameters() -> LawParameters<Scalar> {
  LawParameters<Scalar> parameters;
  parameters.coefficients.fill(from<Scalar>(0.05));
  parameters.coefficients[0] = from<Scalar>(1.08);
  std::size_t next = 0;
  const auto add = [&]<typename Term>() {
    for (const auto& shape : Term::kInfo.shapes) {
      // What may be idle is not: its weight is none of its starting values.
      const bool idle = shape.idle_without >= 0 && shape.initial == 0.0;
      parameters.shapes[next++] = ScalarTraits<Scalar>::from(idle ? 0.05 : shape.initial);
    }
  };
  for_each_term<Scalar>(add);
  parameters.coefficients[place_of_tendons<Scalar>()] = Scalar{};
  return parameters;
}
/// Ratio, offset and tendons: what `capstan identify --model tendon` finds.
template <typename Scalar>
consteval auto tendon_parameters() -> LawParameters<Scalar> {
  LawParameters<Scalar> parameters = law_parameters<Scalar>();
  parameters.coefficients.fill(Scalar{});
  parameters.coefficients[0] = from<Scalar>(1.08);
  parameters.coefficients[1] = from<Scalar>(0.02);
  parameters.coefficients[place_of_tendons<Scalar>()] = from<Scalar>(-5.8);
  for (std::size_t i = 0; i < InputTerms::kShapes; ++i) {
    parameters.shapes[i] = Scalar{};
  }
  return parameters;
}
template <typename Scalar>
constexpr auto period() -> SamplePeriod<Scalar> {
  if constexpr (std::is_same_v<Scalar, Q24>) {
    return SamplePeriod<Q24>(1000);
  } else {
    return SamplePeriod<Scalar>(ScalarTraits<Scalar>::from(0.001));
  }
}
template <typename Scalar>
inline constexpr LawParameters<Scalar> kLaw = law_parameters<Scalar>();

template <typename Scalar>
void measure_motion_law(Print& out) {
  static MotionLaw<Scalar> law(period<Scalar>(), kLaw<Scalar>);
  Walk<Scalar> walk;
  Estimate<Scalar> estimate;
  measure(
      out, "motion_law", [&](int i) { walk.step(i); },
      [&] {
        estimate = update(law, walk.q1, walk.tau);
        touch(estimate);
      });
  Scalar angle;
  measure(
      out, "motion_law_inverse", [&](int i) { walk.step(i); },
      [&] {
        angle = law.invert(walk.q1, law.sample());
        touch(angle);
      });
}

template <typename Scalar, typename Term>
consteval auto initial_shape() -> std::array<Scalar, kShapesOf<Term>> {
  std::array<Scalar, kShapesOf<Term>> shape{};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const ShapeInfo& info = Term::kInfo.shapes[i];
    shape[i] = ScalarTraits<Scalar>::from(info.idle_without >= 0 && info.initial == 0.0 ? 0.05 : info.initial);
  }
  return shape;
}

template <typename Scalar, typename List>
void measure_terms(Print& out) {
  List::template for_each<Scalar>([&out]<typename Term>() {
    static constexpr auto kShape = initial_shape<Scalar, Term>();
    static Term term(period<Scalar>(), kShape);
    SampleConditioner<Scalar> conditioner(period<Scalar>(), kLaw<Scalar>.conditioner);
    Walk<Scalar> walk;
    measure(
        out, Term::kInfo.name,
        [&](int i) {
          walk.step(i);
          conditioner.update(walk.q1, walk.tau);
          conditioner.delay_torque();
        },
        [&] {
          auto regressors = term.update(conditioner.sample());
          touch(regressors);
        });
  });
}

/// Relays spread evenly: f_ab is the area below a and b.
template <typename Scalar, std::size_t Levels>
auto even_table() -> const ReversalTable<Scalar, Levels>& {
  static ReversalTable<Scalar, Levels> table;
  table.levels = Levels;
  for (std::size_t a = 0; a < Levels; ++a) {
    const auto ia = static_cast<std::int32_t>(a);
    table.inputs[a] = number<Scalar>((2 * ia - static_cast<std::int32_t>(Levels) + 1) * 100'000);
    for (std::size_t b = 0; b <= a; ++b) {
      const auto ib = static_cast<std::int32_t>(b);
      table.set_force(a, b, number<Scalar>((2 * ia * ib - ib * ib) * 1000));
    }
  }
  return table;
}

/// Before every fiftieth step: a memory full of nested loops, to be wiped out by one step to the end of the table.
template <typename Scalar, std::size_t Levels>
void nest_loops(Preisach<Scalar, Levels>& preisach, Scalar end, int step) {
  if (step % 50 == 0) {
    preisach.reset(StartState::kNegativeSaturation);
    for (std::int32_t k = 0; k < 61; ++k) {
      const Scalar size = end * number<Scalar>((63 - k) * (1 << 18));
      preisach.update(k % 2 == 0 ? size : -size);
    }
  }
}

template <typename Scalar, std::size_t Levels>
void measure_preisach(Print& out, std::string_view name, std::string_view inverse) {
  const auto& table = even_table<Scalar, Levels>();
  static Preisach<Scalar, Levels> preisach(table);
  const Scalar end = table.inputs[Levels - 1];
  Scalar input;
  ForceEstimate<Scalar> estimate;
  measure(
      out, name,
      [&](int i) {
        nest_loops(preisach, end, i);
        input = i % 50 == 0 ? end : chance<Scalar>.within(end);
      },
      [&] {
        estimate = preisach.update(input);
        touch(estimate);
      });
  const Scalar largest = table.force(Levels - 1, Levels - 1);
  InputCommand<Scalar> command;
  measure(
      out, inverse,
      [&](int i) {
        nest_loops(preisach, end, i);
        input = i % 50 == 0 ? largest : (chance<Scalar>.within(largest) + largest) * from<Scalar>(0.5);
      },
      [&] {
        command = preisach.input_for(input);
        touch(command);
      });
}

template <typename Scalar>
void measure_force_laws(Print& out) {
  constexpr PullPushParameters<Scalar> kForceps = {from<Scalar>(1.1414), from<Scalar>(1.1404), from<Scalar>(0.072),
                                                   from<Scalar>(0.923),  from<Scalar>(0.59),   from<Scalar>(0.47)};
  static PullPush<Scalar> pull_push(kForceps);
  Walk<Scalar> walk;
  ForceEstimate<Scalar> estimate;
  measure(
      out, "pull_push", [&](int i) { walk.step(i); },
      [&] {
        bool beyond = false;
        estimate = pull_push.update(admitted(walk.tau, beyond), true);
        estimate.saturated |= beyond;
        touch(estimate);
      });
  Scalar wanted;
  measure(
      out, "pull_push_inverse",
      [&](int i) {
        walk.step(i);
        estimate = pull_push.update(walk.tau, true);
        wanted = chance<Scalar>.within(from<Scalar>(0.15));
      },
      [&] {
        Scalar command = pull_push.input_for(wanted, walk.tau);
        touch(command);
      });
  constexpr TensionStateParameters<Scalar> kState = {from<Scalar>(1.1414), from<Scalar>(1.1404), from<Scalar>(0.072),
                                                     from<Scalar>(2.92),   from<Scalar>(2.91),   from<Scalar>(1.083)};
  static TensionState<Scalar> state(kState);
  TensionStateEstimate<Scalar> both;
  Scalar tau;
  measure(
      out, "tension_state", [&](int i) { walk.step(i); },
      [&] {
        bool beyond = false;
        both = state.update(admitted(walk.q1, beyond), admitted(walk.tau, beyond), true);
        both.saturated |= beyond;
        touch(both);
      });
  measure(
      out, "tension_state_jumps", [&](int) { tau = chance<Scalar>.within(from<Scalar>(0.25)); },
      [&] {
        bool beyond = false;
        both = state.update(admitted(walk.q1, beyond), admitted(tau, beyond), true);
        both.saturated |= beyond;
        touch(both);
      });
}

/// The joint of two tendons, as a walk of the motor drives it and under torques that jump.
template <typename Scalar>
void measure_tendon_law(Print& out) {
  static constexpr LawParameters<Scalar> kTendons = tendon_parameters<Scalar>();
  static MotionLaw<Scalar> law(period<Scalar>(), kTendons);
  Walk<Scalar> walk;
  Estimate<Scalar> estimate;
  measure(
      out, "tendon_law", [&](int i) { walk.step(i); },
      [&] {
        estimate = update(law, walk.q1, walk.tau);
        touch(estimate);
      });
  Scalar tau;
  measure(
      out, "tendon_law_jumps",
      [&](int i) {
        walk.step(i);
        tau = chance<Scalar>.within(from<Scalar>(0.25));
      },
      [&] {
        estimate = update(law, walk.q1, tau);
        touch(estimate);
      });
}

/// One axis of one cycle, at its worst: the law with every effect on, and a Preisach model whose memory is full. The
/// motor jumps and turns, and every fiftieth step wipes out all loops at once.
template <typename Scalar>
void measure_axis(Print& out) {
  static MotionLaw<Scalar> law(period<Scalar>(), kLaw<Scalar>);
  const auto& table = even_table<Scalar, 41>();
  static Preisach<Scalar, 41> preisach(table);
  const Scalar end = table.inputs[40];
  Scalar q1{};
  Scalar tau{};
  Estimate<Scalar> angle;
  ForceEstimate<Scalar> force;
  measure(
      out, "axis_law_and_preisach_41",
      [&](int i) {
        constexpr Scalar kFar = from<Scalar>(30.0);
        constexpr Scalar kNear = from<Scalar>(0.05);
        q1 = chance<Scalar>.within(i % 3 == 0 ? kFar : kNear);
        nest_loops(preisach, end, i);
        tau = i % 50 == 0 ? end : chance<Scalar>.within(end);
      },
      [&] {
        angle = update(law, q1, tau);
        force = preisach.update(tau);
        touch(angle);
        touch(force);
      });
}

}  // namespace capstan::costs
