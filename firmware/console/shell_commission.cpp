// SPDX-License-Identifier: Apache-2.0
// The shell's command that finds the motor observer's values from the joint's own motion.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/parameters/parameters.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

constexpr std::array<std::string_view, 3> kSignals = {"q1", "drive", "current"};
constexpr Q24 kUsualAmplitude = Q24::from_double(0.3);
/// Of the torque of limits.continuous_current, for each of the two tones: 7.5 mNm on the forceps, whose answer is ten
/// counts and one. Chosen in November 2026 so that the elbow's coarse encoder shows its inertia to 10 %.
constexpr Q24 kUsualDither = Q24::from_double(0.05);
/// Of limits.joint_speed. A joint that is not commissioned goes no faster than a quarter of it.
using Shares = std::array<Q24, 3>;
constexpr Shares kCautiousShares = {Q24::from_double(0.06), Q24::from_double(0.12), Q24::from_double(0.24)};
constexpr Shares kShares = {Q24::from_double(0.12), Q24::from_double(0.48), Q24::from_double(0.96)};
constexpr std::int32_t kDitherLegs = 4;  // there and back
constexpr std::int32_t kFastCycles = 4;

/// About where the joint stands.
constexpr ExperimentSetup kUsual{
    .recipe = Recipe::kSpeedLadder, .amplitude = kUsualAmplitude, .rung_count = kShares.size()};

void take_usual(ExperimentSetup& setup, std::size_t axis, const AxisConfig& config, Q24 q2_rad) {
  setup = kUsual;
  setup.axis = static_cast<std::uint8_t>(axis);
  setup.offset_rad = q2_rad;
  for (std::size_t i = 0; i < kCautiousShares.size(); ++i) {
    setup.rungs[i] = config.limits.joint_speed_rad_s * kCautiousShares[i];
  }
  setup.dither_nm = config.limits.continuous_current_a * config.motor.torque_per_current_nm_per_a * kUsualDither;
}

auto parse_option(std::string_view word, ExperimentSetup& setup) -> bool {
  const std::size_t sign = std::min(word.find('='), word.size());
  const std::string_view name(word.data(), sign);
  const std::string_view value(word.data() + std::min(sign + 1, word.size()),
                               word.size() - std::min(sign + 1, word.size()));
  return (name == "amplitude" && parse_quantity(value, "rad", setup.amplitude) == ValueError::kNone) ||
         (name == "dither" && parse_quantity(value, "Nm", setup.dither_nm) == ValueError::kNone &&
          setup.dither_nm > Q24{});
}

}  // namespace

void ShellCommands::commission(Shell& shell, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (!shell.parse_axis(joint, axis) || !joint.empty()) {
    shell.error("unknown_joint", "there is no such joint", "write 'commission joint0'");
    return;
  }
  if (!MotorCommissioning::kAvailable) {
    shell.error(
        "not_here", "this board has no floating point to find the values with, and nothing moved",
        "commission such a joint on Linux and set observer.* here, or find them as docs/safety_concept.md says");
    return;
  }
  const AxisConfig& config = shell.machine_.config()[axis];
  ExperimentSetup& setup = shell.setup_;
  take_usual(setup, axis, config, shell.machine_.axis_telemetry(axis).q2_rad);
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    if (!parse_option(word, setup)) {
      shell.error("option", "an option is not understood, and nothing moved",
                  "write 'commission joint0 amplitude=0.2rad dither=5mNm'");
      return;
    }
  }
  if (!shell.maintenance_.is_open(shell.machine_.telemetry().tick)) {
    shell.error("maintenance", "what is found is a safety limit, and nothing moved",
                "'maintenance open' first, with the key if one is set");
  } else if (MotorObserver::commissioned(config.observer)) {
    shell.out_ << "error commissioned: joint" << static_cast<std::uint32_t>(axis)
               << " is commissioned, its observer would take the dither for a fault, and nothing moved; 'disarm' and "
                  "'set joint"
               << static_cast<std::uint32_t>(axis) << ".observer.inertia 0' to begin anew\r\n";
    shell.prompt();
  } else if (const char* problem = check_experiment(setup, config)) {
    shell.out_ << "error range: nothing moved, because " << problem << "\r\n";  // it ends in its own cure
    shell.prompt();
  } else if (shell.machine_.telemetry().state != State::kHolding) {
    shell.error("not_holding", "commissioning begins with torque on and every joint at rest",
                "'arm' first, or wait until the joints stand");
  } else if (shell.framing_ || !shell.machine_.settled()) {
    shell.error("busy", "frames are being sent or the last request is under way, and nothing moved",
                "'frames off' if they are on, and send the line again");
  } else {
    shell.commissioning_.begin(config.motor);
    static_cast<void>(shell.begin_commissioning(Shell::CommissioningStep::kMoves));
  }
}

