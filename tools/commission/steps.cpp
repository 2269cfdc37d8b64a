// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/commission/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

// Numbers that decide, chosen in November 2026 on the drawn forceps 720, 721 and 740 to 759 of commission_test;
// docs/tuning.md reports other seeds.
constexpr double kMostZeroShare = 0.05;  // of limits.current: an offset that is no offset any more
constexpr double kMotorWayRad = 0.05;  // 2.9 deg: the gate takes torque away there, and a loose motor runs on a little
constexpr double kSoftStiffness = 0.02;  // Nm/rad: far below any tendon's, so that a wrong sign does not run away
constexpr double kFirstShare = 0.03;     // of the continuous torque, and raised until the motor answers
constexpr double kMostShare = 0.4;
constexpr double kGrowth = 1.5;
constexpr double kAnswerCounts = 3.0;        // rms of the motor about its mean
constexpr int kGlanceS = 5;                  // of shaking, while it is too little for the motor to answer ...
constexpr int kShakeS = 11;                  // ... and for its response: four periods, and one to settle
constexpr double kFollows = 0.3;             // measured current over the wanted one
constexpr double kFits = 0.2;                // of the answer that motor, spring and delay leave
constexpr double kSettled = 0.12;            // from one amplitude to the next, a half larger
constexpr double kTellsTo = 120.0;           // Hz; above, the delay turns the answer round
constexpr double kScaleApart = 1.6;          // of inertia by the data sheet and by the shake; wrong counts are 2 or 4
constexpr double kCalmStiffness = 25000.0;   // Nm/rad per kg m2: 25 Hz, damped at 0.8 of critical
constexpr double kCalmDamping = 250.0;       // Nms/rad per kg m2
constexpr double kPressRad = 2.0 * kDegree;  // from one end to the other
constexpr double kElastic = 0.35;            // share of the torque that is a spring's; a loose motor has friction only
constexpr double kOneSided = 3.0;            // of the torques either way
constexpr double kBlocked = 0.25;            // rise of the torque over the last half of a leg, of that at its end

auto rms_about_mean(const Eigen::VectorXd& values) -> double {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

auto median(std::vector<double> values) -> double {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

void CommissionSteps::find(const std::string& sentence) {
  all_.progress.found.push_back(sentence);
  person_.tell("  " + sentence);
}

void CommissionSteps::decide(const std::string& name, const std::string& value) {
  joint_.set(name, value);
  joint_.keep(name);
  std::erase_if(all_.progress.set, [&name](const auto& one) { return one.first == name; });
  all_.progress.set.emplace_back(name, value);
}

auto CommissionSteps::continuous_nm() const -> double {
  return joint_.value("limits.continuous_current") * joint_.value("motor.torque_per_current");
}

auto CommissionSteps::here() -> double {
  return joint_.column(joint_.rows("log", "20 10"), "q2_est_rad").mean();
}

void CommissionSteps::keep_to_corridor() {
  joint_.set("limits.joint_min",
             rounded(std::max(home_rad_ - options_.corridor_rad, joint_.value("limits.joint_min")), 6) + " rad");
  joint_.set("limits.joint_max",
             rounded(std::min(home_rad_ + options_.corridor_rad, joint_.value("limits.joint_max")), 6) + " rad");
}

void CommissionSteps::calm() {
  joint_.set("control.stiffness", rounded(kCalmStiffness * all_.progress.inertia_kgm2, 6) + " Nm/rad");
  joint_.set("control.damping", rounded(kCalmDamping * all_.progress.inertia_kgm2, 6) + " Nms/rad");
  joint_.set("control.torque_backward", rounded(all_.progress.backward_nm, 6) + " Nm");
  joint_.set("control.torque_forward", rounded(all_.progress.forward_nm, 6) + " Nm");
}

void CommissionSteps::let_go() {
  keep_to_corridor();
  const double motor = joint_.column(joint_.rows("log", "20 10"), "q1_rad").mean();
  joint_.set("limits.motor_min", rounded(motor - kMotorWayRad, 6) + " rad");
  joint_.set("limits.motor_max", rounded(motor + kMotorWayRad, 6) + " rad");
  joint_.set("control.stiffness", rounded(kSoftStiffness) + " Nm/rad");
  for (const char* gain : {"control.damping", "control.kp", "control.ki", "control.kd", "control.torque_forward",
                           "control.torque_backward", "observer.inertia"}) {
    joint_.set(gain, "0");
  }
}

void CommissionSteps::look(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  const CsvLog log = joint.rows("log", "1000 1");
  const Eigen::VectorXd current = joint.column(log, "current_A");
  const Eigen::VectorXd angle = joint.column(log, "q1_rad");
  const double noise = rms_about_mean(current);
  if (current.maxCoeff() == current.minCoeff()) {
    throw Refusal("the current sensor gave " + rounded(current[0], 3) +
                  " A a thousand times without the least noise, so it is dead; check its cable and supply");
  }
  if (std::fabs(current.mean()) > kMostZeroShare * joint.value("limits.current")) {
    throw Refusal("without torque the current sensor shows " + rounded(current.mean(), 3) +
                  " A; adjust its zero, or check that the amplifier is off");
  }
  if (angle.maxCoeff() - angle.minCoeff() > 20.0 * joint.count_rad()) {
    throw Refusal("the motor moves without torque; hold it, or take away what drives it");
  }
  steps.find("current sensor: zero " + rounded(1e3 * current.mean(), 2) + " mA, noise " + rounded(1e3 * noise, 2) +
             " mA");
}

auto CommissionSteps::shaken(double amplitude_nm, int seconds) -> CsvLog {
  joint_.arm();
  const CsvLog log =
      joint_.rows("experiment", "multisine on=torque from=50Hz to=150Hz duration=" + std::to_string(seconds) +
                                    " corridor=" + rounded(std::min(options_.corridor_rad, kMotorWayRad)) +
                                    " amplitude=" + rounded(amplitude_nm, 6) + "Nm");
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
    throw Refusal("the measured current has the wrong sign; turn the current sensor round, or its two wires");
  }
}

auto CommissionSteps::inertia_of(const CsvLog& log) const -> double {
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
  for (const ResponsePoint& point : response.points) {
    if (point.hz < kTellsTo) {
      way += point.motor.value.real() * point.hz * point.hz;
      inertias.push_back(1.0 / std::abs(point.motor.value) / std::pow(2.0 * kPi * point.hz, 2));
    }
  }
  return way > 0.0 ? -median(inertias) : median(inertias);
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
    const double apart = inertia / *options_.inertia_kgm2;
    if (apart > kScaleApart || apart < 1.0 / kScaleApart) {
      throw Refusal("the motor answers as one of " + rounded(1e3 * inertia, 3) + " g m2, " + rounded(apart, 2) +
                    " times the data sheet's: motor.encoder_counts or motor.torque_per_current is wrong by about "
                    "that; compare both with the data sheets of encoder, gear and motor");
    }
    find("inertia " + rounded(1e3 * inertia, 3) + " g m2, the data sheet's times " + rounded(apart, 2) +
         ": counts and torque per current agree with it");
  } else {
    find("inertia " + rounded(1e3 * inertia, 3) +
         " g m2; nobody said what the data sheet has (--inertia), so wrong counts would not be seen");
  }
}

