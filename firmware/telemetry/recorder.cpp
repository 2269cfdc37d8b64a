// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/telemetry/recorder.hpp"

namespace capstan {

void choose_signals(RecorderSetup& setup, std::size_t axis, std::span<const std::string_view> names) {
  setup.count = 0;
  setup.every = 1;
  for (const std::string_view name : names) {
    for (const SignalInfo& info : joint_signals()) {
      if (name == info.name) {
        setup.signals[setup.count++] = {&info, static_cast<std::uint8_t>(axis)};
      }
    }
  }
  setup.signals[setup.count++] = find_signal("machine.experiment", 0);
}

auto Recorder::start(const void* owner, const RecorderSetup& setup) -> bool {
  if (owner_ != nullptr && owner_ != owner) {
    return false;
  }
  RecorderSetup next = setup;
  next.run = run_ + 1;
  if (!box_.offer(next)) {
    return false;
  }
  SignalSample old;
  while (samples_.pop(old)) {  // what nobody fetched would leave no room
  }
  run_ = next.run;
  owner_ = owner;
  on_.store(true, std::memory_order_relaxed);
  return true;
}

void Recorder::stop(const void* owner) {
  if (owner_ == owner) {
    on_.store(false, std::memory_order_relaxed);
    owner_ = nullptr;
  }
}

auto Recorder::next(SignalSample& sample) -> bool {
  while (samples_.pop(sample)) {
    if (sample.run == run_) {
      return true;
    }
  }
  return false;
}

void Recorder::rt_step(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) {
  if (const RecorderSetup* next = box_.rt_peek()) {
    setup_ = *next;
    box_.rt_taken();
  }
  if (!on_.load(std::memory_order_relaxed) || machine.tick % setup_.every != 0) {
    return;
  }
  SignalSample sample{.tick = machine.tick, .run = setup_.run};
  for (std::size_t i = 0; i < setup_.count; ++i) {
    sample.raw[i] = rt_raw(setup_.signals[i], machine, axes);
  }
  samples_.rt_push(sample);
}

}  // namespace capstan
