// SPDX-License-Identifier: Apache-2.0
// The steps of commissioning that take gains, try them and keep them.
#include <algorithm>
#include <array>
#include <cmath>

#include "capstan/tools/commission/steps.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

// Numbers that decide, chosen in November 2026 on the drawn forceps 720, 721 and 740 to 759 of commission_test;
// docs/tuning.md reports other seeds.
constexpr double kTravelShare = 0.75;  // of the corridor, while it is shaken ...
constexpr double kBeside = 0.22;       // ... and how far it may stray from that
constexpr double kLegS = 3.2;          // a leg takes longer than a period and a half of the multisine
// Peak torque over inertia times speed, 1/s, so that friction keeps its sign, below kSplitHz and above, where torque
// moves the motor less.
constexpr double kShakePerMotion = 260.0, kFastShakePerMotion = 750.0;
constexpr double kSplitHz = 90.0, kLastHz = 250.0;
constexpr int kSlowS = 60, kFastS = 50;
constexpr double kWorse = 1.5;  // rms of following a sine; of seeds 740 to 759 it fell to a half, and once rose by 1.2
constexpr double kBeyondAsked = 1.1;  // of the amplitude that a faint shake asks for at least
constexpr double kQuieter = 1.5;
constexpr double kWaysPerLeg = 2.0;   // from -travel to travel
constexpr double kLessTravel = 0.25;  // when it went too far
constexpr int kMostAttempts = 4;
constexpr Eigen::Index kBesideRows = 10;  // of 10 ms: over which a slow sine shows where it goes
constexpr double kAboutMiddle = 0.3;      // of a sine's amplitude: behind there friction has gone over
// What a measurement may be off from the margins that were promised.
constexpr double kMeasuredDeg = 5.0, kMeasuredDb = 1.0, kMeasuredModulus = 0.9;

// Half of the torque by which forward and backward differ, over that of `travel`.
constexpr double kLeastFriction = 0.7, kMostFriction = 1.3;

/// What gains do that do not suit a joint. All else is the joint's, or its sensors'.
auto by_gains(const std::string& why) -> bool {
  return why.find("latched following_error") != std::string::npos ||
         why.find("latched overspeed") != std::string::npos || why.find("latched limit_cycle") != std::string::npos;
}

/// Backward and forward, N m, of a sine about its middle.
auto torque_of(const JointConsole& joint, const CsvLog& log) -> std::pair<double, double> {
  const Eigen::VectorXd torque = joint.column(log, "tau_Nm");
  const Eigen::VectorXd angle = joint.column(log, "q1_rad");
  const double middle = 0.5 * (angle.maxCoeff() + angle.minCoeff());
  const double half = 0.5 * (angle.maxCoeff() - angle.minCoeff());
  std::array<double, 2> sums{};
  std::array<int, 2> rows{};
  // It stands before and behind the sine.
  const Eigen::Index last = angle.size() - 2 * kBesideRows;
  const Eigen::VectorXd way = angle.tail(last) - angle.head(last);
  for (Eigen::Index i = 0; i < last; ++i) {
    const Eigen::Index row = i + kBesideRows;
    if (std::fabs(way[i]) > 0.5 * way.maxCoeff() && std::fabs(angle[row] - middle) < kAboutMiddle * half) {
      sums[way[i] > 0.0 ? 1 : 0] += torque[row];
      ++rows[way[i] > 0.0 ? 1 : 0];
    }
  }
  return {sums[0] / std::max(1, rows[0]), sums[1] / std::max(1, rows[1])};
}

/// A multisine on the motor's torque while the joint travels.
struct Shake {
  double from_hz, to_hz;
  int duration_s;
  double amplitude_nm;
};

/// How the joint travels meanwhile, rad.
struct Way {
  double home, travel, beside;
};

auto response_to(const Shake& shake, const Way& way, JointConsole& joint) -> Response {
  joint.arm();
  const CsvLog log = joint.rows(
      "experiment",
      "multisine on=torque from=" + rounded(shake.from_hz) + "Hz to=" + rounded(shake.to_hz) +
          "Hz duration=" + std::to_string(shake.duration_s) + " offset=" + rounded(way.home, 6) +
          "rad travel=" + rounded(way.travel, 4) + "rad speed=" + rounded(kWaysPerLeg * way.travel / kLegS, 4) +
          "rad/s corridor=" + rounded(way.beside, 4) + "rad amplitude=" + rounded(shake.amplitude_nm, 3) + "Nm");
  joint.disarm();
  return estimate_response(read_response(log, joint.axis()));
}

}  // namespace

