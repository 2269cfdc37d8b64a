// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "capstan/hal/sim/random.hpp"
#include "capstan/hal/sim/sensors.hpp"

namespace capstan::sim {

enum class FaultTarget {
  kEncoder,
  kCurrent,
  kAmplifier,
  kTendonTop,
  kTendonBottom,
  kSupply,    ///< what amplifier and sensors live on
  kBus,       ///< what carries readings and commands
  kCamera,    ///< on the joint, in the log only
  kTipForce,  ///< the tip's force sensor, in the log only
  kTip,       ///< the joint itself: a jump adds the torque `amount` to what acts on it, as a weight on a thread does
};

enum class FaultKind {
  kOff,    ///< sensor: reports itself dead, its value is 0 (in a log only that is seen); amplifier: drives no current;
           ///< bus: silent, see below
  kStuck,  ///< holds the last good value (amplifier: the last good command) and looks healthy
  kGarbage,  ///< random values over the whole range
  kJump,     ///< `amount` (counts, A, rad or N) is added
  kNan,      ///< current, camera, force: not a number; encoder: no valid word, lowest integer and not ok; not for the
             ///< amplifier
  kSign,     ///< the value's sign is reversed
  kDelayed,  ///< the value is `amount` seconds old
  kIntermittent,  ///< every ms with the probability `amount` there is no value (amplifier: no current)
  kSlow,          ///< the value follows with the time constant `amount`, s
  kTrip,          ///< amplifier: off until the command's enable has been withdrawn; the duration plays no part
  kSnap,          ///< tendon: tears, for good
  kDip,           ///< supply: the share `amount` of the voltage, and so of the largest current, is left
};

/// One entry of the fault schedule. `duration_s` 0 means for ever.
/// A silent bus brings no readings and takes no commands; the amplifier repeats its last for `amount` seconds, then is
/// off. A supply below half starves the sensors too: they report themselves dead, and the incremental encoder misses
/// what turns meanwhile.
struct Fault {
  double time_s = 0.0;
  FaultTarget target = FaultTarget::kEncoder;
  FaultKind kind = FaultKind::kOff;
  double amount = 0.0;
  double duration_s = 0.0;
  int axis = 0;  ///< of an instrument with several; MultiPlant hands it on to the axis
};

/// "encoder", "stuck" and so on. Throw std::invalid_argument with "sentence; cure".
[[nodiscard]] FaultTarget fault_target(std::string_view name);
[[nodiscard]] FaultKind fault_kind(std::string_view name);

/// Faults by time. Values pass through it on the way to the board.
class FaultSchedule {
 public:
  static constexpr double kLongestDelayS = 0.5;

  explicit FaultSchedule(std::uint64_t seed) : random_(seed) {}

  /// Throws std::invalid_argument if a number is impossible or the target cannot have that kind.
  void add(const Fault& fault);

  /// Applies what is active at `time_s`. Call once per step: it also remembers the healthy values.
  void apply(double time_s, Readings& readings);

  /// What a sensor of the log, kCamera or kTipForce, shows of its value. Call once per step for each: it remembers the
  /// healthy ones.
  [[nodiscard]] double filter_logged(FaultTarget target, double time_s, double value);

  /// The command that reaches the amplifier. `enabled` may be cleared. Call once per step.
  [[nodiscard]] double filter_command(double time_s, double command_a, bool& enabled);

  /// Share of the supply's voltage that is there.
  [[nodiscard]] double supply(double time_s) const;

  /// On the joint, N m.
  [[nodiscard]] double tip_torque(double time_s) const;

  /// Has this tendon torn by now?
  [[nodiscard]] bool snapped(double time_s, bool top) const;

 private:
  struct Slow {
    double counts = 0.0, current_a = 0.0, command_a = 0.0;
  };

  struct LoggedSensor {
    std::vector<double> history;  // ring of healthy values
    std::size_t newest = 0;
    double stuck = 0.0, slow = 0.0;
  };

  [[nodiscard]] bool active(const Fault& fault, double time_s) const;
  [[nodiscard]] Readings faulty(const Fault& fault, const Readings& good);
  [[nodiscard]] double faulty_logged(const Fault& fault, LoggedSensor& sensor, double value);
  [[nodiscard]] double faulty_command(const Fault& fault, double command_a, bool& enabled);
  void apply_one(const Fault& fault, Readings& readings);
  void starve(double time_s, Readings& readings);
  void cross_bus(double time_s, double& command_a, bool& enabled);
  [[nodiscard]] bool acts_on_amplifier(std::size_t number, double time_s, bool wanted);
  [[nodiscard]] bool lost(double share);

  std::vector<Fault> faults_;
  std::vector<bool> reset_;  // of each fault: a trip that has been acknowledged
  Random random_;
  std::vector<Readings> history_;  // ring of healthy readings, one per ms
  std::size_t newest_ = 0;
  LoggedSensor camera_, tip_force_;
  std::vector<double> commands_;  // the same for commands
  std::size_t newest_command_ = 0;
  Readings stuck_;
  double stuck_command_a_ = 0.0;
  double bus_command_a_ = 0.0;  // the last that came over the bus
  bool bus_enabled_ = false;
  Slow slow_;
  std::int64_t uncounted_ = 0;  // encoder counts missed without supply
  std::int32_t last_counts_ = 0;
  bool undervoltage_ = false;
};

}  // namespace capstan::sim
