// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "hal/sim/sim_io.hpp"
#include "tools/campaign/fault_campaign.hpp"
#include "tools/support/random.hpp"

namespace capstan::tools {

inline constexpr int kDelayCycles = 100;
inline constexpr int kMissingEvery = 20;
inline constexpr double kLagS = 0.2;
inline constexpr double kSupplyV = 24.0;

/// What becomes of one number.
class Corruption {
 public:
  /// @param garbage  garbage lies within plus and minus this   @param mirror_at_onset  the sign turns about the value
  /// that it had, not about zero: a count has no zero
  Corruption(Mode mode, double garbage, bool mirror_at_onset)
      : mode_(mode), garbage_(garbage), mirror_at_onset_(mirror_at_onset) {}

  /// Nothing: no value comes.
  auto operator()(double now) -> std::optional<double> {
    if (cycle_ == 0) {
      onset_ = now;
      lagged_ = now;
      history_.fill(now);
    }
    const std::size_t place = static_cast<std::size_t>(cycle_++ % kDelayCycles);
    const double old = std::exchange(history_[place], now);
    lagged_ += (now - lagged_) * sim::kStepS / kLagS;
    switch (mode_) {
      case Mode::kOff:
      case Mode::kNan:
        return std::nullopt;
      case Mode::kStuck:
        return onset_;
      case Mode::kGarbage:
        return garbage_ * (2.0 * random_.uniform() - 1.0);
      case Mode::kWrongSign:
        return mirror_at_onset_ ? 2.0 * onset_ - now : -now;
      case Mode::kSlow:
        return lagged_;
      case Mode::kDelayed:
        return old;
      case Mode::kIntermittent:
        return cycle_ % kMissingEvery == 0 ? std::nullopt : std::optional(now);
    }
    return std::nullopt;
  }

 private:
  Mode mode_;
  double garbage_;
  bool mirror_at_onset_;
  int cycle_ = 0;
  double onset_ = 0.0;
  double lagged_ = 0.0;
  std::array<double, kDelayCycles> history_{};
  Random random_{11};
};

/// The simulated joint's I/O with one input that goes wrong from begin() on.
class FaultyIo {
 public:
  static constexpr std::size_t kAxes = 1;
  explicit FaultyIo(SimIo& io) : io_(io) {}

  void begin(Input input, Mode mode) {
    input_ = input;
    mode_ = mode;
    const double garbage = input == Input::kEncoder ? 2147483647.0 : input == Input::kSupply ? kSupplyV : 3.0;
    corruption_.emplace(mode, garbage, input == Input::kEncoder);
  }
  auto read(Sensed<1>& sensed) noexcept -> Status {
    const Status status = io_.read(sensed);
    sensed.overruns = overruns_;
    sensed.axis[0].supply = Quality::kOk;
    sensed.axis[0].supply_v = Q24::from_double(kSupplyV);
    if (!corruption_) {
      return status;
    }
    AxisSensed& axis = sensed.axis[0];
    const Quality lost = mode_ == Mode::kNan ? Quality::kInvalid : Quality::kMissing;
    if (input_ == Input::kEncoder) {
      const auto value = (*corruption_)(axis.encoder_counts);
      axis.encoder = value ? axis.encoder : lost;
      axis.encoder_counts = static_cast<std::int32_t>(value.value_or(0.0));
    } else if (input_ == Input::kCurrent) {
      const auto value = (*corruption_)(axis.current_a.to_double());
      axis.current = value ? axis.current : lost;
      axis.current_a = Q24::from_double(value.value_or(0.0));
    } else if (input_ == Input::kSupply) {
      const auto value = (*corruption_)(kSupplyV);
      axis.supply = value ? Quality::kOk : lost;
      axis.supply_v = Q24::from_double(value.value_or(0.0));
    } else if (input_ == Input::kEmergencyStop) {
      sensed.estop = estop_open();
    } else if (input_ == Input::kClock) {
      miscount();
      sensed.overruns = overruns_;
    }
    return status;
  }
  auto write(const Drive<1>& wanted) noexcept -> Status {
    enabled_ = wanted.axis[0].enabled;
    Drive<1> given = wanted;
    bool taken = true;
    if (corruption_ && input_ == Input::kAmplifier) {
      const auto value = (*corruption_)(wanted.axis[0].current_a.to_double());
      given.axis[0].current_a = Q24::from_double(value.value_or(0.0));
      taken = value.has_value() || mode_ == Mode::kOff;  // one that is off stays silent, one that fails says so
    }
    const Status status = io_.write(given);
    return taken ? status : Status::kFailed;
  }
  void release() noexcept {
    enabled_ = false;
    io_.release();
  }
  /// What the firmware last asked for.
  [[nodiscard]] auto enabled() const -> bool { return enabled_; }

 private:
  auto estop_open() -> bool {
    const auto value = (*corruption_)(mode_ == Mode::kDelayed ? 1.0 : 0.0);
    ++stop_cycles_;
    switch (mode_) {
      case Mode::kDelayed:  // pressed at the onset, seen later
        return stop_cycles_ > kDelayCycles;
      case Mode::kGarbage:
        return value.value_or(0.0) > 0.0;
      case Mode::kWrongSign:
        return true;
      default:
        return !value.has_value();
    }
  }
  void miscount() {
    ++clock_cycles_;
    switch (mode_) {
      case Mode::kSlow:
        ++overruns_;
        break;
      case Mode::kGarbage:
        overruns_ = static_cast<std::uint32_t>(random_.uniform() * 4294967295.0);
        break;
      case Mode::kWrongSign:
        --overruns_;
        break;
      case Mode::kIntermittent:
        overruns_ += clock_cycles_ % kMissingEvery == 0 ? 1 : 0;
        break;
      case Mode::kDelayed:  // one late cycle in a second
        overruns_ += clock_cycles_ % kCycleRateHz == 0 ? 1 : 0;
        break;
      default:
        break;
    }
  }

  SimIo& io_;
  Input input_{};
  Mode mode_{};
  std::optional<Corruption> corruption_;
  Random random_{12};
  bool enabled_ = false;
  int stop_cycles_ = 0;
  int clock_cycles_ = 0;
  std::uint32_t overruns_ = 0;
};
static_assert(JointIo<FaultyIo>);

}  // namespace capstan::tools
