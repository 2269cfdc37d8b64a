// SPDX-License-Identifier: Apache-2.0
// The shell's commands that give torque and take it.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/safety/motor_commissioning.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

class ArmStream final : public ConsentStream {
 public:
  void step(Session& session) override;
};

void ArmStream::step(Session& session) {
  if (!session.machine().requests_taken()) {
    return;
  }
  const MachineTelemetry now = session.machine().telemetry();
  if (now.state == State::kArmed) {
    return;  // drives on a bus take their time until they follow
  }
  if (energised(now.state)) {
    session.ok();
    return;
  }
  for (const FaultInfo& entry : kFaultTable) {
    if ((now.conditions & bit(entry.code)) != 0) {
      print_fault(session, "blocked by ", entry);
    }
  }
  if (now.state == State::kFaulted) {
    session.error("faulted", "a fault is latched", "read 'faults', then 'disarm' and 'arm'");
  } else if (now.conditions == 0) {
    session.error("blocked", "what blocked arming is no longer present", "'arm' again");
  } else {
    session.error("blocked", "arming is blocked by the conditions above", "cure them and 'arm' again");
  }
}

}  // namespace

/// Without commissioned values nothing finds a sensor that lies, so somebody has to know that and stand by.
void commands::arm(Session& session, std::string_view /*arguments*/) {
  const auto joints = session.machine().config();
  const auto blind = std::find_if(joints.begin(), joints.end(), [](const AxisConfig& joint) {
    return joint.motor.fitted != 0 && !MotorObserver::commissioned(joint.observer);
  });
  const bool cautious = blind != joints.end() && !session.board().simulated();
  if (!cautious) {
    session.post<ArmStream>({.kind = Request::Kind::kArm});
    return;
  }
  const auto axis = static_cast<std::uint32_t>(blind - joints.begin());
  if (!session.maintenance().is_open(session.machine().telemetry().tick)) {
    session.out()
        << "error not_commissioned: the motor observer of joint" << axis
        << " has no values, so a faulty encoder or current sensor would not be detected in time, and there is "
           "no torque; ";
    if (MotorCommissioning::kAvailable) {
      session.out() << "'maintenance open', 'arm' and 'commission joint" << axis
                    << "', with everybody out of its reach, or 'apply' a joint that was commissioned\r\n";
    } else {
      session.out() << "'maintenance open' and 'arm' for slow motion with everybody out of its reach, and set joint"
                    << axis << ".observer.*, as docs/safety_concept.md says\r\n";
    }
    session.refused();
    return;
  }
  session.out() << "# joint" << axis
                << " is not commissioned: a quarter of limits.joint_speed, and a thirtieth of "
                   "limits.current as the largest change in a cycle\r\n";
  session.post<ArmStream>({.kind = Request::Kind::kArm, .cautious = kAllJoints});
}

void commands::disarm(Session& session, std::string_view /*arguments*/) {
  static_cast<void>(session.machine().post({.kind = Request::Kind::kDisarm}));  // never refused
  session.answer_when_taken();
}

}  // namespace capstan
