// SPDX-License-Identifier: Apache-2.0
// The step of commissioning that shakes the motor and asks encoder and current sensor.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/commission/steps.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

// Numbers that decide, chosen in November 2026 on the drawn forceps 720, 721 and 740 to 759 of commission_test;
// docs/tuning.md reports other seeds.
constexpr double kFirstShare = 0.03;  // of the continuous torque, and raised until the motor answers
constexpr double kMostShare = 0.4;    // 0.9 moved a motor of a dead encoder by 8 deg (seed 733)
constexpr double kCounts = 4.0;       // from end to end: an encoder that counts at all
// To and fro of a motor that nothing holds, until its encoder counts.
constexpr double kUnseenRad = 1.5 * std::numbers::pi / 180.0;
constexpr double kSlowFromHz = 50.0;
constexpr double kFastFromHz = 80.0;  // of a harder shake, ...
// On wrists 1150 to 1155, which friction holds and whose tendons are stiff, a motor alone shows up there: inertia 1.41
// to 1.44 times the true one, for an amplifier's lag passes for some of it.
constexpr double kFastestFromHz = 120.0;
constexpr double kFastRad =
    2.5 * std::numbers::pi / 180.0;     // ... in which a motor that nothing holds goes no further to and fro ...
constexpr double kFastWayRad = 0.0125;  // ... and none but this: its counts may be wrong by four
constexpr double kFastestWayRad = 0.018;
// ... or so many counts: on RAVEN's elbow, of 4,000, that is 0.9 deg. Elbows 1335 to 1349, which friction holds.
constexpr double kFastWayCounts = 10.0;
constexpr double kGrowth = 1.5;
constexpr double kAnswerCounts = 3.0;      // rms of the motor about its mean ...
constexpr double kFastAnswerCounts = 1.5;  // ... and where it may not go far
constexpr int kGlanceS = 5;                // of shaking, while it is too little for the motor to answer ...
constexpr int kShakeS = 11;                // ... and for its response: four periods, and one to settle
constexpr double kFollows = 0.3;           // measured current over the wanted one
constexpr double kFits = 0.2;              // of the answer that motor, spring and delay leave
constexpr double kSettled = 0.12;          // from one amplitude to the next, a half larger
constexpr double kTellsTo = 120.0;         // Hz; above, the delay turns the answer round
// Inertia by the shake over that of the data sheet; wrong counts are 2 or 4. Friction holds, so it passes for inertia.
constexpr double kLeastApart = 0.82, kMostApart = 1.6;

auto as_column(const std::vector<double>& values) -> Eigen::VectorXd {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
}

/// Of positive values: rms of their logarithms about the mean.
auto spread(const std::vector<double>& values) -> double {
  return rms_about_mean(as_column(values).array().log().matrix());
}

}  // namespace

auto CommissionSteps::shaken(const Shake& shake, int seconds) -> CsvLog {
  joint_.arm();
  const CsvLog log =
      joint_.rows("experiment", "multisine on=torque " + shake.band + " duration=" + std::to_string(seconds) +
                                    " corridor=" + rounded(std::min(corridor_.half, shake.way_rad)) +
                                    " amplitude=" + rounded(shake.amplitude_nm, 6) + "Nm");
  joint_.disarm();
  return log;
}

void CommissionSteps::judge_current(const CsvLog& log) {
  const Eigen::VectorXd wanted = joint_.column(log, "tau_cmd_Nm") / joint_.value("motor.torque_per_current");
  const Eigen::VectorXd current = joint_.column(log, "current_A");
  const Eigen::Index rows = wanted.size() - 2;
  const double follows = (current.tail(rows).array() - current.mean()).matrix().dot(wanted.segment(1, rows)) /
                         wanted.segment(1, rows).squaredNorm();
  if (std::fabs(follows) < kFollows) {
    throw Refusal("the measured current does not follow the wanted one (" + rounded(follows, 2) +
                  " of it): the current sensor or the amplifier is dead; check cable, supply and enable line");
  }
  if (follows < 0.0) {
    throw Refusal("the measured current has the wrong sign; reverse the current sensor, or swap its two wires");
  }
}

