// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/selftest.hpp"

#include <sys/utsname.h>

#include <array>
#include <chrono>
#include <fstream>
#include <iomanip>
#include <thread>

#include "capstan/boards/linux_rt/linux_rt_board.hpp"

namespace capstan {
namespace {

using std::chrono::microseconds;

/// A good wake-up on a real-time kernel of a small board under load.
constexpr microseconds kGoodWakeUp{100};

auto in_us(std::chrono::nanoseconds time) -> double {
  return static_cast<double>(time.count()) / 1000.0;
}

void print_times(std::ostream& out, const char* name, const TimeHistogram& times) {
  out << name << std::fixed << std::setprecision(1) << "median " << in_us(times.quantile(0.5)) << " us, 99.9 % "
      << in_us(times.quantile(0.999)) << " us, maximum " << in_us(times.maximum()) << " us\n";
}

void print_histogram(std::ostream& out, const RtReport& report) {
  constexpr std::array<std::size_t, 13> kEdges{
      0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, TimeHistogram::kBins - 1, TimeHistogram::kBins};
  out << "\n        us      wake-up        cycle\n";
  for (std::size_t i = 0; i + 1 < kEdges.size(); ++i) {
    const bool last = i + 2 == kEdges.size();
    out << std::setw(5) << kEdges[i] << (last ? "     " : "-") << std::left << std::setw(last ? 0 : 4);
    if (!last) {
      out << kEdges[i + 1];
    }
    out << std::right << std::setw(13) << report.wake_up.between(kEdges[i], kEdges[i + 1]) << std::setw(13)
        << report.cycle.between(kEdges[i], kEdges[i + 1]) << '\n';
  }
  out << '\n';
}

}  // namespace

auto machine_info() -> MachineInfo {
  MachineInfo machine;
  utsname name{};
  if (uname(&name) == 0) {
    machine.kernel = std::string(name.sysname) + ' ' + name.release + ' ' + name.version + ' ' + name.machine;
  }
  std::ifstream("/sys/kernel/realtime") >> machine.real_time;
  std::ifstream command_line("/proc/cmdline");
  std::getline(command_line, machine.command_line);
  return machine;
}

auto judge(const SelftestResult& result) -> Verdict {
  const RtReport& loop = result.loop;
  Verdict verdict;
  if (loop.cycles == 0) {
    verdict.failures.emplace_back("Not one cycle ran in time; end other programs or take a faster processor");
  }
  if (loop.overruns != 0) {
    const char* const too_long = "a cycle took too long here: keep other load off its processor (--cpu, isolcpus)";
    const char* const too_late =
        "the thread was woken too late: use a PREEMPT_RT kernel, real-time priority and a processor of its own (--cpu, "
        "isolcpus)";
    verdict.failures.push_back(std::to_string(loop.overruns) + " of " + std::to_string(loop.cycles + loop.overruns) +
                               " cycles were missed; " +
                               (loop.cycle.maximum() > loop.wake_up.maximum() ? too_long : too_late));
  }
  if (loop.minor_faults + loop.major_faults != 0) {
    verdict.failures.push_back(std::to_string(loop.minor_faults + loop.major_faults) +
                               " page faults in the loop; lock the memory and look for allocations in the cycle");
  }
  verdict.failures.insert(verdict.failures.end(), loop.remarks.begin(), loop.remarks.end());
  if (const FaultInfo& fault = info(result.firmware.first_fault); fault.code != Fault::kNone) {
    verdict.failures.push_back(std::string("The firmware took the torque away, ") + fault.name + ": " + fault.cause +
                               "; " + fault.cure);
  } else if (!energised(result.firmware.state)) {
    verdict.failures.emplace_back(
        "The joint had no torque at the end, so no cycle that moves one was timed; run it again, for longer (--for)");
  }
  if (!result.machine.real_time) {
    verdict.notes.emplace_back(
        "This is not a PREEMPT_RT kernel, so the maximum may grow without bound under load; install linux-image-rt");
  }
  if (loop.wake_up.maximum() > kGoodWakeUp) {
    verdict.notes.emplace_back(
        "A wake-up took over 100 us; governor performance, no deep sleep states and isolcpus shorten it (in an "
        "emulator the "
        "figure means nothing)");
  }
  return verdict;
}

void print_selftest(std::ostream& out, const SelftestResult& result) {
  const RtReport& loop = result.loop;
  out << "kernel       " << result.machine.kernel << (result.machine.real_time ? " (real-time)" : " (not real-time)")
      << '\n'
      << "started as   " << result.machine.command_line << '\n'
      << "priority     " << (loop.priority_granted ? "granted" : "refused") << '\n'
      << "memory       " << (loop.memory_locked ? "locked" : "not locked") << '\n'
      << "cycles       " << loop.cycles << " run, " << loop.overruns << " missed\n"
      << "page faults  " << loop.minor_faults << " minor, " << loop.major_faults << " major\n"
      << "firmware     " << name(result.firmware.state) << ", fault " << info(result.firmware.first_fault).name << '\n';
  print_times(out, "wake-up      ", loop.wake_up);
  print_times(out, "cycle        ", loop.cycle);
  print_histogram(out, loop);
  const Verdict verdict = judge(result);
  for (const std::string& failure : verdict.failures) {
    out << "fail: " << failure << ".\n";
  }
  for (const std::string& note : verdict.notes) {
    out << "note: " << note << ".\n";
  }
  out << (verdict.failures.empty() ? "verdict: pass; repeat it for an hour under load (--for 3600 beside stress-ng) "
                                     "before this machine controls a joint\n"
                                   : "verdict: fail; follow the advice above and run it again\n");
}

auto run_selftest(LinuxRtBoard& board, double seconds, bool (*interrupted)()) -> SelftestResult {
  using std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kLookAround{20};
  constexpr std::chrono::milliseconds kStroke{500};
  const auto end = steady_clock::now() + std::chrono::duration<double>(seconds);
  Request move{
      .kind = Request::Kind::kMove, .axis = 0, .position_rad = Q24::from_double(0.4), .speed_rad_s = Q24::from_int(1)};
  board.start();
  board.machine().post({.kind = Request::Kind::kArm});
  auto next_stroke = steady_clock::now() + kStroke;
  while (board.running() && !interrupted() && steady_clock::now() < end) {
    std::this_thread::sleep_for(kLookAround);
    if (steady_clock::now() >= next_stroke && board.machine().post(move)) {
      move.position_rad = -move.position_rad;
      next_stroke += kStroke;
    }
  }
  SelftestResult result;
  result.firmware = board.machine().telemetry();
  result.loop = board.stop();
  result.machine = machine_info();
  return result;
}

}  // namespace capstan