void CommissionSteps::respond(const std::function<void(const Response&)>& take) {
  keep_to_corridor();
  watch_frozen();
  Way way{.home = std::round(corridor_.middle * 1e4) / 1e4,  // the shell's line has room for so many digits
          .travel = std::min(1.8, kTravelShare * corridor_.half),
          .beside = kBeside * corridor_.half};
  const double per_motion = all_.progress.inertia_kgm2 * kWaysPerLeg * way.travel / kLegS;
  double share = 1.0;  // of the amplitudes
  const auto amplitude = [&](double per_motion_s) {
    return std::min(continuous_nm(), share * per_motion_s * per_motion);
  };
  double too_little = 0.0;
  double too_much = 0.0;
  std::string problem;
  const auto try_again = [&](const Refusal& refusal, double& tried, double factor) {
    joint_.disarm();
    problem = refusal.what();
    person_.tell("  shaken with " + rounded(1e3 * amplitude(kShakePerMotion), 3) + " mNm: " + problem);
    tried = share;
    share = too_little > 0.0 && too_much > 0.0 ? std::sqrt(too_little * too_much) : share * factor;
  };
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    try {
      const Response slow = response_to({1.0, kSplitHz, kSlowS, amplitude(kShakePerMotion)}, way, joint_);
      const Response fast = response_to({kSplitHz, kLastHz, kFastS, amplitude(kFastShakePerMotion)}, way, joint_);
      const Response response = spliced(slow, fast);
      require_usable(response);
      take(response);
      return;
    } catch (const Faulted&) {
      throw;
    } catch (const FaintShake& refusal) {
      try_again(refusal, too_little, kBeyondAsked * refusal.louder());
    } catch (const Refusal& refusal) {
      try_again(refusal, too_much, 1.0 / kQuieter);
      // Tendons that give way where friction turns: less travel, and what that leaves beside it.
      way.beside += kLessTravel * way.travel;
      way.travel -= kLessTravel * way.travel;
    }
  }
  if (too_much == 0.0) {
    problem +=
        "; " + rounded(too_little, 2) +
        " times the first amplitude did not do, so it may be no noise: a joint that answers otherwise forward than "
        "backward, or from place to place. Give both tendons the same pretension, or tune it by hand";
  }
  throw Refusal(problem);
}

void CommissionSteps::tune_gains(CommissionSteps& steps) {
  const JointConsole& joint = steps.joint_;
  steps.calm();
  const LoopGains present = read_gains(steps.joint_.gains_dump(), joint.axis());
  steps.respond([&](const Response& response) {
    steps.require_same_friction(response.backward_nm, response.forward_nm);
    steps.all_.response = response;
    steps.all_.tuning = tune(response, present, {});
  });
  if (steps.options_.wanted.bandwidth_hz) {  // no other shake makes one possible that is not
    steps.all_.tuning = tune(*steps.all_.response, present, steps.options_.wanted);
  }
  // A motor that travels is not held by friction, so half the counts show here where they passed for friction before.
  const MotorModel& plant = steps.all_.tuning->motor;
  steps.require_no_lighter(plant.inertia_kgm2 + plant.joint_inertia_kgm2);
  for (const std::string& line : tuning_lines(steps.all_.tuning->gains, joint.axis())) {
    const std::string prefix = "set " + joint.name() + ".";
    if (line.starts_with(prefix)) {
      const std::size_t blank = line.find(' ', prefix.size());
      steps.all_.progress.set.emplace_back(line.substr(prefix.size(), blank - prefix.size()), line.substr(blank + 1));
    }
  }
  steps.all_.progress.set.emplace_back("control.reversal_angle", rounded(steps.all_.progress.reversal_rad, 3) + " rad");
  const Margins& margins = steps.all_.tuning->whole_nominal;
  steps.find("gains: crossover " + rounded(margins.crossover_hz, 3) + " Hz, " + rounded(margins.phase_deg, 3) +
             " deg, " + rounded(margins.gain_db, 3) + " dB; limited by " + steps.all_.tuning->limited_by);
  for (const std::string& sentence : {steps.all_.tuning->ways, steps.all_.tuning->swings}) {
    if (!sentence.empty()) {
      steps.find(sentence);
    }
  }
  if (!steps.all_.tuning->warning.empty()) {
    steps.find("warning: " + steps.all_.tuning->warning);
  }
}

auto CommissionSteps::sine(const char* frequency) -> CsvLog {
  joint_.arm();
  const CsvLog log = joint_.rows("experiment", std::string("sine_ladder every=10 cycles=1 repeats=1 frequencies=") +
                                                   frequency + " amplitude=" + rounded(0.6 * corridor_.half, 6) +
                                                   "rad offset=" + rounded(corridor_.middle, 6) + "rad");
  joint_.disarm();
  return log;
}

auto CommissionSteps::tracking(const CsvLog& log) const -> double {
  const Eigen::VectorXd off = joint_.column(log, "q2_ref_rad") - joint_.column(log, "q2_est_rad");
  return std::sqrt(off.array().square().mean());
}

void CommissionSteps::require_same_friction(double backward_nm, double forward_nm) const {
  const double now = 0.5 * (forward_nm - backward_nm);
  const double before = 0.5 * (all_.progress.forward_nm - all_.progress.backward_nm);
  if (before > 0.0 && (now < kLeastFriction * before || now > kMostFriction * before)) {
    throw Faulted(
        "friction is " + rounded(now, 3) + " Nm now and was " + rounded(before, 3) +
        " Nm before: a tendon tore, slipped or got stuck meanwhile; look at both, and start commissioning again "
        "with --again");
  }
}

