// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/channel/faulty_log.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tests/tools/blind/blind_axis.hpp"
#include "capstan/tests/tools/blind/blind_joint.hpp"
#include "capstan/tests/tools/blind/blind_world.hpp"
#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/log/time_scale.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::test {
namespace {

using blind::Draw;
using Eigen::Index;

/// The generators' first and last rows are not clean: rates taken there jump. Long logs are cut, so that a benchmark
/// ends.
auto channels_of(AxisLog log, std::string source) -> ChannelLog {
  constexpr Index kEdge = 10;
  constexpr Index kMostRows = 16000;
  const Index rows = std::min(log.samples() - 2 * kEdge, kMostRows);
  for_each_signal(log, [rows](Eigen::VectorXd& signal) {
    if (signal.size() > 0) {
      signal = Eigen::VectorXd(signal.segment(kEdge, rows));
    }
  });
  ChannelLog result{std::move(source), log.time_s, {}};
  result.signals.push_back({"axis0/q1_rad", ChannelRole::kMotorAngle, log.q1_rad});
  if (log.effort.size() > 0) {
    result.signals.push_back({"axis0/tau_Nm", ChannelRole::kMotorEffort, log.effort});
    return result;
  }
  if (log.has_torque) {
    result.signals.push_back({"axis0/tau_Nm", ChannelRole::kMotorEffort, log.tau_nm});
  }
  result.signals.push_back({"axis0/q2_rad", ChannelRole::kJointAngle, log.q2_rad});
  return result;
}

auto drawn_case(Draw& draw, bool effort, std::uint64_t seed) -> blind::Case {
  blind::Case drawn;
  drawn.effort = effort;
  drawn.motion = blind::kMotions[draw.one_of(4)];
  drawn.strength = draw.ratio_between(1.0, 10.0);
  drawn.repeats = draw.one_of(2) == 0;
  drawn.seed = seed;
  if (draw.one_of(2) == 0) {
    const auto& listed = effort ? blind::listed_efforts() : std::vector<std::vector<std::string>>{};
    if (effort) {
      drawn.truths = listed[static_cast<std::size_t>(draw.one_of(static_cast<int>(listed.size())))];
    } else {
      const auto& names = draw.one_of(2) == 0 ? blind::listed_effects() : blind::unlisted_effects();
      drawn.truths = {names[static_cast<std::size_t>(draw.one_of(static_cast<int>(names.size())))]};
    }
  }
  // A log whose channel is late is not clean.
  std::erase(drawn.truths, "transport_delay");
  return drawn;
}

/// Each value stands for `rows` rows.
void hold(Eigen::VectorXd& x, Index rows, Index phase) {
  for (Index i = phase; i < x.size(); ++i) {
    x[i] = (i - phase) % rows == 0 ? x[i] : x[i - 1];
  }
}

/// x(i - rows), between the rows on a straight line.
auto delayed(const Eigen::VectorXd& x, double rows) -> Eigen::VectorXd {
  Eigen::VectorXd result(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    const double at = std::max(0.0, static_cast<double>(i) - rows);
    const auto left = static_cast<Index>(at);
    const Index right = std::min(left + 1, x.size() - 1);
    const double part = at - static_cast<double>(left);
    result[i] = (1.0 - part) * x[left] + part * x[right];
  }
  return result;
}

auto takes(Injury injury, const NamedSignal& signal, const ChannelLog& log) -> bool {
  const double range = signal.values.maxCoeff() - signal.values.minCoeff();
  switch (injury) {
    case Injury::kUnsigned:  // of a signal that has both signs
      return signal.values.minCoeff() < -0.2 * range && signal.values.maxCoeff() > 0.2 * range &&
             signal.role == ChannelRole::kMotorEffort;
    case Injury::kDegrees:  // a driven axis has nothing to compare its angle with
      return (signal.role == ChannelRole::kMotorAngle || signal.role == ChannelRole::kJointAngle) &&
             log.signals.back().role == ChannelRole::kJointAngle;
    default:
      return true;
  }
}

void hurt(NamedSignal& signal, Injury injury, Draw& draw, double& size) {
  Eigen::VectorXd& x = signal.values;
  if (injury == Injury::kHeld) {
    size = 2 + draw.one_of(19);
    hold(x, static_cast<Index>(size), draw.one_of(static_cast<int>(size)));
  } else if (injury == Injury::kLate || injury == Injury::kVeryLate) {
    size = injury == Injury::kLate ? draw.ratio_between(1.0, 8.0) : draw.ratio_between(8.0, 40.0);
    x = delayed(x, size);
  } else if (injury == Injury::kUnsigned) {
    x = x.cwiseAbs();
  } else if (injury == Injury::kDegrees) {
    size = 180.0 / std::numbers::pi;
    x *= size;
  } else if (injury == Injury::kSpiked) {
    size = 1 + draw.one_of(8);
    const double range = x.maxCoeff() - x.minCoeff();
    for (int k = 0; k < static_cast<int>(size); ++k) {
      const auto row = static_cast<Index>(draw.between(5.0, static_cast<double>(x.size()) - 6.0));
      x[row] += (draw.one_of(2) == 0 ? 1.0 : -1.0) * range * draw.ratio_between(0.2, 20.0);
    }
  }
}

}  // namespace

