// SPDX-License-Identifier: Apache-2.0
// Runs `capstan identify` and `capstan diagnose` on logs of growing length and prints the processor time they take.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tests/tools/synthetic_joint.hpp"

namespace capstan::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 200.0;
constexpr int kCycles = 4;

auto joint_log(long samples) -> AxisLog {
  test::SyntheticRequest request;
  request.truth = test::Truth::kPlay;
  request.rate_hz = kRateHz;
  request.cycles = kCycles;
  request.cycle_s = static_cast<double>(samples) / kRateHz / kCycles;
  return test::synthetic_log(request);
}

auto effort_log(long samples) -> AxisLog {
  test::EffortRequest request;
  request.truth = test::EffortTruth::kStribeck;
  request.rate_hz = kRateHz;
  request.cycles = static_cast<int>(std::lround(static_cast<double>(samples) / kRateHz / request.cycle_s));
  return test::synthetic_effort_log(request);
}

/// Many slack springs side by side: plays of all widths up to 0.1 N m.
auto force_log(long samples) -> AxisLog {
  AxisLog log;
  log.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) / kRateHz);
  log.tau_nm = log.time_s.unaryExpr(
      [](double t) { return 0.07 * std::sin(0.31 * t) + 0.05 * std::sin(0.83 * t + 1.0) + 0.03 * std::sin(1.7 * t); });
  log.effort = Eigen::VectorXd::Zero(samples);
  std::array<double, 50> plays{};
  for (Eigen::Index i = 0; i < samples; ++i) {
    for (std::size_t k = 0; k < plays.size(); ++k) {
      const double width = 0.1 * (static_cast<double>(k) + 0.5) / static_cast<double>(plays.size());
      plays[k] = std::min(std::max(plays[k], log.tau_nm[i] - width), log.tau_nm[i] + width);
      log.effort[i] += 0.7 * plays[k] / static_cast<double>(plays.size());
    }
    log.effort[i] += 2e-4 * std::sin(12.9898 * static_cast<double>(i * i % 9973));  // no two rows are quite alike
  }
  log.q1_rad = 2.0 * log.tau_nm;
  return log;
}

struct Kind {
  const char* title;
  const char* header;
  std::function<AxisLog(long)> log;
  std::vector<const Eigen::VectorXd AxisLog::*> columns;
  const char* command;  ///< with the log's name to be appended
};

auto kinds() -> std::vector<Kind> {
  const char* const joint = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad";
  const char* const effort = "time_s,axis0/q1_rad,axis0/tau_Nm";
  const char* const force = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/tau_out_Nm";
  using Log = AxisLog;
  const std::vector<const Eigen::VectorXd Log::*> angles = {&Log::time_s, &Log::q1_rad, &Log::tau_nm, &Log::q2_rad};
  const std::vector<const Eigen::VectorXd Log::*> motion = {&Log::time_s, &Log::q1_rad, &Log::effort};
  const std::vector<const Eigen::VectorXd Log::*> forces = {&Log::time_s, &Log::q1_rad, &Log::tau_nm, &Log::effort};
  return {{"identify joint angle", joint, joint_log, angles, "identify"},
          {"identify effort", effort, effort_log, motion, "identify --model rigid_dynamics"},
          {"identify Preisach", force, force_log, forces, "identify --model preisach"},
          {"diagnose joint angle", joint, joint_log, angles, "diagnose"},
          {"diagnose effort", effort, effort_log, motion, "diagnose --target axis0/tau_Nm"},
          {"diagnose Preisach", force, force_log, forces, "diagnose --base preisach"}};
}

void write_log(const Kind& kind, long samples, const fs::path& file) {
  const AxisLog log = kind.log(samples);
  std::ofstream out(file);
  out << kind.header << "\n";
  std::array<char, 32> text{};
  for (Eigen::Index i = 0; i < log.time_s.size(); ++i) {
    for (std::size_t k = 0; k < kind.columns.size(); ++k) {
      std::snprintf(text.data(), text.size(), k > 0 ? ",%.7f" : "%.4f", (log.*kind.columns[k])[i]);
      out << text.data();
    }
    out << "\n";
  }
}

/// Processor time of the program and all that it starts, s.
auto processor_time(const std::string& command) -> double {
  const auto used = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  };
  const double before = used();
  const int status = std::system(command.c_str());
  if (!WIFEXITED(status) || WEXITSTATUS(status) > 1) {  // 1 is a refusal, which takes as long
    throw std::runtime_error(command + " failed");
  }
  return used() - before;
}

/// Whether time has grown no faster than n log n between the last two lengths, with a quarter for the machine.
auto grows_slowly(const std::vector<long>& lengths, const std::vector<double>& times) -> bool {
  const std::size_t n = lengths.size();
  const auto a = static_cast<double>(lengths[n - 2]);
  const auto b = static_cast<double>(lengths[n - 1]);
  return times[n - 1] <= 1.25 * times[n - 2] * (b * std::log(b)) / (a * std::log(a));
}

auto run(const std::vector<long>& lengths) -> int {
  const fs::path folder = fs::temp_directory_path() / ("capstan_speed_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::printf("processor time, s\n%-24s", "samples");
  for (const long length : lengths) {
    std::printf("%10ld", length);
  }
  std::printf("\n");
  bool slow = false;
  for (const auto& kind : kinds()) {
    std::printf("%-24s", kind.title);
    std::vector<double> times;
    for (const long length : lengths) {
      const fs::path file = folder / "log.csv";
      write_log(kind, length, file);
      times.push_back(
          processor_time(std::string(CAPSTAN_PROGRAM) + " " + kind.command + " " + file.string() + " >/dev/null 2>&1"));
      std::printf("%10.2f", times.back());
      std::fflush(stdout);
    }
    const bool good = lengths.size() < 2 || grows_slowly(lengths, times);
    slow = slow || !good;
    std::printf("  %s\n", good ? "" : "GROWS FASTER THAN n log n");
  }
  fs::remove_all(folder);
  return slow ? 1 : 0;
}

}  // namespace
}  // namespace capstan::tools

auto main(int argc, char** argv) -> int {
  CLI::App app{
      "Processor time of identify and diagnose on logs of growing length; fails if it grows faster than n log n."};
  std::vector<long> lengths = {32000, 140000, 600000};
  app.add_option("--samples", lengths, "lengths of the logs, growing");
  CLI11_PARSE(app, argc, argv);
  return capstan::tools::run(lengths);
}
