// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/hal/sim/step.hpp"

namespace capstan::sim {
namespace {

constexpr double kLeastSupply = 0.5;  // below this share of their voltage the sensors are dead

constexpr auto kTargets = std::to_array<std::pair<std::string_view, FaultTarget>>({
    {"encoder", FaultTarget::kEncoder},
    {"current", FaultTarget::kCurrent},
    {"amplifier", FaultTarget::kAmplifier},
    {"tendon_top", FaultTarget::kTendonTop},
    {"tendon_bottom", FaultTarget::kTendonBottom},
    {"supply", FaultTarget::kSupply},
    {"bus", FaultTarget::kBus},
    {"camera", FaultTarget::kCamera},
    {"tip_force", FaultTarget::kTipForce},
    {"tip", FaultTarget::kTip},
});
constexpr auto kKinds = std::to_array<std::pair<std::string_view, FaultKind>>({
    {"off", FaultKind::kOff},
    {"stuck", FaultKind::kStuck},
    {"garbage", FaultKind::kGarbage},
    {"jump", FaultKind::kJump},
    {"nan", FaultKind::kNan},
    {"sign", FaultKind::kSign},
    {"delayed", FaultKind::kDelayed},
    {"intermittent", FaultKind::kIntermittent},
    {"slow", FaultKind::kSlow},
    {"trip", FaultKind::kTrip},
    {"snap", FaultKind::kSnap},
    {"dip", FaultKind::kDip},
});

template <class Table>
auto choose(const Table& table, const std::string& what, std::string_view name) {
  std::string known;
  for (const auto& [choice, value] : table) {
    if (name == choice)
      return value;
    known += (known.empty() ? "" : ", ") + std::string(choice);
  }
  throw std::invalid_argument("`" + std::string(name) + "` is no " + what + "; known are: " + known);
}

void require(bool condition, const char* sentence) {
  if (!condition)
    throw std::invalid_argument(sentence);
}

}  // namespace

FaultTarget fault_target(std::string_view name) {
  return choose(kTargets, "fault target", name);
}

FaultKind fault_kind(std::string_view name) {
  return choose(kKinds, "fault kind", name);
}

void FaultSchedule::add(const Fault& fault) {
  require(fault.time_s >= 0.0 && fault.duration_s >= 0.0 && std::isfinite(fault.amount),
          "fault: time and duration must not be negative and the amount finite; correct the schedule");
  require(fault.kind != FaultKind::kDelayed || (fault.amount >= 0.0 && fault.amount <= kLongestDelayS),
          "fault: a delay is 0 to 0.5 s; shorten `amount`");
  const bool share = fault.kind == FaultKind::kIntermittent || fault.kind == FaultKind::kDip;
  require(!share || (fault.amount >= 0.0 && fault.amount <= 1.0), "fault: a share is 0 to 1; correct `amount`");
  require(fault.kind != FaultKind::kSlow || fault.amount > 0.0,
          "fault: slow needs its time constant, s; give `amount`");
  const bool tendon = fault.target == FaultTarget::kTendonTop || fault.target == FaultTarget::kTendonBottom;
  require(tendon == (fault.kind == FaultKind::kSnap),
          "fault: a tendon can only snap, and nothing else can; choose one");
  require((fault.target == FaultTarget::kSupply) == (fault.kind == FaultKind::kDip),
          "fault: the supply can only dip, and nothing else can; choose one");
  require(fault.target == FaultTarget::kAmplifier || fault.kind != FaultKind::kTrip,
          "fault: only an amplifier trips; choose target = \"amplifier\"");
  require(fault.target != FaultTarget::kAmplifier || fault.kind != FaultKind::kNan,
          "fault: an amplifier cannot be nan; choose another kind");
  require(fault.target != FaultTarget::kBus || (fault.kind == FaultKind::kOff && fault.amount >= 0.0),
          "fault: the bus can only be off; `amount` is how long the amplifier goes on, s");
  require(fault.target != FaultTarget::kTip || fault.kind == FaultKind::kJump,
          "fault: the tip can only jump, by `amount` N m; choose another target");
  faults_.push_back(fault);
  reset_.push_back(false);
}

bool FaultSchedule::active(const Fault& fault, double time_s) const {
  // Half a step of slack: times are multiples of 1 ms with rounding.
  const double since = time_s - fault.time_s + 0.5 * kStepS;
  return since >= 0.0 && (fault.duration_s == 0.0 || since < fault.duration_s);
}

void FaultSchedule::apply(double time_s, Readings& readings) {
  if (faults_.empty())
    return;
  if (history_.empty()) {
    history_.assign(steps(kLongestDelayS) + 1, readings);
    stuck_ = readings;
    last_counts_ = readings.encoder_counts;
  }
  starve(time_s, readings);
  newest_ = (newest_ + 1) % history_.size();
  history_[newest_] = readings;
  const Readings healthy = readings;
  const auto holds = [&](FaultTarget target, FaultKind kind) {
    return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
      return fault.target == target && fault.kind == kind && active(fault, time_s);
    });
  };
  for (const Fault& fault : faults_) {
    if (active(fault, time_s))
      apply_one(fault, readings);
  }
  if (!holds(FaultTarget::kEncoder, FaultKind::kStuck))
    stuck_.encoder_counts = healthy.encoder_counts;
  if (!holds(FaultTarget::kCurrent, FaultKind::kStuck))
    stuck_.current_a = healthy.current_a;
  if (!holds(FaultTarget::kEncoder, FaultKind::kSlow))
    slow_.counts = static_cast<double>(healthy.encoder_counts);
  if (!holds(FaultTarget::kCurrent, FaultKind::kSlow))
    slow_.current_a = healthy.current_a;
}