auto CommissionSteps::inertia_of(const CsvLog& log) const -> std::optional<double> {
  const Response response = estimate_response(read_response(log, joint_.axis()));
  try {
    // Friction is in quadrature to inertia, so a fit parts them, where it fits.
    const MotorModel motor = fit_motor(response);
    if (motor.share_left < kFits) {
      return motor.inertia_kgm2;
    }
  } catch (const Refusal&) {
    // Too few lines are clear: by size alone.
  }
  double way = 0.0;
  std::vector<double> inertias;
  std::vector<double> springs;
  for (const ResponsePoint& point : response.points) {
    if (point.hz < kTellsTo) {
      way += point.motor.value.real() * point.hz * point.hz;
      inertias.push_back(1.0 / std::abs(point.motor.value) / std::pow(2.0 * std::numbers::pi * point.hz, 2));
      springs.push_back(1.0 / std::abs(point.motor.value));
    }
  }
  if (inertias.empty()) {
    return std::nullopt;
  }
  // A motor that friction holds bends its tendons: with the torque, and as far at each frequency.
  if (way > 0.0 && spread(springs) < spread(inertias)) {
    return std::nullopt;
  }
  return way > 0.0 ? -median(as_column(inertias)) : median(as_column(inertias));
}

auto CommissionSteps::over_data_sheet(double inertia) const -> double {
  return inertia / options_.inertia_kgm2.value_or(inertia);
}

auto CommissionSteps::unseen_nm() const -> double {
  return kUnseenRad * options_.inertia_kgm2.value_or(1.0) * std::pow(2.0 * std::numbers::pi * kSlowFromHz, 2);
}

void CommissionSteps::refuse_scale(double inertia) const {
  throw Refusal("the motor answers as one of " + rounded(1e3 * inertia, 3) + " g m2, " +
                rounded(over_data_sheet(inertia), 2) +
                " times the data sheet's: motor.encoder_counts or motor.torque_per_current is wrong by about that; "
                "compare both with the data sheets of encoder, gear and motor");
}

void CommissionSteps::require_no_lighter(double inertia) const {
  if (over_data_sheet(inertia) < kLeastApart) {
    refuse_scale(inertia);
  }
}

void CommissionSteps::judge_inertia(double inertia) {
  all_.progress.inertia_kgm2 = std::fabs(inertia);
  if (inertia < 0.0) {
    throw Refusal(
        "the encoder counts against the torque: its sign is wrong, or the motor's wires are swapped; set "
        "motor.encoder_sign to " +
        rounded(-joint_.value("motor.encoder_sign")) + ", or swap the wires");
  }
  if (options_.inertia_kgm2) {
    const double apart = over_data_sheet(inertia);
    if (apart > kMostApart) {
      refuse_scale(inertia);
    }
    require_no_lighter(inertia);
    find("inertia " + rounded(1e3 * inertia, 3) + " g m2, the data sheet's times " + rounded(apart, 2) +
         ": counts and torque per current agree with it");
  } else {
    find("inertia " + rounded(1e3 * inertia, 3) +
         " g m2; the inertia of the data sheet was not given (--inertia), so a wrong number of counts would not be "
         "noticed");
  }
}

auto CommissionSteps::shakes() const -> std::vector<Shake> {
  std::vector<Shake> all;
  double amplitude_nm = kFirstShare * continuous_nm();
  for (; amplitude_nm < kMostShare * continuous_nm(); amplitude_nm *= kGrowth) {
    all.push_back({"from=" + rounded(kSlowFromHz) + "Hz to=150Hz", amplitude_nm, kMotorWayRad, false});
  }
  if (!options_.inertia_kgm2) {
    return all;
  }
  const auto add = [&](double from_hz, const char* to, double way_rad) {
    const double most_nm =
        std::min(continuous_nm(), kFastRad * *options_.inertia_kgm2 * std::pow(2.0 * std::numbers::pi * from_hz, 2));
    for (double before_nm = amplitude_nm / kGrowth; before_nm < most_nm; before_nm *= kGrowth) {
      all.push_back({"from=" + rounded(from_hz) + to, std::min(most_nm, kGrowth * before_nm), way_rad, true});
    }
  };
  const double coarse_rad = kFastWayCounts * joint_.count_rad();
  add(kFastFromHz, "Hz to=160Hz", std::max(kFastWayRad, coarse_rad));
  add(kFastestFromHz, "Hz to=300Hz", std::max(kFastestWayRad, coarse_rad));
  return all;
}

/// Shaken harder by kGrowth. A loose motor is fast where it leaves its limits and runs on without torque: elbow 3009,
/// without tendons, by 3.6 deg.
auto CommissionSteps::would_leave(const Eigen::VectorXd& angle) const -> bool {
  const double middle = 0.5 * (joint_.value("limits.motor_min") + joint_.value("limits.motor_max"));
  const double way = (angle.array() - angle[0]).abs().maxCoeff();
  return std::fabs(angle[angle.size() - 1] - middle) + kGrowth * way > kMotorWayRad;
}