void CommissionSteps::shake(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.let_go();
  double last = 0.0;
  const auto answered = [&joint](const CsvLog& log) {
    return rms_about_mean(joint.column(log, "q1_rad")) > kAnswerCounts * joint.count_rad();
  };
  bool answers = false;
  for (double share = kFirstShare; share < kMostShare; share *= kGrowth) {
    std::optional<CsvLog> shaken;
    try {
      const double amplitude_nm = share * steps.continuous_nm();
      if (!answers) {
        shaken = steps.shaken(amplitude_nm, kGlanceS);
        answers = answered(*shaken);
      }
      if (answers) {
        shaken = steps.shaken(amplitude_nm, kShakeS);
      }
    } catch (const Refusal&) {
      if (last == 0.0) {
        throw;
      }
      // It went too far; what the amplitude before this one showed decides.
      break;
    }
    const CsvLog& log = *shaken;
    answers = answered(log);
    if (answers || kGrowth * share >= kMostShare) {
      steps.judge_current(log);
    }
    const double inertia = answers ? steps.inertia_of(log) : 0.0;
    // Friction holds a motor that is shaken too little, and passes for inertia.
    if (answers && std::fabs(inertia - last) < kSettled * std::fabs(inertia)) {
      steps.judge_inertia(inertia);
      return;
    }
    last = inertia;
  }
  if (last != 0.0) {
    steps.judge_inertia(last);
    return;
  }
  throw Refusal(
      "the motor has its current and the encoder does not count: it is blocked, or the encoder is dead; turn it by "
      "hand and look at 'log'");
}

