// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell_commands.hpp"

#include <algorithm>

#include "capstan/firmware/loop/version.hpp"
#include "capstan/firmware/safety/motor_commissioning.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

namespace capstan {
namespace {

// For commands that look at all of them by themselves, and for 'disarm', which is not refused over a word too many.
constexpr std::size_t kAnyNumber = Shell::kLineLength;

// The type is written out: a deduced one puts the table into RAM.
constexpr std::array<ShellCommand, 31> kCommands = {
    ShellCommand{"help", "[COMMAND|PARAMETER|GROUP]", 1,
                 "this list; of one command, or of parameters with unit, range, default and meaning",
                 ShellCommands::help},
    ShellCommand{"version", "", 0, "firmware, board and number of parameters", ShellCommands::version},
    ShellCommand{"status", "", 0, "state, joint angles, currents and active limits", ShellCommands::status},
    ShellCommand{"faults", "[second|release]", 1,
                 "what is latched, what would block arming, and the log; the last second before a fault, as CSV",
                 ShellCommands::faults},
    ShellCommand{"get", "jointN.group.name", 1, "one parameter with unit and range", ShellCommands::get},
    ShellCommand{"set", "jointN.group.name VALUE [UNIT]", kAnyNumber,
                 "changes one parameter, or stages it after 'begin'", ShellCommands::set},
    ShellCommand{"list", "[jointN[.group]]", 1, "parameters with unit, range and meaning", ShellCommands::list},
    ShellCommand{"dump", "", 0, "all parameters as lines that can be pasted back", ShellCommands::dump},
    ShellCommand{"diff", "", 0, "the same, only what differs from the defaults", ShellCommands::diff},
    ShellCommand{"begin", "", 0, "starts staging: 'set' changes nothing until 'commit'", ShellCommands::begin},
    ShellCommand{"commit", "", 0, "takes all staged parameters, or none", ShellCommands::commit},
    ShellCommand{"abandon", "", 0, "forgets what was staged", ShellCommands::abandon},
    ShellCommand{"defaults", "", 0, "stages the defaults of every parameter; 'commit' takes them",
                 ShellCommands::defaults},
    ShellCommand{"save", "", 0, "writes the parameters to storage (disarmed only)", ShellCommands::save},
    ShellCommand{"load", "", 0, "reads them back from storage (disarmed only)", ShellCommands::load},
    ShellCommand{
        "maintenance", "[open [KEY]|close|key NEWKEY|key none]", 2,
        "opens the safety limits (limits.*, observer.*, motor.speed_limit) for changes; without a key set, 'open' does",
        ShellCommands::maintenance},
    ShellCommand{"arm", "", 0, "gives torque, holding the joints where they are", ShellCommands::arm, true},
    ShellCommand{"disarm", "", kAnyNumber, "takes torque away and acknowledges a fault", ShellCommands::disarm},
    ShellCommand{
        "move", "jointN ANGLE [rad|deg] | jointN motor=ANGLE [rad|deg] | jointN force=TORQUE [rate=R]", kAnyNumber,
        "moves a joint within its limits, or its motor, or, tip held, brings its torque there by the force law",
        ShellCommands::move, true},
    ShellCommand{"hold", "jointN", 1, "brakes a joint and holds it", ShellCommands::hold, true},
    ShellCommand{"zero", "jointN [ANGLE [rad|deg]]", kAnyNumber,
                 "says at which motor angle the joint stands now (disarmed only)", ShellCommands::zero},
    ShellCommand{"log", "jointN COUNT [EVERY]", 3, "prints COUNT samples as CSV, one every EVERY ms",
                 ShellCommands::log},
    ShellCommand{
        "experiment",
        "jointN sine_ladder|multisine|decaying_sine|triangle|speed_ladder|reversals|torque_triangle "
        "[amplitude=A] [offset=A] [frequencies=F,F..|speeds=V,V..|rates=R] [decay=D] [levels=N] [duration=S] "
        "[cycles=N] [repeats=N] [every=MS] | jointN multisine|chirp on=torque|reference [amplitude=A] "
        "[from=HZ] [to=HZ] [duration=S] [offset=A] [travel=A] [speed=V] [corridor=A] [every=MS]",
        kAnyNumber,
        "moves a joint as a law needs it to be identified, within its limits, and prints the log; with 'on=' it "
        "shakes the joint for 'capstan tune' to read its frequency response from the log",
        ShellCommands::experiment, true},
    ShellCommand{"commission", "jointN [amplitude=ANGLE] [dither=TORQUE]", kAnyNumber,
                 "moves a joint to and fro about where it stands and shakes its motor a little, to find what the motor "
                 "observer needs; takes the torque away and sets observer.* (in maintenance only)",
                 ShellCommands::commission, true},
    ShellCommand{"palpate", "jointN [site=N] [amplitude=TORQUE] [rates=R] [cycles=N] [every=MS] | map | clear",
                 kAnyNumber,
                 "presses with torque triangles where the joint stands, and prints the log of that site and its "
                 "stiffness; 'map' shows the sites so far",
                 ShellCommands::palpate, true},
    ShellCommand{"watch", "[EVERY] SIGNAL...", 1 + ScopeSetup::kMostChannels,
                 "prints signals every EVERY ms (200) until the next line or Ctrl-C", ShellCommands::watch},
    ShellCommand{"frames", "[[EVERY] SIGNAL...|off]", 1 + kMostSignals,
                 "sends signals as binary frames every EVERY ms (10) between the text, for 'capstan record'",
                 ShellCommands::frames},
    ShellCommand{"scope", "[signals|channels SIGNAL...|trigger WHAT|start [SAMPLES [BEFORE [EVERY]]]|stop|dump]",
                 kAnyNumber, "captures signals in every cycle around a trigger; alone: how it stands",
                 ShellCommands::scope},
    ShellCommand{"model", "[jointN]", 1, "the law's terms, what they mean and their parameters", ShellCommands::model},
    ShellCommand{"timing", "", 0, "how well the cycle keeps its time, and what was lost", ShellCommands::timing},
    ShellCommand{"reboot", "", 0, "starts the firmware anew (disarmed only)", ShellCommands::reboot, true},
};

}  // namespace

auto shell_commands() -> std::span<const ShellCommand> {
  return kCommands;
}

void ShellCommands::help(Shell& shell, std::string_view arguments) {
  const std::string_view about = next_word(arguments);
  bool found = false;
  for (const ShellCommand& command : kCommands) {
    if (about.empty() || about == command.name) {
      shell.out_ << "  " << command.name << ' ' << command.arguments << "\r\n      " << command.help << "\r\n";
      found = true;
    }
  }
  if (about.empty()) {
    shell.board_.print_commands(shell.out_);
  }
  if (found) {
    shell.ok();
  } else {
    help_parameters(shell, about);
  }
}

void ShellCommands::version(Shell& shell, std::string_view /*arguments*/) {
  shell.out_ << "capstan " << kVersion << " board " << shell.board_.name() << " joints "
             << static_cast<std::uint32_t>(shell.machine_.axes()) << " parameters "
             << static_cast<std::uint32_t>(parameters().size());
  shell.board_.print_image(shell.out_);
  shell.out_ << "\r\n";
  shell.ok();
}

void ShellCommands::post(Shell& shell, const Request& request, Shell::Activity activity) {
  if (shell.machine_.post(request)) {
    shell.activity_ = activity;
  } else {
    shell.error("busy", "the cycle has not taken the last request yet", "send the line again");
  }
}

/// Without commissioned values nothing finds a sensor that lies, so somebody has to know that and stand by.
void ShellCommands::arm(Shell& shell, std::string_view /*arguments*/) {
  const auto joints = shell.machine_.config();
  const auto blind = std::find_if(joints.begin(), joints.end(), [](const AxisConfig& joint) {
    return joint.motor.fitted != 0 && !MotorObserver::commissioned(joint.observer);
  });
  const bool cautious = blind != joints.end() && !shell.board_.simulated();
  if (!cautious) {
    post(shell, {.kind = Request::Kind::kArm}, Shell::Activity::kArming);
    return;
  }
  const auto axis = static_cast<std::uint32_t>(blind - joints.begin());
  if (!shell.maintenance_.is_open(shell.machine_.telemetry().tick)) {
    shell.out_ << "error not_commissioned: the motor observer of joint" << axis
               << " has no values, so an encoder or current sensor that lies would not be found in time, and there is "
                  "no torque; ";
    if (MotorCommissioning::kAvailable) {
      shell.out_ << "'maintenance open', 'arm' and 'commission joint" << axis
                 << "', with everybody out of its reach, or 'apply' a joint that was commissioned\r\n";
    } else {
      shell.out_ << "'maintenance open' and 'arm' for slow motion with everybody out of its reach, and set joint"
                 << axis << ".observer.*, as docs/safety_concept.md says\r\n";
    }
    shell.prompt();
    return;
  }
  shell.out_ << "# joint" << axis
             << " is not commissioned: a quarter of limits.joint_speed, and a thirtieth of "
                "limits.current as the largest change in a cycle\r\n";
  post(shell, {.kind = Request::Kind::kArm, .cautious = true}, Shell::Activity::kArming);
}

void ShellCommands::disarm(Shell& shell, std::string_view /*arguments*/) {
  post(shell, {.kind = Request::Kind::kDisarm}, Shell::Activity::kDisarming);
}

void ShellCommands::timing(Shell& shell, std::string_view /*arguments*/) {
  const MachineTelemetry now = shell.machine_.telemetry();
  shell.out_ << "cycles " << now.tick << " of 1 ms, overruns " << now.overruns << ", log samples dropped "
             << shell.machine_.recorder().dropped() << ", console characters dropped " << shell.sink_.dropped()
             << "\r\n";
  shell.board_.print_timing(shell.out_);
  shell.ok();
}

void ShellCommands::reboot(Shell& shell, std::string_view /*arguments*/) {
  const State state = shell.machine_.telemetry().state;
  if (energised(state) || state == State::kFaulted || !shell.machine_.settled()) {
    shell.error("not_disarmed", "a reboot would drop the joint or forget a fault that nobody has acknowledged",
                "'disarm' first");
    return;
  }
  shell.ok();
  shell.board_.reboot();
}

}  // namespace capstan