void FaultSchedule::starve(double time_s, Readings& readings) {
  const bool was_undervoltage = undervoltage_;
  undervoltage_ = supply(time_s) < kLeastSupply;
  if (undervoltage_ || was_undervoltage)
    uncounted_ += std::int64_t{wrap(std::int64_t{readings.encoder_counts} - last_counts_)};
  last_counts_ = readings.encoder_counts;
  readings.encoder_counts = wrap(std::int64_t{readings.encoder_counts} - uncounted_);
  if (undervoltage_) {
    readings.current_a = 0.0;
    readings.encoder_ok = false;
    readings.current_ok = false;
  }
}

bool FaultSchedule::lost(double share) {
  return static_cast<double>(random_.next() >> 11U) * 0x1.0p-53 < share;
}

Readings FaultSchedule::faulty(const Fault& fault, const Readings& good) {
  switch (fault.kind) {
    case FaultKind::kOff:
      return {0, 0.0, false, false};
    case FaultKind::kStuck:
      return stuck_;
    case FaultKind::kGarbage:
      return {wrap(static_cast<std::int64_t>(random_.next() >> 1U)), random_.normal(), true, true};
    case FaultKind::kJump:
      return {wrap(std::int64_t{good.encoder_counts} + std::llround(std::clamp(fault.amount, -2.0e9, 2.0e9))),
              good.current_a + fault.amount, true, true};
    case FaultKind::kNan:
      return {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<double>::quiet_NaN(), false, true};
    case FaultKind::kSign:
      return {wrap(-std::int64_t{good.encoder_counts}), -good.current_a, true, true};
    case FaultKind::kIntermittent: {
      const bool ok = !lost(fault.amount);
      return {ok ? good.encoder_counts : 0, ok ? good.current_a : 0.0, ok, ok};
    }
    case FaultKind::kSlow: {
      const double share = 1.0 - det_exp(-kStepS / fault.amount);
      const auto shown = static_cast<std::int64_t>(std::floor(slow_.counts));
      Slow next = slow_;
      next.counts += share * static_cast<double>(wrap(std::int64_t{good.encoder_counts} - shown));
      next.current_a += share * (good.current_a - slow_.current_a);
      (fault.target == FaultTarget::kEncoder ? slow_.counts : slow_.current_a) =
          fault.target == FaultTarget::kEncoder ? next.counts : next.current_a;
      return {wrap(static_cast<std::int64_t>(std::floor(slow_.counts))), slow_.current_a, true, true};
    }
    default:
      break;
  }
  return history_[(newest_ + history_.size() - steps(fault.amount)) % history_.size()];
}

void FaultSchedule::apply_one(const Fault& fault, Readings& readings) {
  if (fault.target == FaultTarget::kBus) {
    const Readings& before = history_[(newest_ + history_.size() - 1) % history_.size()];
    readings = {before.encoder_counts, before.current_a, false, false};
    return;
  }
  if (fault.target != FaultTarget::kEncoder && fault.target != FaultTarget::kCurrent)
    return;
  const Readings replaced = faulty(fault, readings);
  if (fault.target == FaultTarget::kEncoder) {
    readings.encoder_counts = replaced.encoder_counts;
    readings.encoder_ok = readings.encoder_ok && replaced.encoder_ok;
  } else {
    readings.current_a = replaced.current_a;
    readings.current_ok = readings.current_ok && replaced.current_ok;
  }
}

double FaultSchedule::faulty_logged(const Fault& fault, LoggedSensor& sensor, double value) {
  switch (fault.kind) {
    case FaultKind::kOff:
      return 0.0;
    case FaultKind::kStuck:
      return sensor.stuck;
    case FaultKind::kGarbage:
      return random_.normal();
    case FaultKind::kJump:
      return value + fault.amount;
    case FaultKind::kNan:
      return std::numeric_limits<double>::quiet_NaN();
    case FaultKind::kSign:
      return -value;
    case FaultKind::kIntermittent:
      return lost(fault.amount) ? 0.0 : value;
    case FaultKind::kSlow:
      sensor.slow += (1.0 - det_exp(-kStepS / fault.amount)) * (value - sensor.slow);
      return sensor.slow;
    default:
      return sensor.history[(sensor.newest + sensor.history.size() - steps(fault.amount)) % sensor.history.size()];
  }
}