/// False: the recorder is not free, and that was answered.
auto Shell::begin_commissioning(CommissioningStep step) -> bool {
  choose_signals(recorded_, setup_.axis, kSignals);
  if (!machine_.recorder().start(this, recorded_)) {
    error("busy", "the recorder is in use, by another console or still by the last command", "send the line again");
    return false;
  }
  const Q24 fastest = machine_.config()[setup_.axis].limits.joint_speed_rad_s;
  if (step == CommissioningStep::kDither) {
    commissioning_.begin_dither();
    setup_.recipe = Recipe::kDither;
    setup_.rungs[0] = fastest * kCautiousShares.back();
    setup_.rung_count = 1;
    setup_.cycles = kDitherLegs;
  } else if (step == CommissioningStep::kFastMoves) {
    setup_.recipe = Recipe::kSpeedLadder;
    setup_.rung_count = kShares.size();
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      setup_.rungs[i] = fastest * kShares[i];
    }
    setup_.cycles = kFastCycles;
  }
  commissioning_step_ = step;
  static_cast<void>(machine_.begin_experiment(setup_));  // its way to the cycle is free
  log_left_ = 1;
  activity_ = Activity::kCommissioning;
  return true;
}

void Shell::go_on_commissioning() {
  if (!machine_.settled()) {
    return;
  }
  const MachineTelemetry now = machine_.telemetry();
  switch (commissioning_step_) {
    case CommissioningStep::kTaking:
      take_commissioned();
      return;
    case CommissioningStep::kResting:  // torque is off: from here on the joint may be as fast as it will be
      commissioning_step_ = CommissioningStep::kRising;
      static_cast<void>(machine_.post({.kind = Request::Kind::kArm}));
      return;
    case CommissioningStep::kRising:
      if (now.state == State::kHolding) {
        static_cast<void>(begin_commissioning(CommissioningStep::kFastMoves));
      } else if (!energised(now.state)) {
        refuse_commissioning("torque did not come back for the fast moves; read 'faults'");
      }
      return;
    default:
      break;
  }
  const bool running_only = commissioning_step_ == CommissioningStep::kDither;
  SignalSample sample;
  while (machine_.recorder().next(sample)) {
    if (!running_only || sample.raw[kSignals.size()] == static_cast<std::int32_t>(ExperimentPhase::kRunning)) {
      commissioning_.add(sample.tick, Q24::from_raw(sample.raw[0]), Q24::from_raw(sample.raw[1]),
                         Q24::from_raw(sample.raw[2]));
    }
  }
  if (log_left_ == 0 && now.state == State::kExperiment && urgent_ == Urgent::kNone) {  // somebody wants it to end
    static_cast<void>(machine_.post({.kind = Request::Kind::kStop, .axis = setup_.axis}));
  }
  const bool over = now.experiment == ExperimentPhase::kDone || now.experiment == ExperimentPhase::kEnded;
  if (over && (now.state == State::kHolding || !energised(now.state))) {  // and does not brake any more
    next_commissioning_step();
  }
}

void Shell::refuse_commissioning(const char* problem) {
  out_ << "error not_identified: nothing was changed, because " << problem << "\r\n";
  activity_ = Activity::kIdle;
  prompt();
}

void Shell::next_commissioning_step() {
  machine_.recorder().stop(this);
  const MachineTelemetry now = machine_.telemetry();
  if (now.experiment == ExperimentPhase::kEnded || log_left_ == 0) {
    if (now.first_fault != Fault::kNone) {
      print_fault("ended by ", info(now.first_fault));
    }
    error("aborted", "commissioning was ended before it was over, and nothing was changed",
          "read 'faults', and begin it again");
    return;
  }
  if (commissioning_step_ == CommissioningStep::kMoves) {
    static_cast<void>(begin_commissioning(CommissioningStep::kDither));
    return;
  }
  const bool identified = commissioning_step_ == CommissioningStep::kFastMoves;
  const char* problem = identified ? commissioning_.result().problem : commissioning_.begin_fast_moves();
  if (problem != nullptr) {
    refuse_commissioning(problem);
    return;
  }
  commissioning_step_ = identified ? CommissioningStep::kTaking : CommissioningStep::kResting;
  static_cast<void>(machine_.post({.kind = Request::Kind::kDisarm}));
}

/// Without torque, for these are safety limits.
void Shell::take_commissioned() {
  if (!begin_staging()) {
    return;
  }
  ObserverConfig& observer = staged_[setup_.axis].observer;
  observer = commissioning_.result().values;
  const SetAnswer answer = machine_.configure(staged_, Rights::kMaintenance);
  for (const ParameterInfo& parameter : parameters()) {
    if (answer.taken() && parameter.group == std::string_view("observer")) {
      out_ << "joint" << static_cast<std::uint32_t>(setup_.axis) << ".observer." << parameter.name << ' ';
      print_value(out_, parameter, raw_value(staged_[setup_.axis], parameter));
      out_ << "\r\n";
    }
  }
  abandon();
  if (!answer.taken()) {
    activity_ = Activity::kIdle;
    print_refusal(answer);
    return;
  }
  out_ << "# torque is off; 'save' keeps these values\r\n";
  activity_ = Activity::kApplying;
}

}  // namespace capstan
