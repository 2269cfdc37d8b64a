// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/lab_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

constexpr double kLargestAngle = 0.6;  // rad, of the joint
constexpr double kTurn = 2.0 * std::numbers::pi;

using Course = std::function<double(double)>;  // joint angle, rad, by time, s

/// A path from place to place; each piece is travelled in its own way.
struct Path {
  std::vector<double> times = {0.0}, places = {0.0};
  void go(double duration, double place) {
    times.push_back(times.back() + duration);
    places.push_back(place);
  }
  /// @param eased  how far along a piece after a share of its time
  auto at(double time, const std::function<double(double)>& eased) const -> double {
    const auto next = std::upper_bound(times.begin(), times.end(), time);
    if (next == times.end()) {
      return places.back();
    }
    const auto i = static_cast<std::size_t>(next - times.begin());
    return places[i - 1] + (places[i] - places[i - 1]) * eased((time - times[i - 1]) / (times[i] - times[i - 1]));
  }
};

auto sines(Random& random, double repeat) -> Course {
  struct Tone {
    double size, turns, phase;
  };
  std::vector<Tone> tones;
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double hz = 0.1 * std::pow(10.0, (i + random.uniform()) / 4.0);
    tones.push_back({1.0 / std::sqrt(hz), std::max(1.0, std::round(hz * repeat)), kTurn * random.uniform()});
    sum += tones.back().size;
  }
  return [tones, sum, repeat](double time) {
    double angle = 0.0;
    for (const Tone& tone : tones) {
      angle += kLargestAngle * tone.size / sum * 1.2 *
               (std::sin(kTurn * tone.turns * time / repeat + tone.phase) - std::sin(tone.phase));
    }
    return angle;
  };
}

auto triangles(Random& random, double repeat) -> Course {
  Path path;
  while (path.times.back() < repeat - 3.0) {
    const double speed = 0.15 * std::pow(10.0, random.uniform());
    const double size = kLargestAngle * std::pow(0.1, random.uniform());
    const double middle = (kLargestAngle - size) * (2.0 * random.uniform() - 1.0);
    for (const double place : {middle + size, middle - size, middle + size}) {
      path.go(std::max(0.05, std::abs(place - path.places.back()) / speed), place);
    }
  }
  path.go(std::max(0.5, repeat - path.times.back()), 0.0);
  return [path](double time) { return path.at(time, [](double share) { return share; }); };
}

auto ramps(Random& random, double repeat) -> Course {
  Path path;
  while (path.times.back() < repeat - 2.0) {
    path.go(0.3 + random.uniform(), kLargestAngle * (2.0 * random.uniform() - 1.0));
    path.go(0.1 + 0.6 * random.uniform(), path.places.back());
  }
  path.go(std::max(0.5, repeat - path.times.back()), 0.0);
  return [path](double time) {
    return path.at(time, [](double s) { return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s); });
  };
}

auto walk(Random& random, double repeat) -> Course {
  Path path;
  while (path.times.back() < repeat - 1.0) {
    const double place = path.places.back() + 0.25 * random.normal();
    path.go(0.4, std::clamp(place, -kLargestAngle, kLargestAngle));
  }
  path.go(std::max(0.4, repeat - path.times.back()), 0.0);
  return [path](double time) { return path.at(time, [](double s) { return s * s * (3.0 - 2.0 * s); }); };
}

auto course_of(const LabExperiment& experiment, double pull) -> Course {
  Random random(experiment.seed);
  switch (experiment.motion) {
    case LabMotion::kSines:
      return sines(random, experiment.repeat_s);
    case LabMotion::kTriangles:
      return triangles(random, experiment.repeat_s);
    case LabMotion::kRamps:
      return ramps(random, experiment.repeat_s);
    case LabMotion::kWalk:
      return walk(random, experiment.repeat_s);
    case LabMotion::kPulls:
      break;
  }
  return [pull](double time) { return pull * 2.0 / std::numbers::pi * std::asin(std::sin(kTurn * 0.1 * time)); };
}

}  // namespace

auto name_of(LabMotion motion) -> std::string {
  switch (motion) {
    case LabMotion::kSines:
      return "sines";
    case LabMotion::kTriangles:
      return "triangles";
    case LabMotion::kRamps:
      return "ramps";
    case LabMotion::kWalk:
      return "walk";
    case LabMotion::kPulls:
      return "pulls";
  }
  return {};
}

auto drawn_experiment(std::uint64_t seed) -> LabExperiment {
  Random random(seed + 4242);
  LabExperiment experiment;
  experiment.motion = static_cast<LabMotion>(seed % kLabMotions);
  experiment.seed = seed;
  experiment.noise_seed = seed;
  experiment.rate_hz = random.uniform() < 0.5 ? 500.0 : 1000.0;
  experiment.repeat_s = random.uniform() < 0.5 ? 15.0 : kLabDurationS;
  return experiment;
}

auto other_experiment(LabExperiment experiment) -> LabExperiment {
  experiment.motion = static_cast<LabMotion>((static_cast<int>(experiment.motion) + 1) % kLabMotions);
  experiment.seed += 1000000;
  experiment.noise_seed += 1000000;
  return experiment;
}

auto lab_course(const LabExperiment& experiment, double pull) -> Course {
  return [course = course_of(experiment, pull), repeat = experiment.repeat_s](double time) {
    const double into = std::fmod(time, 2.0 * repeat);
    return course(into < repeat ? into : 2.0 * repeat - into);
  };
}

auto lab_log(const std::vector<independent::Row>& rows, bool held, const LabExperiment& experiment,
             const std::string& keep) -> AxisLog {
  std::string text = held ? "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad,axis0/tau_out_Nm\n"
                          : "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad\n";
  char line[160];
  for (const auto& row : rows) {
    std::snprintf(line, sizeof line, "%.4f,%.7g,%.6g,%.7g", row.time_s, row.q1_rad, row.tau_nm, row.q2_rad);
    text += line;
    if (held) {
      std::snprintf(line, sizeof line, ",%.6g", row.tau_out_nm);
      text += line;
    }
    text += '\n';
  }
  if (!keep.empty()) {
    std::ofstream(keep) << text;
  }
  return read_axis(CsvLog::parse(std::move(text), name_of(experiment.motion)), {.needs_torque = true});
}

}  // namespace capstan::tools::plant
