// SPDX-License-Identifier: Apache-2.0
// The shell's command that shows faults: what is latched, what is present, and what happened before.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

void print_entry(Print& out, const FaultEntry& entry) {
  out << "start " << entry.start << ", " << entry.tick / 1000 << " s";
  if (entry.fault == Fault::kNone) {
    out << ": the firmware ended with torque on (reset, crash or power)\r\n";
    return;
  }
  out << ": " << info(entry.fault).name << " while " << name(entry.state);
  for (std::uint32_t joint = 0; joint < Shell::kMaxAxes; ++joint) {
    if ((entry.joints & (1U << joint)) != 0) {
      out << ", joint" << joint;
    }
  }
  for (const FaultInfo& other : kFaultTable) {
    if (other.fault != entry.fault && (entry.conditions & bit(other.fault)) != 0) {
      out << ", with " << other.name;
    }
  }
  out << "\r\n";
}

}  // namespace

void ShellCommands::faults(Shell& shell, std::string_view arguments) {
  const std::string_view word = next_word(arguments);
  if (word == "second") {
    fault_second(shell);
    return;
  }
  if (word == "release") {
    shell.machine_.fault_log().release();
    shell.ok();
    return;
  }
  if (!word.empty()) {
    shell.error("usage", "faults knows 'second' and 'release'", "alone it shows what is latched, present and logged");
    return;
  }
  const MachineTelemetry now = shell.machine_.telemetry();
  const FaultInfo& first = info(now.first_fault);
  Print& out = shell.out_;
  out << "latched " << first.name << ": " << first.cause << "; " << first.cure << "\r\n";
  if (now.first_fault != Fault::kNone) {
    const SafeStop stop = safe_stop(now.conditions | bit(now.first_fault), shell.board_.stop_means());
    out << "stopped by " << name(stop) << "\r\n";
  }
  for (const FaultInfo& entry : kFaultTable) {
    if ((now.conditions & bit(entry.fault)) != 0) {
      shell.print_fault("present ", entry);
    }
  }
  shell.print_warnings(now.warnings);
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    if (const AxisTelemetry joint = shell.machine_.axis_telemetry(axis); joint.warnings != 0) {
      out << "joint" << static_cast<std::uint32_t>(axis) << ", nothing is stopped by this:\r\n";
      shell.print_warnings(joint.warnings);
      shell.print_tendons(joint);
    }
  }
  fault_history(shell);
  shell.ok();
}

void ShellCommands::fault_history(Shell& shell) {
  Print& out = shell.out_;
  const FaultLog& log = shell.machine_.fault_log();
  const auto shown = std::min<std::uint32_t>(log.count(), FaultLog::kEntries);
  for (std::uint32_t age = 0; age < shown; ++age) {
    out << (age == 0 ? "last " : "before ");
    print_entry(out, log.entry(age));
  }
  if (log.kept() > 0) {
    out << "kept is the second before ";
    print_entry(out, log.kept_entry());
    out << "'faults second' prints it; until then later faults are listed only\r\n";
  }
}

void ShellCommands::fault_second(Shell& shell) {
  if (shell.machine_.fault_log().kept() == 0) {
    shell.error("nothing_kept", "no second before a fault is kept",
                "it is after a fault under torque, until it was printed and the joints are armed again");
    return;
  }
  shell.out_ << "time_s";
  for (std::size_t axis = 0; axis < shell.machine_.axes(); ++axis) {
    for (const SignalInfo* signal : FaultLog::signals()) {
      shell.out_ << ',';
      print_column(shell.out_, {signal, static_cast<std::uint8_t>(axis)});
    }
  }
  shell.out_ << "\r\n";
  shell.dump_next_ = 0;
  shell.activity_ = Shell::Activity::kDumpingFaults;
}

void Shell::go_on_dumping_faults() {
  constexpr std::size_t kLinesAtOnce = 4;
  FaultLog& log = machine_.fault_log();
  const std::size_t end = std::min(log.kept(), dump_next_ + kLinesAtOnce);
  for (; dump_next_ < end; ++dump_next_) {
    const std::int32_t cycles = log.cycles_from_fault(dump_next_);
    out_ << (cycles < 0 ? "-" : "");
    print_seconds(out_, static_cast<std::uint32_t>(-cycles));
    for (std::size_t axis = 0; axis < machine_.axes(); ++axis) {
      for (std::size_t i = 0; i < FaultLog::kSignals; ++i) {
        out_ << ',' << Q24::from_raw(log.raw(dump_next_, axis, i));
      }
    }
    out_ << "\r\n";
  }
  if (dump_next_ == log.kept()) {
    log.release();
    ok();
  } else if (dump_next_ > log.kept()) {  // Ctrl-C: not all of it was seen
    ok();
  }
}

}  // namespace capstan
