// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/fault_log.hpp"

#include <algorithm>
#include <string_view>

#include "capstan/firmware/loop/expect.hpp"

namespace capstan {
namespace {

constexpr std::uint32_t kMagicOfThisLayout = 0x334C4643;  // "CFL3"; another layout has another

// Coarse, so that the file of a host's memory is not written anew in every cycle in which a winding cools.
constexpr unsigned kHeatShift = Q24::kFrac - 4;
constexpr std::uint32_t kHeatOf1 = 1U << 4U;
constexpr std::uint32_t kMostHeat = 8 * kHeatOf1;  // more than any current leads to

constexpr std::array<std::string_view, FaultLog::kSignals> kNames = {"q1", "torque", "q2", "reference"};

auto packed(const FaultEntry& entry) -> std::uint32_t {
  return static_cast<std::uint32_t>(entry.fault) | static_cast<std::uint32_t>(entry.state) << 8U |
         static_cast<std::uint32_t>(entry.joints) << 16U;
}

// The memory is plain words, which outlive this object. std::atomic_ref would say the same, and clang 14's library
// lacks it.
auto acquire(const std::uint32_t& word) -> std::uint32_t {
  return __atomic_load_n(&word, __ATOMIC_ACQUIRE);
}
void rt_release(std::uint32_t& word, std::uint32_t value) {
  __atomic_store_n(&word, value, __ATOMIC_RELEASE);
}

/// What the cycle writes while others may copy the memory.
void rt_put(std::uint32_t& word, std::uint32_t value) {
  __atomic_store_n(&word, value, __ATOMIC_RELAXED);
}

auto joints_with(Fault fault, std::span<const AxisTelemetry> axes) -> std::uint8_t {
  unsigned joints = 0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    joints |= (axes[i].faults & bit(fault)) != 0 ? 1U << i : 0U;
  }
  return static_cast<std::uint8_t>(joints);
}

}  // namespace

auto FaultLog::signals() -> std::array<const SignalInfo*, kSignals> {
  std::array<const SignalInfo*, kSignals> found{};
  for (std::size_t i = 0; i < kSignals; ++i) {
    for (const SignalInfo& info : joint_signals()) {
      found[i] = kNames[i] == info.name ? &info : found[i];
    }
  }
  return found;
}

FaultLog::FaultLog(std::span<std::uint32_t> memory, std::size_t axes)
    : memory_(memory.size() >= words_for(axes) ? memory : std::span<std::uint32_t>{}), axes_(axes) {
  if (memory_.empty()) {
    return;
  }
  const std::uint32_t magic = kMagicOfThisLayout + static_cast<std::uint32_t>(axes);
  // Indices are looked at too: what power-on leaves may have the magic by a stale image, and nothing else right.
  const bool whole = memory_[kMagic] == magic && memory_[kPhase] <= kFrozen && memory_[kNext] < kSamples &&
                     memory_[kStored] <= kSamples;
  if (!whole) {
    std::fill(memory_.begin(), memory_.end(), 0U);
    memory_[kMagic] = magic;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      memory_[heat_word(axis, axes)] = kHeatOf1;  // nobody knows how hot they were when power went
    }
  }
  const std::uint32_t last_start = memory_[kStarts]++;
  if (phase() == kRunning) {  // nobody took the torque away: the run ended by itself
    rt_add({.start = last_start, .tick = memory_[kLastTick], .state = State::kArmed});
    memory_[kKept] = memory_[kFaults];
    set_phase(kFrozen);
  }
  if (phase() == kFrozen && memory_[kStored] == 0) {  // it ended before the first sample, so there is no sample to read
    set_phase(kFree);
  }
}

auto FaultLog::phase() const -> std::uint32_t {
  return memory_.empty() ? std::uint32_t{kFree} : acquire(memory_[kPhase]);
}
void FaultLog::set_phase(std::uint32_t phase) {
  rt_release(memory_[kPhase], phase);
}

auto FaultLog::count() const -> std::uint32_t {
  return memory_.empty() ? 0 : acquire(memory_[kFaults]);
}

auto FaultLog::unpack(std::uint32_t number) const -> FaultEntry {
  const auto words = memory_.subspan(kHeadWords + number % kEntries * kEntryWords, kEntryWords);
  const std::uint32_t fault = std::min<std::uint32_t>(words[2] & 0xFFU, kFaultTable.size() - 1);
  const std::uint32_t state = std::min<std::uint32_t>(words[2] >> 8U & 0xFFU, kStateNames.size() - 1);
  return {.start = words[0],
          .tick = words[1],
          .fault = static_cast<Fault>(fault),
          .state = static_cast<State>(state),
          .joints = static_cast<std::uint8_t>(words[2] >> 16U),
          .conditions = words[3]};
}

auto FaultLog::entry(std::uint32_t age) const -> FaultEntry {
  return memory_.empty() ? FaultEntry{} : unpack(count() - 1 - age);
}

auto FaultLog::kept() const -> std::size_t {
  return phase() == kFrozen ? memory_[kStored] : 0;
}
auto FaultLog::kept_entry() const -> FaultEntry {
  return memory_.empty() ? FaultEntry{} : unpack(memory_[kKept] - 1);
}