void CommissionSteps::shake(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.let_go();
  steps.all_.progress.home_rad = steps.stood_rad_;
  const auto answered = [&joint](const CsvLog& log, bool fast) {
    const double least = fast ? kFastAnswerCounts : kAnswerCounts;
    return rms_about_mean(joint.column(log, "q1_rad")) > least * joint.count_rad();
  };
  double last = 0.0;
  // Friction makes a motor heavier, never lighter; stiff tendons may, where the shake is slow.
  const auto is_lighter = [&](double inertia) { return inertia > 0.0 && steps.over_data_sheet(inertia) < kLeastApart; };
  const auto is_sure = [&] {
    return last < 0.0 || (last > 0.0 && !is_lighter(last) && steps.over_data_sheet(last) < kMostApart);
  };
  double lighter = 0.0;  // the last inertia less than the data sheet's
  bool answers = false;
  bool ever_answered = false;
  bool counts = false;
  std::string too_far;  // a band
  for (const Shake& one : steps.shakes()) {
    if (one.band == too_far) {
      continue;
    }
    // A motor that can not be seen is not shaken harder, and lines nearer to the sampling rate tell less of its
    // inertia. (Faster and harder, dead encoders let wrist 1553 go by 12.7 deg.) A coarse encoder that counts is seen.
    if ((one.fast && ((!ever_answered && !counts) || is_sure())) || (!counts && one.amplitude_nm > steps.unseen_nm())) {
      break;
    }
    std::optional<CsvLog> shaken;
    try {
      if (!answers) {
        shaken = steps.shaken(one, kGlanceS);
        answers = answered(*shaken, one.fast);
      }
      if (answers) {
        shaken = steps.shaken(one, kShakeS);
        answers = answered(*shaken, one.fast);
      }
    } catch (const Refusal& refusal) {
      if (!ever_answered && !counts) {
        joint.disarm();
        throw Refusal("shaken with " + rounded(one.amplitude_nm, 2) +
                      " Nm the motor runs further than 2.9 deg: nothing holds it, so hook both tendons; or "
                      "motor.encoder_counts or motor.torque_per_current is wrong by a factor (" +
                      refusal.what() + ")");
      }
      // It went too far; what the amplitude before this one showed decides, or a faster band, in which it goes less
      // far.
      joint.disarm();
      too_far = one.band;
      continue;
    }
    ever_answered = ever_answered || answers;
    const Eigen::VectorXd angle = joint.column(*shaken, "q1_rad");
    counts = counts || angle.maxCoeff() - angle.minCoeff() > kCounts * joint.count_rad();
    steps.judge_current(*shaken);
    if (answers && steps.would_leave(angle)) {
      too_far = one.band;
    }
    const std::optional<double> inertia = answers ? steps.inertia_of(*shaken) : std::nullopt;
    // Friction holds a motor that is shaken too little, and passes for inertia.
    if (inertia && !is_lighter(*inertia) && std::fabs(*inertia - last) < kSettled * std::fabs(*inertia)) {
      steps.judge_inertia(*inertia);
      return;
    }
    lighter = inertia && is_lighter(*inertia) ? *inertia : lighter;
    last = inertia.value_or(0.0);
  }
  if (is_sure() || is_lighter(last)) {
    steps.judge_inertia(last);
    return;
  }
  if (last == 0.0 && lighter > 0.0) {  // and faster it said nothing
    steps.refuse_scale(lighter);
  }
  if (ever_answered || counts) {
    throw Refusal(std::string(too_far.empty() ? ""
                                              : "shaken harder the motor would run further than 2.9 deg, so check "
                                                "first that both tendons are hooked; if they are, ") +
                  "friction holds the motor: it only stretches its tendons, so its encoder's sign and scale cannot be "
                  "checked; slacken the tendons for this step, " +
                  std::string(steps.options_.inertia_kgm2
                                  ? "or raise limits.continuous_current if the motor withstands it"
                                  : "or give the inertia of the motor's data sheet (--inertia), so that it can be "
                                    "shaken harder without moving far"));
  }
  throw Refusal(
      "the motor has its current and the encoder does not count: it is blocked, the encoder is dead, or friction holds "
      "it; turn it by hand and look at 'log'");
}

}  // namespace capstan::tools