void CommissionSteps::check(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.keep_to_corridor();
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& one : steps.all_.progress.set) {
    if (one.first.starts_with("control.")) {
      found.push_back(one);
    }
  }
  constexpr const char* kFrequency = "0.2Hz";
  constexpr const char* kSlow = "0.1Hz";  // which friction and a coarse encoder fail in; not the old gains, for time
  std::optional<double> before;
  const auto not_at_all = [&](const Refusal& refusal) {
    joint.disarm();
    steps.person_.tell(std::string("  ") + refusal.what());
  };
  try {
    before = steps.tracking(steps.sine(kFrequency));
  } catch (const Faulted& fault) {
    if (!by_gains(fault.what())) {
      throw;
    }
    not_at_all(fault);
  } catch (const Refusal& refusal) {
    not_at_all(refusal);
  }
  joint.try_together(found);
  const auto followed = [&](const char* frequency) {
    try {
      return steps.sine(frequency);
    } catch (const Refusal& refusal) {
      throw Refusal(
          std::string("with the new gains the joint does not follow a slow sine; the old ones were restored (") +
          refusal.what() + ")");
    }
  };
  const double after = steps.tracking(followed(kFrequency));
  const auto [backward, forward] = torque_of(joint, followed(kSlow));
  steps.require_same_friction(backward, forward);
  joint.arm();
  joint.ask("move " + joint.name() + " " + rounded(steps.corridor_.middle + 0.4 * steps.corridor_.half, 6) + " rad");
  static_cast<void>(joint.rows("log", "2000 1"));  // time for it to swing
  const std::vector<std::string> status = joint.ask("status");
  joint.disarm();
  const bool warned = std::any_of(status.begin(), status.end(), [](const std::string& line) {
    return line.find("limit_cycle") != std::string::npos;
  });
  if (warned) {
    throw Refusal(
        "with the new gains the joint oscillates after a step; the old ones were restored. Start again with a larger "
        "corridor ('capstan commission' with --again)");
  }
  const bool was_asked = steps.options_.wanted.bandwidth_hz.has_value();  // for gains that may be softer
  if (!was_asked && before && after > kWorse * *before + 2.0 * joint.count_rad()) {
    throw Refusal("with the new gains the joint follows a sine worse (" + rounded(1e3 * after, 3) + " mrad, " +
                  rounded(1e3 * *before, 3) + " before); the old ones were restored");
  }
  steps.find("a sine is followed within " + rounded(1e3 * after, 3) + " mrad rms of the estimate" +
             (before ? ", " + rounded(1e3 * *before, 3) + " before" : std::string(", and not at all before")) +
             "; there is no oscillation after a step");
  steps.find_answer();
  for (const auto& [name, value] : found) {
    steps.decide(name, value);
  }
}

void CommissionSteps::find_answer() {
  if (joint_.value("observer.inertia") <= 0.0) {
    return;  // nobody looks
  }
  joint_.arm();
  const bool found = commission_by_board("commission " + joint_.name() + " looks");
  const bool judged = found && joint_.value("observer.answer") > 0.0;
  find(judged ? "its response to test pulses at rest is " + joint_.text("observer.answer") + ", which is monitored"
              : "the response to test pulses at rest will not be monitored: the joint is under load, its encoder is "
                "too coarse, or this board cannot measure it");
}

void CommissionSteps::together(CommissionSteps& steps) {
  std::optional<Margins> margins;
  steps.respond([&](const Response& response) { margins = measured_margins(response, false); });
  const std::string measured = rounded(margins->phase_deg, 3) + " deg, " + rounded(margins->gain_db, 3) +
                               " dB and a modulus of " + rounded(margins->modulus, 2);
  const Wanted wanted;
  if (margins->phase_deg < wanted.phase_deg - kMeasuredDeg || margins->gain_db < wanted.gain_db - kMeasuredDb ||
      margins->modulus < wanted.modulus * kMeasuredModulus) {
    throw Refusal("with the other joints under control " + steps.joint_.name() + " has only " + measured + ", where " +
                  rounded(wanted.phase_deg) + " deg, " + rounded(wanted.gain_db) + " dB and " +
                  rounded(wanted.modulus) +
                  " are wanted: the joints swing together; tune it once more on its own "
                  "(--again --axis), or for less bandwidth with 'capstan tune'");
  }
  steps.find("with the other joints under control: crossover " + rounded(margins->crossover_hz, 3) + " Hz, " +
             measured);
}

void CommissionSteps::save(CommissionSteps& steps) {
  if (steps.person_.agrees("save the values on the board?")) {
    steps.joint_.ask("save");
    steps.find("saved");
  } else {
    steps.find("not saved");
  }
}

}  // namespace capstan::tools
