// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "capstan/firmware/loop/machine.hpp"
#include "capstan/hal/linux/rt_loop.hpp"

namespace capstan {

class LinuxRtBoard;

/// The machine a timing figure belongs to.
struct MachineInfo {
  std::string kernel;        ///< as uname tells it
  std::string command_line;  ///< the kernel's
  bool real_time = false;    ///< PREEMPT_RT
};
auto machine_info() -> MachineInfo;

/// A run and where it took place.
struct SelftestResult {
  RtReport loop;
  MachineTelemetry firmware;  ///< at the end of the motion
  MachineInfo machine;
};

/// What a run says about the machine.
struct Verdict {
  std::vector<std::string> failures;  ///< "sentence; next step"; none: passed
  std::vector<std::string> notes;     ///< what is worth doing though it passed
};
auto judge(const SelftestResult& result) -> Verdict;

/// Histograms, figures, machine and verdict.
void print_selftest(std::ostream& out, const SelftestResult& result);

/// Runs the board with the joint moving to and fro, until the time is over or `interrupted` says so.
auto run_selftest(LinuxRtBoard& board, double seconds, bool (*interrupted)()) -> SelftestResult;

}  // namespace capstan
