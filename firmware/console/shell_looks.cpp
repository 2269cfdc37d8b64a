// SPDX-License-Identifier: Apache-2.0
// The shell's command that finds by how much a motor at rest answers a look.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/parameters/parameters.hpp"
#include "capstan/firmware/safety/motor_commissioning.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

/// Looks at rest without a load, of which the middle answer is kept. They come every 20 to 50 cycles, and some joints
/// press on themselves within 200 of them, so torque is taken away and given back.
constexpr std::size_t kLooks = 8;
constexpr std::uint32_t kLooksCycles = 500;
constexpr int kArmings = 4;
/// Of the middle answer: where one of the eight is less, the joint swings on its servo (coarse counts) or trembles, and
/// its own answers are as small as those of half of the counts. Chosen in November 2026: 0.86 and more on 16 joints
/// that ran through (the campaign's, wrists 974000 to 974005, forceps and fingers 974000 to 974005), 0.70, 0 and 0 on
/// three that stopped by it (elbows 972000 and 972057, tuned wrist 971011).
constexpr Q24 kLeastOfMiddle = Q24::from_double(0.8);
/// Without torque before, so that the motor presses with none when it comes back.
constexpr std::uint32_t kRelaxCycles = 300;

/// rad/A of the joint's last look; 0 where it was answered by too few counts.
auto answer_of(const MotorConfig& motor, const AxisTelemetry& joint) -> Q24 {
  if (joint.look_counts < LookAnswer::kLeastCounts) {
    return {};
  }
  constexpr std::int64_t kTwoPi = Q24::from_double(6.283185307179586).raw();
  const std::int64_t angle = joint.look_counts * kTwoPi / motor.encoder_counts_per_turn;
  return Q24::from_wide((angle << 24) / std::max<std::int64_t>(joint.look_a.raw(), 1));
}

/// The joint rests, stands under torque, and looks come by themselves; then torque is off.
struct LooksStream final : Stream {
  std::size_t axis = 0;

  void begin(Session& session) {
    since_ = session.machine().telemetry().tick;
    static_cast<void>(session.machine().post({.kind = Request::Kind::kRest}));
    session.begin(*this);
  }
  [[maybe_unused]] void step(Session& session) override;  // not on a board that can not commission
  void cancel(Session& /*session*/) override { lost_ = true; }

 private:
  enum class Step : std::uint8_t { kRelaxing, kWaking, kLooking, kTaking };
  void look(Session& session, const MachineTelemetry& now);
  void take(Session& session);

  std::array<Q24, kLooks> answers_{};  // rad/A
  std::size_t looked_ = 0;
  std::uint32_t looks_ = 0;  // as telemetry counts them
  std::uint32_t since_ = 0;  // tick
  int armings_ = 0;
  Step step_ = Step::kRelaxing;
  bool lost_ = false;
};

void LooksStream::step(Session& session) {
  if (!session.machine().requests_taken()) {
    return;
  }
  const MachineTelemetry now = session.machine().telemetry();
  if (step_ == Step::kTaking) {
    take(session);
  } else if (step_ != Step::kRelaxing || lost_) {
    look(session, now);
  } else if (now.tick - since_ > kRelaxCycles) {
    step_ = Step::kWaking;
    const std::uint8_t cautious = session.board().simulated() ? 0 : kAllJoints;
    static_cast<void>(session.machine().post({.kind = Request::Kind::kArm, .cautious = cautious}));
  }
}

void LooksStream::look(Session& session, const MachineTelemetry& now) {
  const AxisTelemetry& joint = session.machine().axis_telemetry(axis);
  if (step_ == Step::kWaking && now.state == State::kHolding) {
    step_ = Step::kLooking;
    looks_ = joint.looks;
    since_ = now.tick;
  } else if (joint.looks != looks_ && step_ == Step::kLooking) {
    looks_ = joint.looks;
    answers_[looked_++] = answer_of(session.machine().config()[axis].motor, joint);
  }
  lost_ = lost_ || !energised(now.state);
  const bool waited = step_ == Step::kLooking && now.tick - since_ > kLooksCycles;
  if (lost_ || looked_ == kLooks || waited) {
    ++armings_;
    step_ = lost_ || looked_ == kLooks || armings_ == kArmings ? Step::kTaking : Step::kRelaxing;
    since_ = now.tick;
    static_cast<void>(session.machine().post({.kind = Request::Kind::kRest}));
  }
}

/// Without torque, for it is a safety limit.
void LooksStream::take(Session& session) {
  if (lost_) {
    if (const Fault first = session.machine().telemetry().first_fault; first != Fault::kNone) {
      print_fault(session, "ended by ", info(first));
    }
    session.error("aborted", "the torque was lost or did not come during the test pulses, and nothing was changed",
                  "read 'faults', and start it again");
    return;
  }
  if (!session.take_staging_room()) {
    return;
  }
  std::sort(answers_.begin(), answers_.end());
  ObserverConfig& observer = session.staged()[axis].observer;
  const Q24 middle = answers_[kLooks / 2 - 1];
  const bool steady = looked_ == kLooks && answers_[0] >= middle * kLeastOfMiddle;
  observer.answer_rad_per_a = steady ? middle : Q24{};
  observer.answer_gains = LookAnswer::mark(session.staged()[axis].control);
  const SetAnswer answer = session.machine().configure(session.staged(), Rights::kMaintenance);
  for (const ParameterInfo& parameter : parameters()) {
    if (answer.taken() && parameter.group == std::string_view("observer") &&
        std::string_view(parameter.name).starts_with("answer")) {
      session.out() << "joint" << static_cast<std::uint32_t>(axis) << ".observer." << parameter.name << ' ';
      print_value(session.out(), parameter, raw_value(session.staged()[axis], parameter));
      session.out() << "\r\n";
    }
  }
  session.abandon();
  if (!answer.taken()) {
    print_refusal(session, answer);
    return;
  }
  session.out() << (steady ? "# torque is off; 'save' keeps these values\r\n"
                           : "# the joint is under load or does not come to rest, so its response to test "
                             "pulses is not checked; torque is off\r\n");
  session.answer_when_taken();
}

/// A template, so that a board that can not commission has no room for the stream.
template <typename Answer>
void begin_looks(Session& session, std::size_t axis) {
  auto& stream = session.make<Answer>();
  stream.axis = axis;
  stream.begin(session);
}

}  // namespace

void commands::commission_looks(Session& session, std::size_t axis) {
  const MachineTelemetry now = session.machine().telemetry();
  if (!session.maintenance().is_open(now.tick)) {
    session.error("maintenance", "commissioning writes safety limits, and nothing moved",
                  "'maintenance open' first, with the key if one is set");
  } else if (!MotorObserver::commissioned(session.machine().config()[axis].observer)) {
    session.error("not_commissioned", "'commission looks' needs the other observer values first, and nothing moved",
                  "'commission' it first");
  } else if (now.state != State::kHolding) {
    session.error("not_holding", "looks need torque and every joint at rest",
                  "'arm' first, or wait until the joints stand");
  } else if (session.has_beside() || !session.machine().requests_taken()) {
    session.error("busy", "frames are being sent or the last request is under way, and nothing moved",
                  "'frames off' if they are on, and send the line again");
  } else {
    if constexpr (MotorCommissioning::kAvailable) {
      begin_looks<LooksStream>(session, axis);
    } else {
      session.error("not_here", "this board cannot commission, and nothing moved",
                    "commission such a joint on Linux and set observer.* here");
    }
  }
}

}  // namespace capstan
