// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/telemetry/scope.hpp"
#include "capstan/firmware/loop/expect.hpp"

namespace capstan {

auto Scope::start(const ScopeSetup& setup) -> bool {
  CAPSTAN_EXPECT(setup.samples == 0 ||
                 (setup.channel_count >= 1 && setup.channel_count <= ScopeSetup::kMostChannels &&
                  setup.samples * setup.channel_count <= kWords && setup.before < setup.samples && setup.every >= 1));
  return readers_ == 0 && box_.offer(setup);
}

auto Scope::begin_reading() -> bool {
  const bool there = box_.empty() && phase() == Phase::kDone;
  readers_ += there ? 1 : 0;
  return there;
}

auto Scope::cycles_from_trigger(std::size_t sample) const -> std::int32_t {
  const auto before = static_cast<std::int32_t>(stored_ - after_);
  return (static_cast<std::int32_t>(sample) - before) * static_cast<std::int32_t>(setup_.every);
}

auto Scope::raw(std::size_t sample, std::size_t channel) const -> std::int32_t {
  CAPSTAN_EXPECT(sample < stored_ && channel < setup_.channel_count);
  const std::size_t oldest = stored_ < setup_.samples ? 0 : next_;
  const std::size_t place = oldest + sample;
  return words_[(place < setup_.samples ? place : place - setup_.samples) * setup_.channel_count + channel];
}

void Scope::rt_take(const MachineTelemetry& machine) {
  setup_ = *box_.rt_peek();
  next_ = 0;
  stored_ = 0;
  after_ = 0;
  skip_ = 0;
  has_last_ = false;
  overruns_first_ = machine.overruns;
  phase_.store(setup_.samples == 0 ? Phase::kIdle : Phase::kWaiting, std::memory_order_release);
  box_.rt_taken();
}

auto Scope::rt_triggered(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) -> bool {
  if (setup_.trigger == ScopeTrigger::kNow) {
    return stored_ >= setup_.before;
  }
  if (setup_.trigger == ScopeTrigger::kFault) {
    return machine.first_fault != Fault::kNone;
  }
  const std::int32_t now = rt_raw(setup_.trigger_signal, machine, axes);
  const bool above = now >= setup_.level;
  const bool was_above = has_last_ ? last_ >= setup_.level : above;
  last_ = now;
  has_last_ = true;
  switch (setup_.trigger) {
    case ScopeTrigger::kRising:
      return above && !was_above;
    case ScopeTrigger::kFalling:
      return !above && was_above;
    case ScopeTrigger::kAbove:
      return above;
    default:
      return !above;
  }
}

void Scope::rt_store(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) {
  std::int32_t* place = &words_[next_ * setup_.channel_count];
  for (std::size_t i = 0; i < setup_.channel_count; ++i) {
    place[i] = rt_raw(setup_.channels[i], machine, axes);
  }
  next_ = next_ + 1 == setup_.samples ? 0 : next_ + 1;
  stored_ += stored_ < setup_.samples ? 1 : 0;
}

void Scope::rt_step(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) {
  if (box_.rt_peek() != nullptr) {
    rt_take(machine);
  }
  Phase phase = phase_.load(std::memory_order_relaxed);
  if (phase != Phase::kWaiting && phase != Phase::kFilling) {
    return;
  }
  if (skip_ > 0) {
    --skip_;
    return;
  }
  skip_ = setup_.every - 1;
  if (phase == Phase::kWaiting && rt_triggered(machine, axes)) {
    phase = Phase::kFilling;
    trigger_tick_ = machine.tick;
    // Of what was stored so far only the newest `before` samples count.
    const std::size_t before = stored_ < setup_.before ? stored_ : setup_.before;
    stored_ = before;
  }
  rt_store(machine, axes);
  overruns_last_ = machine.overruns;
  if (phase == Phase::kFilling) {
    ++after_;
    phase = after_ + setup_.before == setup_.samples ? Phase::kDone : phase;
  }
  phase_.store(phase, std::memory_order_release);
}

}  // namespace capstan
