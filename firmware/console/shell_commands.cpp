// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell_commands.hpp"

#include <algorithm>

#include "capstan/firmware/loop/version.hpp"

namespace capstan {
namespace {

// For commands that look at all of them by themselves, and for 'disarm', which is not refused over a word too many.
constexpr std::size_t kAnyNumber = Session::kLineLength;

// The type is written out: a deduced one puts the table into RAM.
constexpr std::array<ShellCommand, 31> kCommands = {
    ShellCommand{"help", "[COMMAND|PARAMETER|GROUP]", 1,
                 "lists the commands, or explains one command, or parameters with unit, range, default and meaning",
                 commands::help},
    ShellCommand{"version", "", 0, "firmware, board and number of parameters", commands::version},
    ShellCommand{"status", "", 0, "state, joint angles, currents and active limits", commands::status},
    ShellCommand{"faults", "[second|release]", 1,
                 "shows the latched fault, what blocks arming and the fault log; 'second' prints the last second "
                 "before a fault as CSV, 'release' allows it to be overwritten",
                 commands::faults},
    ShellCommand{"get", "jointN.group.name", 1, "one parameter with unit and range", commands::get},
    ShellCommand{"set", "jointN.group.name VALUE [UNIT]", kAnyNumber,
                 "changes one parameter, or stages it after 'begin'", commands::set},
    ShellCommand{"list", "[jointN[.group]]", 1, "parameters with unit, range and meaning", commands::list},
    ShellCommand{"dump", "", 0, "all parameters as lines that can be pasted back", commands::dump},
    ShellCommand{"diff", "", 0, "like 'dump', but only parameters that differ from their defaults", commands::diff},
    ShellCommand{"begin", "", 0, "starts staging: 'set' changes nothing until 'commit'", commands::begin},
    ShellCommand{"commit", "", 0, "takes all staged parameters, or none", commands::commit},
    ShellCommand{"abandon", "", 0, "discards all staged parameters", commands::abandon},
    ShellCommand{"defaults", "", 0, "stages the defaults of every parameter; 'commit' takes them", commands::defaults},
    ShellCommand{"save", "", 0, "writes the parameters to storage (disarmed only)", commands::save},
    ShellCommand{"load", "", 0, "reads the parameters back from storage (disarmed only)", commands::load},
    ShellCommand{
        "maintenance", "[open [KEY]|close|key NEWKEY|key none]", 2,
        "opens the safety limits (limits.*, observer.*, motor.speed_limit, motor.fitted) for changes, and of a "
        "commissioned joint its scale (motor.encoder_counts, motor.encoder_sign, motor.torque_per_current); "
        "if no key is set, 'maintenance open' is enough",
        commands::maintenance},
    ShellCommand{
        "arm", "", 0,
        "gives torque, holding the joints where they are; a stream that runs already counts after a pause of 0.1 s",
        commands::arm, true},
    ShellCommand{"disarm", "", kAnyNumber, "takes torque away and acknowledges a fault", commands::disarm},
    ShellCommand{
        "move", "jointN ANGLE [rad|deg] | jointN motor=ANGLE [rad|deg] | jointN force=TORQUE [rate=R] [corridor=ANGLE]",
        kAnyNumber,
        "moves the joint to ANGLE, or its motor to motor=ANGLE, within the limits; with the tip held, force=TORQUE "
        "ramps the joint torque, and corridor=ANGLE bounds the joint's travel",
        commands::move, true},
    ShellCommand{"hold", "jointN", 1, "brakes a joint and holds it", commands::hold, true},
    ShellCommand{"zero", "jointN [ANGLE [rad|deg]]", kAnyNumber,
                 "sets the motor's present angle, 0 without ANGLE (disarmed only)", commands::zero},
    ShellCommand{"log", "jointN COUNT [EVERY]", 3, "prints COUNT samples as CSV, one every EVERY ms", commands::log},
    ShellCommand{"experiment",
                 "jointN sine_ladder|multisine|decaying_sine|triangle|speed_ladder|reversals|torque_triangle "
                 "[amplitude=A] [offset=A] [frequencies=F,F..|speeds=V,V..|rates=R] [decay=D] [levels=N] [duration=S] "
                 "[cycles=N] [repeats=N] [every=MS] | jointN multisine|chirp on=torque|reference [amplitude=A] "
                 "[from=HZ] [to=HZ] [duration=S] [offset=A] [travel=A] [speed=V] [corridor=A] [every=MS]",
                 kAnyNumber,
                 "runs an identification motion within the limits and prints the log; with 'on=' it excites the joint "
                 "so that 'capstan tune' can read its frequency response from the log",
                 commands::experiment, true},
    ShellCommand{"commission", "jointN [amplitude=ANGLE] [dither=TORQUE] | jointN looks", kAnyNumber,
                 "moves a joint back and forth around its position and dithers its motor to find the motor observer's "
                 "values, then takes the torque away and sets observer.* (in maintenance only); 'looks' finds "
                 "observer.answer again, which every change of gains requires",
                 commands::commission, true},
    ShellCommand{
        "palpate",
        "jointN [site=N] [amplitude=TORQUE] [offset=TORQUE] [rates=R] [cycles=N] [every=MS] | map [FACTOR] | clear",
        kAnyNumber,
        "presses with torque triangles about the offset at the joint's position and prints the log of that site and "
        "its stiffness; 'map' shows the sites so far and marks those above FACTOR (1.2) times the median",
        commands::palpate, true},
    ShellCommand{"watch", "[EVERY] SIGNAL...", 1 + ScopeSetup::kMostChannels,
                 "prints signals every EVERY ms (200) until the next line or Ctrl-C", commands::watch},
    ShellCommand{"frames", "[[EVERY] SIGNAL...|off]", 1 + kMostSignals,
                 "sends signals as binary frames every EVERY ms (10) between the text, for 'capstan record'",
                 commands::frames},
    ShellCommand{"scope", "[signals|channels SIGNAL...|trigger WHAT|start [SAMPLES [BEFORE [EVERY]]]|stop|dump]",
                 kAnyNumber, "captures signals in every cycle around a trigger; without arguments: shows its status",
                 commands::scope},
    ShellCommand{"model", "[jointN]", 1, "the law's terms, what they mean and their parameters", commands::model},
    ShellCommand{"timing", "", 0, "timing of the cycle, overruns, and log samples and characters lost",
                 commands::timing},
    ShellCommand{"reboot", "", 0, "restarts the firmware (disarmed only)", commands::reboot, true},
};

}  // namespace

auto shell_commands() -> std::span<const ShellCommand> {
  return kCommands;
}

namespace {

/// Two parts a command: what it takes, and what it does.
class HelpStream final : public PartsStream {
 public:
  const ShellCommand* only = nullptr;  ///< nullptr: all

