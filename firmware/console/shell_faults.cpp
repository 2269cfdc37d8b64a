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
  for (std::uint32_t joint = 0; joint < Session::kMaxAxes; ++joint) {
    if ((entry.joints & (1U << joint)) != 0) {
      out << ", joint" << joint;
    }
  }
  for (const FaultInfo& other : kFaultTable) {
    if (other.code != entry.fault && (entry.conditions & bit(other.code)) != 0) {
      out << ", with " << other.name;
    }
  }
  out << "\r\n";
}

class FaultSecondStream final : public Stream {
 public:
  void step(Session& session) override;
  void cancel(Session& /*session*/) override { cancelled_ = true; }

 private:
  std::size_t next_ = 0;  // sample
  bool cancelled_ = false;
};

void FaultSecondStream::step(Session& session) {
  constexpr std::size_t kLinesAtOnce = 4;
  FaultLog& log = session.machine().fault_log();
  if (cancelled_) {
    session.ok();  // not all of it was seen: it stays kept
    return;
  }
  const StepTime time(session.machine());
  Print& out = session.out();
  const std::size_t end = std::min(log.kept(), next_ + kLinesAtOnce);
  for (; next_ < end && time.left(); ++next_) {
    const std::int32_t cycles = log.cycles_from_fault(next_);
    out << (cycles < 0 ? "-" : "");
    print_seconds(out, static_cast<std::uint32_t>(-cycles));
    for (std::size_t axis = 0; axis < session.machine().axes(); ++axis) {
      for (std::size_t i = 0; i < FaultLog::kSignals; ++i) {
        out << ',' << Q24::from_raw(log.raw(next_, axis, i));
      }
    }
    out << "\r\n";
  }
  if (next_ >= log.kept()) {  // another console may have released it meanwhile
    log.release();
    session.ok();
  }
}

void fault_second(Session& session) {
  if (session.machine().fault_log().kept() == 0) {
    session.error("nothing_kept", "no pre-fault recording is stored",
                  "a fault under torque stores one, until it is printed and the joints are armed again");
    return;
  }
  session.out() << "time_s";
  for (std::size_t axis = 0; axis < session.machine().axes(); ++axis) {
    for (const SignalInfo* signal : FaultLog::signals()) {
      session.out() << ',';
      print_column(session.out(), {signal, static_cast<std::uint8_t>(axis)});
    }
  }
  session.out() << "\r\n";
  session.begin(session.make<FaultSecondStream>());
}

}  // namespace

/// With the joints that show it, where it is a joint's.
void print_fault(Session& session, const char* what, const FaultInfo& entry) {
  Print& out = session.out();
  out << what << entry.name << ": " << entry.cause << "; " << entry.cure;
  const char* before = " (joint";
  for (std::size_t axis = 0; axis < session.machine().axes(); ++axis) {
    if ((session.machine().axis_telemetry(axis).faults & bit(entry.code)) != 0) {
      out << before << static_cast<std::uint32_t>(axis);
      before = ", joint";
    }
  }
  out << (before[0] == ',' ? ")\r\n" : "\r\n");
}

namespace {

void print_latched(Session& session, const MachineTelemetry& now) {
  Print& out = session.out();
  const FaultInfo& first = info(now.first_fault);
  out << "latched " << first.name << ": " << first.cause << "; " << first.cure << "\r\n";
  if (now.first_fault != Fault::kNone) {
    const SafeStop stop = safe_stop(now.conditions | bit(now.first_fault), session.board().stop_means());
    out << "stopped by " << name(stop) << "\r\n";
  }
}

void print_joint_warnings(Session& session, std::uint32_t axis) {
  if (const AxisTelemetry joint = session.machine().axis_telemetry(axis); joint.warnings != 0) {
    session.out() << "joint" << axis << ", warnings, which stop nothing:\r\n";
    print_warnings(session.out(), joint.warnings);
    print_tendons(session.out(), joint);
  }
}

void print_logged(Print& out, const FaultLog& log, std::uint32_t age) {
  if (age < log.count()) {
    out << (age == 0 ? "last " : "before ");
    print_entry(out, log.entry(age));
  }
}

void print_kept(Print& out, const FaultLog& log) {
  if (log.kept() > 0) {
    out << "recorded is the second before ";
    print_entry(out, log.kept_entry());
    out << "'faults second' prints it; until then later faults are listed only\r\n";
  }
}

/// What is latched, what is present one by one, what warns, and the log.
class FaultsStream final : public PartsStream {
  auto print(Session& session, std::uint32_t part) -> bool override;
};

auto FaultsStream::print(Session& session, std::uint32_t part) -> bool {
  constexpr std::uint32_t kWarns = 1 + kFaultTable.size();
  const std::uint32_t joints = kWarns + 1;
  const auto logged = joints + static_cast<std::uint32_t>(session.machine().axes());
  const std::uint32_t last = logged + FaultLog::kEntries;
  const MachineTelemetry now = session.machine().telemetry();
  if (part == 0) {
    print_latched(session, now);
  } else if (part < kWarns) {
    if (const FaultInfo& entry = kFaultTable[part - 1]; (now.conditions & bit(entry.code)) != 0) {
      print_fault(session, "present ", entry);
    }
  } else if (part < joints) {
    print_warnings(session.out(), now.warnings);
  } else if (part < logged) {
    print_joint_warnings(session, part - joints);
  } else if (part < last) {
    print_logged(session.out(), session.machine().fault_log(), part - logged);
  } else {
    print_kept(session.out(), session.machine().fault_log());
    session.ok();
    return false;
  }
  return true;
}

}  // namespace

void commands::faults(Session& session, std::string_view arguments) {
  const std::string_view word = next_word(arguments);
  if (word == "second") {
    fault_second(session);
    return;
  }
  if (word == "release") {
    session.machine().fault_log().release();
    session.ok();
    return;
  }
  if (!word.empty()) {
    session.error("usage", "faults knows 'second' and 'release'",
                  "without arguments it shows what is latched, present and logged");
    return;
  }
  session.answer(session.make<FaultsStream>());
}

}  // namespace capstan
