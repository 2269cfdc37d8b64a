// SPDX-License-Identifier: Apache-2.0
// The shell's command that finds the motor observer's values from the joint's own motion.
#include <algorithm>

#include "capstan/firmware/console/recording.hpp"
#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/console/shell_experiment.hpp"
#include "capstan/firmware/parameters/parameters.hpp"
#include "capstan/firmware/safety/motor_commissioning.hpp"
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

/// Moves, dither and fast moves, one experiment after the other, and what was found. Torque that comes back for the
/// fast moves is not cautious, so it stays no longer than they do.
struct CommissionStream final : Stream {
  MotorCommissioning found;
  ExperimentSetup setup;

  /// False: it can not begin now, and that was answered.
  auto begin(Session& session) -> bool { return begin_step(session, Step::kMoves); }
  [[maybe_unused]] void step(Session& session) override;  // not on a board that can not commission
  void cancel(Session& /*session*/) override { cancelled_ = true; }

 private:
  enum class Step : std::uint8_t { kMoves, kDither, kResting, kRising, kFastMoves, kTaking, kGivingUp };
  auto begin_step(Session& session, Step step) -> bool;
  void move(Session& session, const MachineTelemetry& now);
  void rise(Session& session, const MachineTelemetry& now);
  void add_samples(Session& session);
  void next_step(Session& session, const MachineTelemetry& now);
  void take(Session& session);
  void give_up(Session& session, const char* problem);
  void refuse(Session& session, const MachineTelemetry& now) const;

  Step step_ = Step::kMoves;
  const char* problem_ = nullptr;
  bool cancelled_ = false;
};

/// @param problem  why the values are not known; nullptr: it was ended before it was over
void CommissionStream::give_up(Session& session, const char* problem) {
  problem_ = problem;
  if (step_ == Step::kRising || step_ == Step::kFastMoves) {
    static_cast<void>(session.machine().post({.kind = Request::Kind::kRest}));
  }
  step_ = Step::kGivingUp;
}

void CommissionStream::refuse(Session& session, const MachineTelemetry& now) const {
  if (now.first_fault != Fault::kNone) {
    print_fault(session, "ended by ", info(now.first_fault));
  }
  if (problem_ == nullptr) {
    session.error("aborted", "commissioning ended early, and nothing was changed",
                  "read 'faults' and 'status', and start it again");
    return;
  }
  session.out() << "error not_identified: nothing was changed, because " << problem_ << "\r\n";
  session.refused();
}

auto CommissionStream::begin_step(Session& session, Step step) -> bool {
  RecorderSetup recorded;
  choose_signals(recorded, setup.axis, kSignals);
  if (!start_recorder(session, recorded)) {
    return false;
  }
  const Q24 fastest = session.machine().config()[setup.axis].limits.joint_speed_rad_s;
  if (step == Step::kDither) {
    found.begin_dither();
    setup.recipe = Recipe::kDither;
    setup.rungs[0] = fastest * kCautiousShares.back();
    setup.rung_count = 1;
    setup.cycles = kDitherLegs;
  } else if (step == Step::kFastMoves) {
    setup.recipe = Recipe::kSpeedLadder;
    setup.rung_count = kShares.size();
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      setup.rungs[i] = fastest * kShares[i];
    }
    setup.cycles = kFastCycles;
  }
  if (!hand_over(session, setup)) {
    return false;
  }
  step_ = step;
  session.begin(*this);
  return true;
}

void CommissionStream::step(Session& session) {
  if (!session.machine().requests_taken()) {
    return;
  }
  const MachineTelemetry now = session.machine().telemetry();
  if (step_ == Step::kGivingUp) {
    refuse(session, now);
  } else if (step_ == Step::kTaking && now.first_fault != Fault::kNone) {
    refuse(session, now);
  } else if (step_ == Step::kTaking) {
    take(session);
  } else if (step_ == Step::kResting || step_ == Step::kRising) {
    rise(session, now);
  } else {
    move(session, now);
  }
}

/// Torque goes and comes back for the fast moves: from here on this joint may be as fast as it will be.
void CommissionStream::rise(Session& session, const MachineTelemetry& now) {
  if (cancelled_ || now.first_fault != Fault::kNone) {
    give_up(session, nullptr);
  } else if (step_ == Step::kResting) {
    step_ = Step::kRising;
    const unsigned others = session.board().simulated() ? 0U : kAllJoints & ~(1U << setup.axis);
    static_cast<void>(
        session.machine().post({.kind = Request::Kind::kArm, .cautious = static_cast<std::uint8_t>(others)}));
  } else if (now.state == State::kHolding) {
    if (!begin_step(session, Step::kFastMoves)) {  // and that was answered
      static_cast<void>(session.machine().post({.kind = Request::Kind::kRest}));
    }
  } else if (!energised(now.state)) {
    give_up(session, "torque did not come back for the fast moves; read 'faults'");
  }
}