 private:
  auto print(Session& session, std::uint32_t part) -> bool override {
    if (part == 2 * kCommands.size()) {
      if (only == nullptr) {
        session.board().print_commands(session.out());
      }
      session.ok();
      return false;
    }
    const ShellCommand& command = kCommands[part / 2];
    if (only != nullptr && &command != only) {
      return true;
    }
    if (part % 2 == 0) {
      session.out() << "  " << command.name << ' ' << command.arguments << "\r\n";
    } else {
      session.out() << "      " << command.help << "\r\n";
    }
    return true;
  }
};

}  // namespace

void commands::help(Session& session, std::string_view arguments) {
  const std::string_view about = next_word(arguments);
  const auto* const named = std::find_if(kCommands.begin(), kCommands.end(),
                                         [about](const ShellCommand& command) { return about == command.name; });
  if (named == kCommands.end() && !about.empty()) {
    help_parameters(session, about);
    return;
  }
  auto& stream = session.make<HelpStream>();
  stream.only = about.empty() ? nullptr : named;
  session.answer(stream);
}

auto refuses_more(Session& session, std::string_view rest) -> bool {
  const bool more = !next_word(rest).empty();
  if (more) {
    session.error("usage", "the command was given more words than it takes, and nothing was done",
                  "'help' shows its arguments");
  }
  return more;
}

auto refuses_repeat(Session& session, std::string_view word, std::string_view rest) -> bool {
  const auto name_of = [](std::string_view option) {
    return std::string_view(option.data(), std::min(option.find('='), option.size()));
  };
  for (std::string_view next = next_word(rest); !next.empty(); next = next_word(rest)) {
    if (name_of(next) == name_of(word)) {
      session.out() << "error option: '" << name_of(word) << "' is given twice, and nothing moved; give it once\r\n";
      session.refused();
      return true;
    }
  }
  return false;
}

auto parse_count(std::string_view text, std::int32_t minimum, std::int32_t maximum, std::int32_t& value) -> bool {
  return parse_integer(text, value) == ParseResult::kOk && value >= minimum && value <= maximum;
}

void commands::version(Session& session, std::string_view /*arguments*/) {
  session.out() << "capstan " << kVersion << " board " << session.board().name() << " joints "
                << static_cast<std::uint32_t>(session.machine().axes()) << " parameters "
                << static_cast<std::uint32_t>(parameters().size());
  session.board().print_image(session.out());
  session.out() << "\r\n";
  session.ok();
}

void commands::timing(Session& session, std::string_view /*arguments*/) {
  const MachineTelemetry now = session.machine().telemetry();
  session.out() << "cycles " << now.tick << " of 1 ms, overruns " << now.overruns << ", log samples dropped "
                << session.machine().recorder().dropped() << ", console characters dropped "
                << session.characters_dropped() << "\r\n";
  session.board().print_timing(session.out());
  session.ok();
}

void commands::reboot(Session& session, std::string_view /*arguments*/) {
  const State state = session.machine().telemetry().state;
  if (energised(state) || state == State::kFaulted || !session.machine().requests_taken()) {
    session.error("not_disarmed", "a reboot would drop the joint or forget an unacknowledged fault", "'disarm' first");
    return;
  }
  session.ok();
  session.board().reboot();
}

}  // namespace capstan
