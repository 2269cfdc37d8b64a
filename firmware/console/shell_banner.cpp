// SPDX-License-Identifier: Apache-2.0
// What the shell says unasked: to who has just come, and about stored parameters that are not what was saved.
#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/loop/version.hpp"

namespace capstan {
namespace {

void print_migration(Print& out, const char* begin, const LoadReport& report) {
  out << begin << "stored parameters are another version's:";
  const char* before = " ";
  const auto count = [&out, &before](std::uint16_t values, const char* what) {
    if (values != 0) {
      out << before << std::uint32_t{values} << what;
      before = ", ";
    }
  };
  count(report.absent, " of today's were not in it and have their defaults");
  count(report.out_of_range, " are outside today's range and have their defaults");
  count(report.unknown, " have names that are unknown today and were left out");
  if (report.first_default != nullptr) {
    out << " (the first default: " << report.first_default->group << '.' << report.first_default->name << ')';
  }
  out << "; all others were taken over; look at 'diff', then 'save'\r\n";
}

}  // namespace

void print_load_report(Print& out, const LoadReport& report, const char* begin) {
  switch (report.result) {
    case LoadResult::kLoaded:
      if (report.older) {
        out << begin
            << "the parameters saved last are not whole (power went while they were saved, or the memory has aged); "
               "the set before them is in use, with its limits and its maintenance key; look at 'diff', then "
               "'save'\r\n";
      }
      if (report.migrated()) {
        print_migration(out, begin, report);
      }
      break;
    case LoadResult::kForeign:
      out << begin << "stored parameters have format " << report.format
          << ", which this version does not read; defaults are in use until a set is loaded or saved\r\n";
      break;
    case LoadResult::kCorrupt:
    case LoadResult::kUnreadable:
      out << begin << "stored parameters are " << (report.result == LoadResult::kCorrupt ? "corrupt" : "not readable")
          << "; defaults are in use until a set is loaded or saved\r\n";
      break;
    case LoadResult::kUnfinished:
      out << begin << "power went while the first set was saved; defaults are in use\r\n";
      break;
    case LoadResult::kEmpty:
      out << begin << "no parameters were ever saved; defaults are in use\r\n";
      break;
    case LoadResult::kRefused:
      break;
  }
}

void Shell::print_banner() {
  const MachineTelemetry now = machine_.telemetry();
  out_ << "# capstan " << kVersion << " on board " << board_.name() << ", joints "
       << static_cast<std::uint32_t>(machine_.axes()) << ", state " << name(now.state);
  if (now.first_fault != Fault::kNone) {
    out_ << " by " << info(now.first_fault).name << ": 'faults' says what to do";
  } else if (now.conditions != 0) {
    out_ << ", something blocks arming: 'faults' says what";
  }
  out_ << "\r\n";
  print_load_report(out_, machine_.load_report(), "# ");
  out_ << "# 'help' lists the commands, Tab completes, 'status' shows the joints, 'arm' gives torque, 'disarm' takes "
          "it\r\n";
  editor_.prompt();
  lines_.flush();
}

}  // namespace capstan
