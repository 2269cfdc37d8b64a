// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run.hpp"

#include <cmath>
#include <cstdio>

#include "tools/support/errors.hpp"

namespace capstan::tools {
namespace {

class StringSink final : public TextSink {
 public:
  auto take() -> std::string { return std::exchange(text_, {}); }

 private:
  void do_write(std::string_view text) override { text_.append(text); }
  std::string text_;
};

/// The operator's part of a run: sends a line, lets the firmware work until it answers.
class Operator {
 public:
  Operator(SimBoard& board, StringSink& sink) : board_(board), sink_(sink) {}

  /// Throws BadInput if the answer is an error.
  void say(const std::string& line) {
    for (const char c : line + "\n") {
      board_.shell().receive(c);
    }
    constexpr int kPatience = 10'000;  // cycles; an answer needs two
    for (int i = 0; i < kPatience && board_.shell().busy(); ++i) {
      board_.tick();
      board_.shell().poll();
    }
    const std::string answer = sink_.take();
    if (answer.find("error ") != std::string::npos) {
      throw BadInput("the firmware refused '" + line + "': " + answer.substr(0, answer.find_last_not_of("\r\n") + 1));
    }
  }

 private:
  SimBoard& board_;
  StringSink& sink_;
};

class Recorder {
 public:
  explicit Recorder(std::ostream* log) : log_(log) {
    if (log_ != nullptr) {
      *log_ << "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad,axis0/q2_est_rad,axis0/q2_ref_rad,axis0/current_A\n";
    }
  }
  void add(double time_s, double q2_rad, double wanted_rad, const AxisTelemetry& joint) {
    ++samples_;
    const double estimated = joint.q2_reported_rad.to_double();
    estimation_ += (estimated - q2_rad) * (estimated - q2_rad);
    tracking_ += (wanted_rad - q2_rad) * (wanted_rad - q2_rad);
    if (log_ != nullptr) {
      std::array<char, 160> row{};
      // Eight decimals tell any two of the firmware's numbers apart, so a replay of the log starts from the same bits.
      std::snprintf(row.data(), row.size(), "%.3f,%.8f,%.8f,%.8f,%.8f,%.8f,%.8f\n", time_s, joint.q1_rad.to_double(),
                    joint.tau_nm.to_double(), q2_rad, estimated, wanted_rad, joint.current_a.to_double());
      *log_ << row.data();
    }
  }
  [[nodiscard]] auto summary() const -> RunSummary {
    const double n = samples_ > 0 ? static_cast<double>(samples_) : 1.0;
    return {static_cast<double>(samples_) / kCycleRateHz, std::sqrt(estimation_ / n), std::sqrt(tracking_ / n), {}};
  }

 private:
  std::ostream* log_;
  long samples_ = 0;
  double estimation_ = 0.0;
  double tracking_ = 0.0;
};

auto sentence(Fault fault) -> std::string {
  const FaultInfo& entry = info(fault);
  return std::string(entry.name) + ": " + entry.cause + "; " + entry.cure;
}

}  // namespace

auto run_scenario(const sim::Scenario& scenario, const std::vector<std::string>& model, Banks& banks, std::ostream* log)
    -> RunSummary {
  StringSink sink;
  SimBoard board(scenario, banks, sink, false);
  Operator say_to(board, sink);
  board.tick();
  for (const std::string& line : scenario.shell) {
    say_to.say(line);
  }
  for (const std::string& line : model) {
    say_to.say(line);
  }
  say_to.say("arm");

  Recorder recorder(log);
  const auto cycles = static_cast<long>(std::lround(scenario.duration_s * kCycleRateHz));
  for (long i = 0; i < cycles; ++i) {
    const double time_s = static_cast<double>(i) / kCycleRateHz;
    const double wanted = scenario.motion.reference_rad(time_s);
    const double q2 = board.plant().truth().q2_camera_rad;  // of the instant at which the firmware reads its sensors
    board.tick(wanted);
    const MachineTelemetry now = board.application().telemetry();
    recorder.add(time_s, q2, wanted, board.application().axis_telemetry(0));
    if (!energised(now.state)) {
      RunSummary summary = recorder.summary();
      summary.fault = sentence(now.first_fault);
      return summary;
    }
  }
  say_to.say("disarm");
  return recorder.summary();
}

}  // namespace capstan::tools
