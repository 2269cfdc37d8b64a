// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "capstan/hal/sim/sim_io.hpp"
#include "capstan/tools/campaign/fault_modes.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {

inline constexpr int kDelayCycles = 100;
inline constexpr int kLateCycles = 20;
inline constexpr int kMissingEvery = 20;
inline constexpr double kLagS = 0.2;
inline constexpr double kSupplyV = 24.0;

/// The sizes of what goes wrong with one number, in its own unit.
struct Sizes {
  double garbage = 3.0;  ///< random within plus and minus this
  double drift_per_s = 1.0;
  double coarse = 0.25;          ///< step of a quantised value
  bool about_the_onset = false;  ///< reversed and scaled about the value at the onset, not about zero: a count has none
};

/// What becomes of one number from the first call on.
class Corruption {
 public:
  Corruption(Mode mode, const Sizes& sizes) : mode_(mode), sizes_(sizes) {}

  /// Nothing: no value comes.
  auto operator()(double now) -> std::optional<double> {
    if (cycle_ == 0) {
      onset_ = lagged_ = now;
      history_.assign(static_cast<std::size_t>(mode_ == Mode::kLate ? kLateCycles : kDelayCycles), now);
    }
    const std::size_t place = static_cast<std::size_t>(cycle_++) % history_.size();
    const double old = std::exchange(history_[place], now);
    lagged_ += (now - lagged_) * sim::kStepS / kLagS;
    const double zero = sizes_.about_the_onset ? onset_ : 0.0;
    switch (mode_) {
      case Mode::kStuck:
        return onset_;
      case Mode::kGarbage:
        return sizes_.garbage * (2.0 * random_.uniform() - 1.0);
      case Mode::kWrongSign:
        return 2.0 * zero - now;
      case Mode::kSlow:
        return lagged_;
      case Mode::kDelayed:
      case Mode::kLate:
        return old;
      case Mode::kIntermittent:
        return cycle_ % kMissingEvery == 0 ? std::nullopt : std::optional(now);
      case Mode::kDrift:
        return now + sizes_.drift_per_s * sim::kStepS * cycle_;
      case Mode::kHalf:
        return zero + 0.5 * (now - zero);
      case Mode::kDouble:
        return zero + 2.0 * (now - zero);
      case Mode::kCountBack:
        return cycle_ % 2 == 0 ? now - 1.0 : now;
      case Mode::kQuantised:
        return sizes_.coarse * std::round(now / sizes_.coarse);
      case Mode::kBrownout:
        return cycle_ <= 300 ? 0.45 * now : now;
      default:
        return std::nullopt;
    }
  }

 private:
  Mode mode_;
  Sizes sizes_;
  int cycle_ = 0;
  double onset_ = 0.0;
  double lagged_ = 0.0;
  std::vector<double> history_;
  Random random_{11};
};

/// The simulated joint's I/O with inputs that go wrong from begin() on.
class FaultyIo {
 public:
  static constexpr std::size_t kAxes = 1;
  FaultyIo(SimIo& io, double counts_per_rad) : io_(io), counts_per_rad_(counts_per_rad) {}

  /// One of the inputs that this class stands before: not the reference, not the transmission.
  void begin(OneFault fault) {
    Sizes sizes;
    if (fault.input == Input::kEncoder) {
      sizes = {2147483647.0, 0.5 * counts_per_rad_, 0.01 * counts_per_rad_, true};
    } else if (fault.input == Input::kSupply) {
      sizes = {kSupplyV, -4.0, 4.0, false};
    }
    broken_.push_back({fault, Corruption(fault.mode, sizes)});
  }
  auto read(Sensed<1>& sensed) noexcept -> Status {
    const Status status = io_.read(sensed);
    sensed.axis[0].supply = Quality::kOk;
    sensed.axis[0].supply_v = Q24::from_double(kSupplyV);
    for (Broken& broken : broken_) {
      corrupt(broken, sensed);
    }
    sensed.overruns = overruns_;
    return status;
  }
  auto write(const Drive<1>& wanted) noexcept -> Status {
    enabled_ = wanted.axis[0].enabled;
    Drive<1> given = wanted;
    bool taken = true;
    for (Broken& broken : broken_) {
      if (broken.fault.input == Input::kAmplifier) {
        const auto value = broken.corruption(wanted.axis[0].current_a.to_double());
        given.axis[0].current_a = Q24::from_double(value.value_or(0.0));
        // one that is off stays silent, one that fails says so
        taken = taken && (value.has_value() || broken.fault.mode == Mode::kOff);
      }
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
  struct Broken {
    OneFault fault;
    Corruption corruption;
    int cycles = 0;
  };

  void corrupt(Broken& broken, Sensed<1>& sensed) {
    AxisSensed& axis = sensed.axis[0];
    const Mode mode = broken.fault.mode;
    const Quality lost = mode == Mode::kNan ? Quality::kInvalid : Quality::kMissing;
    if (broken.fault.input == Input::kEncoder) {
      const auto value = broken.corruption(axis.encoder_counts);
      axis.encoder = value ? axis.encoder : lost;
      axis.encoder_counts = static_cast<std::int32_t>(std::floor(value.value_or(0.0)));
    } else if (broken.fault.input == Input::kCurrent) {
      const auto value = broken.corruption(axis.current_a.to_double());
      axis.current = value ? axis.current : lost;
      axis.current_a = Q24::from_double(value.value_or(0.0));
    } else if (broken.fault.input == Input::kSupply) {
      const auto value = broken.corruption(kSupplyV);
      axis.supply = value ? Quality::kOk : lost;
      axis.supply_v = Q24::from_double(value.value_or(0.0));
    } else if (broken.fault.input == Input::kEmergencyStop) {
      sensed.estop = estop_open(broken);
    } else if (broken.fault.input == Input::kClock) {
      miscount(broken);
    }
  }
  static auto estop_open(Broken& broken) -> bool {
    const auto value = broken.corruption(broken.fault.mode == Mode::kDelayed ? 1.0 : 0.0);
    ++broken.cycles;
    switch (broken.fault.mode) {
      case Mode::kDelayed:  // pressed at the onset, seen later
        return broken.cycles > kDelayCycles;
      case Mode::kGarbage:
        return value.value_or(0.0) > 0.0;
      case Mode::kWrongSign:
        return true;
      default:
        return !value.has_value();
    }
  }
  void miscount(Broken& broken) {
    ++broken.cycles;
    switch (broken.fault.mode) {
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
        overruns_ += broken.cycles % kMissingEvery == 0 ? 1 : 0;
        break;
      case Mode::kDelayed:  // one late cycle in a second
        overruns_ += broken.cycles % kCycleRateHz == 0 ? 1 : 0;
        break;
      default:
        break;
    }
  }

  SimIo& io_;
  double counts_per_rad_;
  std::vector<Broken> broken_;
  Random random_{12};
  bool enabled_ = false;
  std::uint32_t overruns_ = 0;
};
static_assert(JointIo<FaultyIo>);

}  // namespace capstan::tools
