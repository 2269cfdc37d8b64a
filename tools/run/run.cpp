// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/run/run.hpp"

#include <cmath>
#include <cstdio>

#include "capstan/tools/support/errors.hpp"

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
  void say(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      say(line);
    }
  }

 private:
  SimBoard& board_;
  StringSink& sink_;
};

/// What the laboratory's instruments show at the instant at which the firmware reads its own.
struct Laboratory {
  double wanted = 0.0;  // joint angle, rad, or torque on the bench, N m
  double q2_rad = 0.0;
  double tau_out_nm = 0.0;
  double temperature_c = 0.0;
};

class Recorder {
 public:
  Recorder(const sim::Scenario& scenario, std::ostream* log)
      : log_(log), bench_(on_bench(scenario)), seen_(1 + scenario.other_axes.size()), joints_(seen_.size()) {
    for (const sim::InstrumentAxis& axis : axes_of(scenario)) {
      thermometer_ = thermometer_ || axis.plant.warming_k > 0.0;
    }
    if (log_ == nullptr) {
      return;
    }
    *log_ << "time_s";
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      for (const char* name : {"q1_rad", "tau_Nm", "q2_rad", "q2_est_rad", bench_ ? "tau_ref_Nm" : "q2_ref_rad",
                               "current_A", "tau_out_Nm", "tau_out_est_Nm"}) {
        *log_ << ",axis" << i << "/" << name;
      }
    }
    *log_ << (thermometer_ ? ",temperature_C\n" : "\n");
  }

  void add(double time_s, const std::vector<Laboratory>& seen, const Machine& machine) {
    ++samples_;
    put("%.3f", time_s);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const AxisTelemetry joint = machine.axis_telemetry(i);
      const double estimated = joint.q2_reported_rad.to_double();
      const double tracking = bench_ ? 0.0 : seen[i].wanted - seen[i].q2_rad;
      if (std::isfinite(seen[i].q2_rad)) {
        ++seen_[i];
        joints_[i].estimation_rmse_rad += (estimated - seen[i].q2_rad) * (estimated - seen[i].q2_rad);
        joints_[i].tracking_rmse_rad += tracking * tracking;
      }
      // Eight decimals tell any two of the firmware's numbers apart, so a replay of the log starts from the same bits.
      for (const double value :
           {joint.q1_rad.to_double(), joint.tau_nm.to_double(), seen[i].q2_rad, estimated, seen[i].wanted,
            joint.current_a.to_double(), seen[i].tau_out_nm, joint.joint_torque_nm.to_double()}) {
        put(",%.8f", value);
      }
    }
    if (thermometer_) {
      put(",%.3f", seen.front().temperature_c);
    }
    if (log_ != nullptr) {
      *log_ << "\n";
    }
  }

  [[nodiscard]] auto summary() const -> RunSummary {
    RunSummary summary{static_cast<double>(samples_) / kCycleRateHz, joints_, {}};
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const double n = seen_[i] > 0 ? static_cast<double>(seen_[i]) : 1.0;
      summary.joints[i] = {std::sqrt(joints_[i].estimation_rmse_rad / n), std::sqrt(joints_[i].tracking_rmse_rad / n)};
    }
    return summary;
  }

 private:
  void put(const char* format, double value) {
    if (log_ != nullptr) {
      std::array<char, 352> text{};  // enough for any double
      log_->write(text.data(), std::snprintf(text.data(), text.size(), format, value));
    }
  }

  std::ostream* log_;
  bool bench_;
  bool thermometer_ = false;
  long samples_ = 0;
  std::vector<long> seen_;           // samples that the camera had a number for
  std::vector<JointErrors> joints_;  // sums of squares until the summary
};

auto sentence(Fault fault) -> std::string {
  const FaultInfo& entry = info(fault);
  return std::string(entry.name) + ": " + entry.cause + "; " + entry.cure;
}

/// The motions of a scenario, and the cycles in which they are carried out.
class Performance {
 public:
  Performance(const sim::Scenario& scenario, SimBoard& board) : board_(board), bench_(on_bench(scenario)) {
    motions_.push_back(&scenario.motion);
    for (const sim::OtherAxis& axis : scenario.other_axes) {
      motions_.push_back(&axis.motion);
    }
    for (const sim::InstrumentAxis& axis : axes_of(scenario)) {
      torque_constants_.push_back(axis.plant.torque_constant_nm_per_a);
    }
  }

  /// One cycle. Returns what the laboratory saw at its beginning.
  auto step(double time_s) -> std::vector<Laboratory> {
    std::vector<Laboratory> seen;
    std::vector<double> asked;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const sim::Truth& truth = board_.truth(i);
      const double wanted = motions_[i]->reference_rad(time_s);
      seen.push_back({wanted, truth.q2_camera_rad, truth.tip_torque_nm, truth.temperature_c});
      asked.push_back(bench_ ? wanted / torque_constants_[i] : wanted);
    }
    try {
      bench_ ? board_.tick_on_bench(asked) : board_.tick(asked);
    } catch (const std::runtime_error& diverged) {
      throw Refusal(std::string("the run ended at ") + std::to_string(time_s) + " s: " + diverged.what());
    }
    return seen;
  }

 private:
  SimBoard& board_;
  bool bench_;
  std::vector<const sim::Motion*> motions_;
  std::vector<double> torque_constants_;
};

}  // namespace

auto nameplate_lines(const sim::Scenario& scenario, const Machine& machine) -> std::vector<std::string> {
  std::vector<std::string> lines;
  const auto axes = axes_of(scenario);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const MotorConfig& motor = machine.config()[i].motor;
    const sim::PlantParameters& plant = axes[i].plant;
    const std::string start = "set joint" + std::to_string(i) + ".motor.";
    const auto counts = static_cast<std::int32_t>(std::lround(plant.encoder_counts_per_turn));
    if (motor.encoder_counts_per_turn != counts) {
      lines.push_back(start + "encoder_counts " + std::to_string(counts));
    }
    if (motor.torque_per_current_nm_per_a != Q24::from_double(plant.torque_constant_nm_per_a)) {
      lines.push_back(start + "torque_per_current " + std::to_string(plant.torque_constant_nm_per_a) + " Nm/A");
    }
  }
  return lines;
}

auto run_scenario(const sim::Scenario& scenario, const std::vector<std::string>& model, Banks& banks, std::ostream* log)
    -> RunSummary {
  StringSink sink;
  SimBoard board(scenario, banks, sink, false);
  Operator say_to(board, sink);
  board.tick();
  say_to.say(nameplate_lines(scenario, board.machine()));
  say_to.say(scenario.shell);
  say_to.say(model);
  const bool bench = on_bench(scenario);
  if (!bench) {
    say_to.say("arm");
  }

  Recorder recorder(scenario, log);
  Performance performance(scenario, board);
  const auto cycles = static_cast<long>(std::lround(scenario.duration_s * kCycleRateHz));
  for (long i = 0; i < cycles; ++i) {
    const double time_s = static_cast<double>(i) / kCycleRateHz;
    const std::vector<Laboratory> seen = performance.step(time_s);
    recorder.add(time_s, seen, board.machine());
    const MachineTelemetry now = board.machine().telemetry();
    if (!bench && !energised(now.state)) {
      RunSummary summary = recorder.summary();
      summary.fault = sentence(now.first_fault);
      return summary;
    }
  }
  if (!bench) {
    say_to.say("disarm");
  }
  return recorder.summary();
}

}  // namespace capstan::tools