auto FaultLog::place_of(std::size_t sample) const -> std::size_t {
  const std::size_t oldest = memory_[kStored] < kSamples ? 0 : memory_[kNext];
  return kHeadWords + kEntries * kEntryWords + (oldest + sample) % kSamples * sample_words(axes_);
}

auto FaultLog::cycles_from_fault(std::size_t sample) const -> std::int32_t {
  CAPSTAN_EXPECT(sample < kept());
  return static_cast<std::int32_t>(memory_[place_of(sample)] - memory_[place_of(kept() - 1)]);
}

auto FaultLog::raw(std::size_t sample, std::size_t axis, std::size_t signal) const -> std::int32_t {
  CAPSTAN_EXPECT(sample < kept() && axis < axes_ && signal < kSignals);
  const auto words = memory_.subspan(place_of(sample) + 1 + axis * kWordsOfJoint, kWordsOfJoint);
  if (signal < kWordsOfJoint) {
    return static_cast<std::int32_t>(words[signal] << 8U);
  }
  return static_cast<std::int32_t>((words[0] >> 24U) << 8U | (words[1] >> 24U) << 16U | (words[2] >> 24U) << 24U);
}

void FaultLog::release() {
  if (phase() == kFrozen) {
    set_phase(kFree);
  }
}

auto FaultLog::heat(std::size_t axis) const -> Q24 {
  const std::uint32_t kept = memory_.empty() ? 0 : memory_[heat_word(axis, axes_)];
  return Q24::from_raw(static_cast<std::int32_t>(std::min(kept, kMostHeat) << kHeatShift));
}

void FaultLog::rt_keep_heat(std::size_t axis, Q24 heat) {
  if (memory_.empty()) {
    return;
  }
  const auto raw = static_cast<std::uint32_t>(heat.raw());  // never negative
  const std::uint32_t whole = raw >> kHeatShift;
  // Below the first step it is cold, or noise about 0 would come and go as a step.
  const std::uint32_t rounded = whole == 0 ? 0 : (raw + (1U << kHeatShift) - 1U) >> kHeatShift;
  rt_put(memory_[heat_word(axis, axes_)], rounded);
}

void FaultLog::rt_add(const FaultEntry& entry) {
  const auto words = memory_.subspan(kHeadWords + memory_[kFaults] % kEntries * kEntryWords, kEntryWords);
  rt_put(words[0], entry.start);
  rt_put(words[1], entry.tick);
  rt_put(words[2], packed(entry));
  rt_put(words[3], entry.conditions);
  rt_release(memory_[kFaults], memory_[kFaults] + 1);
}

void FaultLog::rt_store(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) {
  std::uint32_t* place = &memory_[kHeadWords + kEntries * kEntryWords + memory_[kNext] * sample_words(axes_)];
  rt_put(*place++, machine.tick);
  for (const AxisTelemetry& axis : axes) {
    // Three numbers in the lower 24 bits, the fourth in the upper 8 of all.
    const auto last = static_cast<std::uint32_t>(axis.q2_reference_rad.raw()) >> 8U;
    std::uint32_t shift = 0;
    for (const Q24 value : {axis.q1_rad, axis.tau_nm, axis.q2_rad}) {
      rt_put(*place++, static_cast<std::uint32_t>(value.raw()) >> 8U | (last >> shift) << 24U);
      shift += 8;
    }
  }
  rt_put(memory_[kNext], memory_[kNext] + 1 == kSamples ? 0 : memory_[kNext] + 1);
  rt_put(memory_[kStored], std::min<std::uint32_t>(memory_[kStored] + 1, kSamples));
  rt_put(memory_[kLastTick], machine.tick);
}

void FaultLog::rt_step(const MachineTelemetry& machine, std::span<const AxisTelemetry> axes) {
  if (memory_.empty()) {
    return;
  }
  const State before = last_;
  last_ = machine.state;
  const bool begins = energised(machine.state) && !energised(before);
  for (std::size_t axis = 0; begins && axis < axes_; ++axis) {  // until there is no torque and somebody knows better
    std::uint32_t& kept = memory_[heat_word(axis, axes_)];
    rt_put(kept, std::max(kept, kHeatOf1));
  }
  if (begins && phase() == kFree) {
    rt_put(memory_[kNext], 0);
    rt_put(memory_[kStored], 0);
    rt_put(memory_[kLastTick], machine.tick);
    set_phase(kRunning);
  }
  const bool running = phase() == kRunning;
  if (energised(machine.state)) {
    if (running && machine.tick % kEvery == 0) {
      rt_store(machine, axes);
    }
    return;
  }
  if (machine.state == State::kFaulted && before != State::kFaulted) {
    rt_add({.start = memory_[kStarts],
            .tick = machine.tick,
            .fault = machine.first_fault,
            .state = before,
            .joints = joints_with(machine.first_fault, axes),
            .conditions = machine.conditions});
    if (running) {
      rt_store(machine, axes);
      rt_put(memory_[kKept], memory_[kFaults]);
      set_phase(kFrozen);
    }
  } else if (running) {  // disarmed: nothing happened
    set_phase(kFree);
  }
}

}  // namespace capstan