void CommissionSteps::press(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.let_go();
  for (double share = 0.25 * kFirstShare; share < 1.0; share *= 1.25) {
    const double torque = share * steps.continuous_nm();
    joint.arm();
    const CsvLog log = joint.rows("experiment", "torque_triangle every=2 cycles=1 amplitude=" + rounded(torque, 6) +
                                                    "Nm rates=" + rounded(8.0 * torque, 6) + "Nm/s");
    joint.disarm();
    const Eigen::VectorXd angle = joint.column(log, "q1_rad");
    if (angle.maxCoeff() - angle.minCoeff() < kPressRad) {
      continue;
    }
    const Eigen::VectorXd pressed = joint.column(log, "tau_Nm");
    const double begin = angle[0];
    const double up = angle.maxCoeff() - begin;
    const double down = begin - angle.minCoeff();
    // Torque at a fifth of the way up, against that at its end: friction alone needs as much at once.
    Eigen::Index fifth = 0;
    while (fifth < angle.size() && angle[fifth] - begin < 0.2 * up) {
      ++fifth;
    }
    const double elastic = 1.0 - pressed[std::min(fifth, angle.size() - 1)] / torque;
    if (elastic < kElastic) {
      throw Refusal(
          "the motor turns under friction alone, without a spring: no tendon pulls at it; hook the tendons, and give "
          "them pretension");
    }
    if (up > kOneSided * down || down > kOneSided * up) {
      throw Refusal(std::string("the motor turns far more easily ") + (up > down ? "forward" : "backward") +
                    ": one tendon is loose or off; hook it, and give both their pretension");
    }
    steps.find("both tendons pull: " + rounded(torque / std::max(up, down), 3) + " Nm/rad at the motor at first");
    return;
  }
  throw Refusal(
      "the motor does not turn by 1 deg under its continuous torque: it is blocked; free it, or check "
      "limits.continuous_current and motor.torque_per_current");
}

void CommissionSteps::travel(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.keep_to_corridor();
  steps.calm();
  joint.set("limits.current", joint.text("limits.continuous_current"));
  joint.set("observer.inertia", "0");
  const double reach = 0.6 * steps.options_.corridor_rad;
  joint.arm();
  CsvLog log = [&] {
    try {
      return joint.rows("experiment", "triangle every=5 cycles=3 repeats=1 amplitude=" + rounded(reach, 6) +
                                          "rad offset=" + rounded(steps.home_rad_, 6) +
                                          "rad speeds=" + rounded(reach / 1.5, 6) + "rad/s");
    } catch (const Refusal& refusal) {
      throw Refusal(
          std::string(
              "the joint does not follow a slow motion, so it is blocked or presses against something; free it (") +
          refusal.what() + ")");
    }
  }();
  joint.disarm();
  const Eigen::VectorXd torque = joint.column(log, "tau_Nm");
  const Eigen::VectorXd angle = joint.column(log, "q1_rad");
  const double middle = 0.5 * (angle.maxCoeff() + angle.minCoeff());
  const double half = 0.5 * (angle.maxCoeff() - angle.minCoeff());
  std::array<double, 2> at_middle{};
  std::array<double, 2> at_end{};
  std::array<int, 2> middles{};
  std::array<int, 2> ends{};
  for (Eigen::Index i = angle.size() / 3; i + 4 < angle.size(); ++i) {
    const std::size_t forward = angle[i + 4] > angle[i] ? 1 : 0;
    const double place = (forward == 1 ? 1.0 : -1.0) * (angle[i] - middle) / half;
    if (std::fabs(place) < 0.15) {
      at_middle[forward] += torque[i];
      ++middles[forward];
    } else if (place > 0.7 && place < 0.95) {
      at_end[forward] += torque[i];
      ++ends[forward];
    }
  }
  if (middles[0] * middles[1] * ends[0] * ends[1] == 0) {
    throw Refusal("the motor did not go to and fro as it was told; look at the log of 'experiment " + joint.name() +
                  " triangle'");
  }
  for (std::size_t i = 0; i < 2; ++i) {
    at_middle[i] /= middles[i];
    at_end[i] /= ends[i];
  }
  const double band = at_end[1] - at_end[0];
  const double rise = (band - (at_middle[1] - at_middle[0])) / band;
  if (rise > kBlocked) {
    throw Refusal("the torque goes on rising as the motor turns (" + rounded(100.0 * rise, 2) +
                  " % over half a leg): the joint is blocked or presses against something; free it, or make the "
                  "corridor smaller");
  }
  steps.all_.progress.backward_nm = at_middle[0];
  steps.all_.progress.forward_nm = at_middle[1];
  steps.find("friction: " + rounded(at_middle[1], 3) + " Nm forward, " + rounded(at_middle[0], 3) + " Nm backward");
}

void CommissionSteps::motor(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.keep_to_corridor();
  steps.calm();
  joint.set("observer.inertia", "0");
  joint.arm();
  try {
    for (const std::string& line : joint.ask("commission " + joint.name() + " amplitude=" +
                                             rounded(std::min(0.3, 0.8 * steps.options_.corridor_rad)) + "rad")) {
      const std::string prefix = joint.name() + ".observer.";
      if (line.starts_with(prefix)) {
        const std::size_t blank = line.find(' ');
        steps.decide(line.substr(joint.name().size() + 1, blank - joint.name().size() - 1), line.substr(blank + 1));
      }
    }
    steps.find("the motor observer watches: inertia " + joint.text("observer.inertia"));
  } catch (const Refusal& refusal) {
    if (std::string(refusal.what()).find("not_here") == std::string::npos) {
      throw;
    }
    steps.find(
        "this board can not find the motor observer's values; commission the joint on Linux and set observer.* here");
  }
}

}  // namespace capstan::tools