void CommissionStream::move(Session& session, const MachineTelemetry& now) {
  add_samples(session);
  if (cancelled_ && now.state == State::kExperiment && !session.disarming()) {  // somebody wants it to end
    static_cast<void>(session.machine().post({.kind = Request::Kind::kStop, .axis = setup.axis}));
  }
  const bool over = now.experiment == ExperimentPhase::kDone || now.experiment == ExperimentPhase::kEnded;
  if (over && (now.state == State::kHolding || !energised(now.state))) {  // and does not brake any more
    next_step(session, now);
  }
}

void CommissionStream::add_samples(Session& session) {
  const bool running_only = step_ == Step::kDither;
  SignalSample sample;
  while (session.machine().recorder().next(sample)) {
    if (!running_only || sample.raw[kSignals.size()] == static_cast<std::int32_t>(ExperimentPhase::kRunning)) {
      found.add(sample.tick, Q24::from_raw(sample.raw[0]), Q24::from_raw(sample.raw[1]), Q24::from_raw(sample.raw[2]));
    }
  }
}

void CommissionStream::next_step(Session& session, const MachineTelemetry& now) {
  session.machine().recorder().stop(&session);
  if (now.experiment == ExperimentPhase::kEnded || cancelled_ || now.first_fault != Fault::kNone) {
    give_up(session, nullptr);
    return;
  }
  if (step_ == Step::kMoves) {
    static_cast<void>(begin_step(session, Step::kDither));
    return;
  }
  const bool identified = step_ == Step::kFastMoves;
  const char* problem = identified ? found.result().problem : found.begin_fast_moves();
  if (problem != nullptr) {
    give_up(session, problem);
    return;
  }
  step_ = identified ? Step::kTaking : Step::kResting;
  static_cast<void>(session.machine().post({.kind = Request::Kind::kRest}));
}

/// Without torque, for these are safety limits.
void CommissionStream::take(Session& session) {
  if (!session.take_staging_room()) {
    return;
  }
  ObserverConfig& observer = session.staged()[setup.axis].observer;
  observer = found.result().values;
  const SetAnswer answer = session.machine().configure(session.staged(), Rights::kMaintenance);
  for (const ParameterInfo& parameter : parameters()) {
    if (answer.taken() && parameter.group == std::string_view("observer")) {
      session.out() << "joint" << static_cast<std::uint32_t>(setup.axis) << ".observer." << parameter.name << ' ';
      print_value(session.out(), parameter, raw_value(session.staged()[setup.axis], parameter));
      session.out() << "\r\n";
    }
  }
  session.abandon();
  if (!answer.taken()) {
    print_refusal(session, answer);
    return;
  }
  session.out() << "# torque is off; 'save' keeps these values\r\n";
  session.answer_when_taken();
}

/// A template, so that a board that can not commission has no room for the stream.
template <typename Answer>
void begin_commissioning(Session& session, std::size_t axis, std::string_view arguments) {
  const AxisConfig& config = session.machine().config()[axis];
  auto& stream = session.make<Answer>();
  ExperimentSetup& setup = stream.setup;
  take_usual(setup, axis, config, session.machine().axis_telemetry(axis).q2_rad);
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    if (refuses_repeat(session, word, arguments)) {
      return;
    }
    if (!parse_option(word, setup)) {
      session.error("option", "an option is not understood, and nothing moved",
                    "write 'commission joint0 amplitude=0.2rad dither=5mNm'");
      return;
    }
  }
  if (!session.maintenance().is_open(session.machine().telemetry().tick)) {
    session.error("maintenance", "commissioning writes safety limits, and nothing moved",
                  "'maintenance open' first, with the key if one is set");
  } else if (MotorObserver::commissioned(config.observer)) {
    session.out()
        << "error commissioned: joint" << static_cast<std::uint32_t>(axis)
        << " is commissioned, its observer would take the dither for a fault, and nothing moved; 'disarm' and "
           "'set joint"
        << static_cast<std::uint32_t>(axis) << ".observer.inertia 0' to start again\r\n";
    session.refused();
  } else if (const char* problem = check_experiment(setup, config)) {
    refuse_experiment(session, problem);
  } else if (session.machine().telemetry().state != State::kHolding) {
    session.error("not_holding", "commissioning begins with torque on and every joint at rest",
                  "'arm' first, or wait until the joints stand");
  } else if (session.has_beside() || !session.machine().requests_taken()) {
    session.error("busy", "frames are being sent or the last request is under way, and nothing moved",
                  "'frames off' if they are on, and send the line again");
  } else {
    stream.found.begin(config.motor, config.control.stiffness_nm_per_rad);
    static_cast<void>(stream.begin(session));
  }
}

}  // namespace

void commands::commission(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (!session.parse_axis(joint, axis) || !joint.empty()) {
    session.error("unknown_joint", "there is no such joint", "write 'commission joint0'");
    return;
  }
  std::string_view rest = arguments;
  if (next_word(rest) == "looks" && rest.empty()) {
    commission_looks(session, axis);
    return;
  }
  if constexpr (MotorCommissioning::kAvailable) {
    begin_commissioning<CommissionStream>(session, axis, arguments);
  } else {
    session.error(
        "not_here", "this board has no floating point, which commissioning needs, and nothing moved",
        "commission such a joint on Linux and set observer.* here, or find them as docs/safety_concept.md says");
  }
}

}  // namespace capstan
