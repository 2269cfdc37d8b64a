// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/next_experiment.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

enum class Part { kSpeeds, kFast, kLoops, kSmall, kHolds };
using Parts = std::set<Part>;

/// What shows an effect beside its doubles; the same in words is each term's exciting_motion.
auto parts_for(const std::string& effect) -> Parts {
  static const std::map<std::string, Parts> kParts = {
      {"transmission_viscous", {Part::kSpeeds, Part::kFast}},
      {"transport_delay", {Part::kSpeeds, Part::kFast}},
      {"load_inertia", {Part::kFast}},
      {"pretension_offset", {Part::kLoops}},
      {"reversal_memory", {Part::kLoops}},
      {"slip_propagation", {Part::kLoops, Part::kSmall}},
      {"play", {Part::kLoops, Part::kSmall}},
      {"presliding", {Part::kLoops, Part::kSmall}},
      {"gravity", {Part::kSpeeds}},
      {"angle_periodic", {Part::kSpeeds}},
      {"viscoelastic_creep", {Part::kLoops, Part::kHolds}},
      {"stiffness_hardening", {Part::kSpeeds, Part::kLoops}},
      {"viscous_friction", {Part::kSpeeds}},
      {"coulomb_friction", {Part::kSpeeds, Part::kSmall}},
      {"friction_asymmetry", {Part::kSpeeds}},
      {"stribeck_friction", {Part::kSpeeds, Part::kSmall}},
      {"play_friction", {Part::kSmall, Part::kLoops}},
      {"power_law_friction", {Part::kSpeeds}},
      {"load_friction", {Part::kSpeeds, Part::kFast}},
      {"inertia", {Part::kFast}},
      {"spring", {Part::kSpeeds, Part::kFast, Part::kHolds}},
      {"offset", {Part::kSpeeds}},
  };
  const auto found = kParts.find(effect);
  return found != kParts.end() ? found->second
                               : Parts{Part::kSpeeds, Part::kFast, Part::kLoops, Part::kSmall, Part::kHolds};
}

/// Where the joint went in the log, and how fast.
struct Reach {
  double centre_rad = 0.0, amplitude_rad = 0.5, speed_rad_per_s = 1.0;
};

auto reach_of(const Diagnosis& d) -> Reach {
  const Eigen::VectorXd& angle = d.target.find("/q2_") != std::string::npos ? d.traces.measured : d.traces.q1;
  const Eigen::Index n = angle.size();
  const auto apart = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(0.05 * d.rate_hz));
  if (n <= 2 * apart) {
    return {};
  }
  const Eigen::VectorXd speed =
      (angle.tail(n - apart) - angle.head(n - apart)).cwiseAbs() * (d.rate_hz / static_cast<double>(apart));
  const double highest = quantile(angle, 0.995);
  const double lowest = quantile(angle, 0.005);
  return {0.5 * (highest + lowest), 0.5 * (highest - lowest), quantile(speed, 0.99)};
}

auto number(double value) -> std::string {
  return rounded(value, 3);
}

auto segment(const std::string& why, const std::string& kind, const std::vector<std::string>& lines) -> std::string {
  std::string text = "\n# " + why + "\n[[motion.segments]]\nkind = \"" + kind + "\"\n";
  for (const auto& line : lines) {
    text += line + "\n";
  }
  return text;
}

auto text_of(Part part, const Reach& reach) -> std::string {
  const double a = reach.amplitude_rad;
  const double v = reach.speed_rad_per_s;
  const std::string offset = "offset_rad = " + number(reach.centre_rad);
  switch (part) {
    case Part::kSpeeds:
      return segment(
          "One path at three speeds: drag grows with speed, friction does not, a delay shows at every turn.",
          "speed_ladder",
          {"amplitude_rad = " + number(0.8 * a), offset, "cycles = 1",
           "speeds_rad_per_s = [" + number(v / 6.0) + ", " + number(0.4 * v) + ", " + number(0.8 * v) + "]"});
    case Part::kFast: {
      const double fastest = 0.8 * v / (2.0 * std::numbers::pi * 0.2 * a);  // hertz at a fifth of the amplitude
      return segment("Small and fast: a delay grows with the frequency, inertia with its square.", "multisine",
                     {"duration_s = 6.0", "amplitude_rad = " + number(0.2 * a), offset,
                      "frequencies_hz = [" + number(0.1 * fastest) + ", " + number(0.23 * fastest) + ", " +
                          number(0.4 * fastest) + ", " + number(0.6 * fastest) + "]"});
    }
    case Part::kLoops:
      return segment(
          "Loops within loops: turns under many different torques, some before the whole tendon slips.",
          "reversal_staircase",
          {"amplitude_rad = " + number(0.9 * a), offset, "levels = 5", "speed_rad_per_s = " + number(0.5 * v)});
    case Part::kSmall:
      return segment("Hardly more than play or presliding: what moves within it is elastic.", "sine",
                     {"duration_s = 4.0", "amplitude_rad = " + number(0.04 * a), offset, "frequency_hz = 0.5"});
    case Part::kHolds:
      return segment("Rest under load on either side: creep goes on, friction does not.", "hold",
                     {"duration_s = 5.0", "offset_rad = " + number(reach.centre_rad + 0.7 * a)}) +
             segment("The other side.", "hold",
                     {"duration_s = 5.0", "offset_rad = " + number(reach.centre_rad - 0.7 * a)});
  }
  return {};
}

/// Effects that the motion has to show: those that the verdict can not tell apart, all (""), or terms whose parameters
/// stand for each other; none where nothing is left to ask.
auto asked_for(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> names;
  if (!d.next_experiment) {
    for (const auto& pair : d.told.confused) {
      names.insert(names.end(), pair.terms.begin(), pair.terms.end());
    }
  } else if (d.verdict == Verdict::kAmbiguous) {
    names = d.effects.front().alternatives;
    names.insert(names.begin(), d.effects.front().name);
  } else {
    names = {""};
  }
  return names;
}

}  // namespace

auto next_scenario(const Diagnosis& d) -> std::string {
  const std::vector<std::string> names = asked_for(d);
  if (names.empty() || d.motion_unit != "rad") {  // scenarios turn joints
    return {};
  }
  Parts parts;
  for (const auto& name : names) {
    parts.merge(parts_for(name));
  }
  const bool warms_up = std::find(names.begin(), names.end(), "thermal_drift") != names.end();
  const Reach reach = reach_of(d);
  std::string text =
      "# " + (d.next_experiment ? *d.next_experiment : d.told.confused.front().sentence) +
      (d.traces.q1.size() > 0
           ? "\n# Made for this joint: no farther and no faster than it went in the log. Run it with\n"
           : "\n# The log does not say how far and how fast the joint goes: change that below. Run it with\n") +
      "#   capstan run --scenario next_experiment.toml --log next.csv\n"
      "# and give both logs to the next `capstan diagnose`.\nname = \"next_experiment\"\n\n[motion]\nrepeat = " +
      std::string(warms_up ? "8" : "4") + "\nblend_s = 0.5\n";
  for (const Part part : parts) {
    text += text_of(part, reach);
  }
  return text;
}

}  // namespace capstan::tools