auto injury_word(Injury injury) -> const char* {
  constexpr const char* kWords[] = {"clean", "held", "late", "unsigned", "spiked", "degrees", "time unit", "very late"};
  return kWords[static_cast<std::size_t>(injury)];
}

auto clean_log(std::uint64_t seed) -> ChannelLog {
  Draw draw(seed);
  switch (draw.one_of(4)) {
    case 0: {
      SyntheticRequest request;
      constexpr Truth kTruths[] = {Truth::kNone,  Truth::kViscous, Truth::kPretension, Truth::kPlay,
                                   Truth::kCreep, Truth::kCoulomb, Truth::kPresliding, Truth::kHardening};
      request.truth = kTruths[draw.one_of(8)];
      request.motion = draw.one_of(2) == 0 ? Motion::kLadder : Motion::kMultisine;
      request.rate_hz = draw.one_of(2) == 0 ? 200.0 : 100.0;
      request.cycles = 2;
      request.noise_rad = draw.ratio_between(0.0003, 0.003);
      request.counts_per_turn = draw.ratio_between(4000.0, 400000.0);
      request.seed = seed;
      return channels_of(synthetic_log(request), "joint");
    }
    case 1: {
      EffortRequest request;
      request.truth = static_cast<EffortTruth>(draw.one_of(9));
      request.rate_hz = draw.one_of(2) == 0 ? 100.0 : 250.0;
      request.noise_nm = draw.ratio_between(0.001, 0.01);
      request.seed = seed;
      return channels_of(synthetic_effort_log(request), "axis");
    }
    case 2:
      return channels_of(blind::blind_joint(drawn_case(draw, false, seed)).log, "blind joint");
    default:
      return channels_of(blind::blind_axis(drawn_case(draw, true, seed)).log, "blind axis");
  }
}

auto injured(const ChannelLog& clean, Injury injury, std::uint64_t seed) -> Injured {
  Draw draw(seed * 7919 + static_cast<std::uint64_t>(injury));
  Injured result{clean, "", 0.0};
  if (injury == Injury::kTimeUnit) {
    constexpr double kUnits[] = {1e3, 1e6, 1e9};
    result.size = kUnits[draw.one_of(3)];
    result.log.time_s = (clean.time_s * result.size).array().round();
    result.channel = "time_s";
    return result;
  }
  std::vector<std::size_t> possible;
  for (std::size_t i = 0; i < clean.signals.size(); ++i) {
    if (takes(injury, clean.signals[i], clean)) {
      possible.push_back(i);
    }
  }
  if (possible.empty()) {
    return result;
  }
  auto& signal = result.log.signals[possible[static_cast<std::size_t>(draw.one_of(static_cast<int>(possible.size())))]];
  hurt(signal, injury, draw, result.size);
  result.channel = signal.name;
  return result;
}

auto judged(const ChannelLog& log) -> Verdicts {
  const Index n = log.time_s.size();
  Verdicts verdicts;
  const double period = median(log.time_s.tail(n - 1) - log.time_s.head(n - 1));
  verdicts.time_unit = !time_unit_fault(period).empty();
  std::vector<GateChannel> channels;
  for (const auto& signal : log.signals) {
    channels.push_back({signal.name, signal.role, &signal.values});
  }
  verdicts.findings = inspect_channels(period, channels);
  return verdicts;
}

auto is_named(const Verdicts& verdicts, Injury injury, const std::string& channel) -> bool {
  if (injury == Injury::kTimeUnit) {
    return verdicts.time_unit;
  }
  const auto fault = injury == Injury::kHeld       ? ChannelFault::kHeld
                     : injury == Injury::kLate     ? ChannelFault::kLate
                     : injury == Injury::kVeryLate ? ChannelFault::kLate
                     : injury == Injury::kUnsigned ? ChannelFault::kUnsigned
                     : injury == Injury::kSpiked   ? ChannelFault::kSpikes
                                                   : ChannelFault::kDegrees;
  return std::any_of(verdicts.findings.begin(), verdicts.findings.end(),
                     [&](const auto& f) { return f.fault == fault && f.channel == channel; });
}

}  // namespace capstan::tools::test