double FaultSchedule::filter_logged(FaultTarget target, double time_s, double value) {
  if (faults_.empty())
    return value;
  LoggedSensor& sensor = target == FaultTarget::kCamera ? camera_ : tip_force_;
  if (sensor.history.empty())
    sensor.history.assign(steps(kLongestDelayS) + 1, value);
  sensor.newest = (sensor.newest + 1) % sensor.history.size();
  sensor.history[sensor.newest] = value;
  double shown = value;
  bool stuck = false;
  bool slow = false;
  for (const Fault& fault : faults_) {
    if (fault.target != target || !active(fault, time_s))
      continue;
    stuck |= fault.kind == FaultKind::kStuck;
    slow |= fault.kind == FaultKind::kSlow;
    shown = faulty_logged(fault, sensor, shown);
  }
  if (!stuck)
    sensor.stuck = value;
  if (!slow)
    sensor.slow = value;
  return shown;
}

double FaultSchedule::faulty_command(const Fault& fault, double command_a, bool& enabled) {
  switch (fault.kind) {
    case FaultKind::kOff:
    case FaultKind::kTrip:
      enabled = false;
      return command_a;
    case FaultKind::kGarbage:
      return random_.normal();
    case FaultKind::kJump:
      return command_a + fault.amount;
    case FaultKind::kSign:
      return -command_a;
    case FaultKind::kIntermittent:
      enabled = enabled && !lost(fault.amount);
      return command_a;
    case FaultKind::kSlow:
      slow_.command_a += (1.0 - det_exp(-kStepS / fault.amount)) * (command_a - slow_.command_a);
      return slow_.command_a;
    case FaultKind::kDelayed:
      return commands_[(newest_command_ + commands_.size() - steps(fault.amount)) % commands_.size()];
    default:
      return command_a;
  }
}

void FaultSchedule::cross_bus(double time_s, double& command_a, bool& enabled) {
  const auto silence = std::find_if(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    return fault.target == FaultTarget::kBus && active(fault, time_s);
  });
  if (silence == faults_.end()) {
    bus_command_a_ = command_a;
    bus_enabled_ = enabled;
  } else {
    command_a = bus_command_a_;
    enabled = bus_enabled_ && time_s - silence->time_s < silence->amount;
  }
}

bool FaultSchedule::acts_on_amplifier(std::size_t number, double time_s, bool wanted) {
  const Fault& fault = faults_[number];
  if (fault.target != FaultTarget::kAmplifier)
    return false;
  if (fault.kind != FaultKind::kTrip)
    return active(fault, time_s);
  if (time_s + 0.5 * kStepS < fault.time_s || reset_[number])
    return false;
  reset_[number] = !wanted;
  return true;
}

double FaultSchedule::filter_command(double time_s, double command_a, bool& enabled) {
  if (faults_.empty())
    return enabled ? command_a : 0.0;
  if (commands_.empty())
    commands_.assign(steps(kLongestDelayS) + 1, 0.0);
  cross_bus(time_s, command_a, enabled);
  newest_command_ = (newest_command_ + 1) % commands_.size();
  commands_[newest_command_] = enabled ? command_a : 0.0;
  const bool wanted = enabled;
  bool stuck = false;
  bool slow = false;
  double result = command_a;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (!acts_on_amplifier(i, time_s, wanted))
      continue;
    stuck |= faults_[i].kind == FaultKind::kStuck;
    slow |= faults_[i].kind == FaultKind::kSlow;
    result = faulty_command(faults_[i], result, enabled);
  }
  if (!slow)
    slow_.command_a = wanted ? command_a : 0.0;
  if (!stuck)
    stuck_command_a_ = enabled ? result : 0.0;
  if (stuck)
    enabled = true;
  return stuck_command_a_;
}

double FaultSchedule::supply(double time_s) const {
  double share = 1.0;
  for (const Fault& fault : faults_) {
    if (fault.target == FaultTarget::kSupply && active(fault, time_s))
      share = std::min(share, fault.amount);
  }
  return share;
}

double FaultSchedule::tip_torque(double time_s) const {
  double torque = 0.0;
  for (const Fault& fault : faults_) {
    if (fault.target == FaultTarget::kTip && active(fault, time_s))
      torque += fault.amount;
  }
  return torque;
}

bool FaultSchedule::snapped(double time_s, bool top) const {
  return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    return fault.target == (top ? FaultTarget::kTendonTop : FaultTarget::kTendonBottom) &&
           time_s + 0.5 * kStepS >= fault.time_s;
  });
}

}  // namespace capstan::sim
