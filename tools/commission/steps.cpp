// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/commission/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Numbers that decide, chosen in November 2026 on the drawn forceps 720, 721 and 740 to 759 of commission_test, those
// of `press` on forceps, wrist and finger 911 and 912; docs/tuning.md reports other seeds.
constexpr double kMostZeroShare = 0.05;     // of limits.current: an offset that is no offset any more
constexpr double kSoftStiffness = 0.02;     // Nm/rad: far below any tendon's, so that a wrong sign does not run away
constexpr double kCalmStiffness = 25000.0;  // Nm/rad per kg m2: 25 Hz, damped at 0.8 of critical
constexpr double kCalmDamping = 250.0;      // Nms/rad per kg m2
constexpr double kCalmReversalS =
    0.1;  // so that soft tendons with much friction do not jump where they turn (elbow 912)
constexpr double kFirstPressShare = 0.0075;  // of the continuous torque
constexpr double kPressGrowth = 1.25;
constexpr double kPressPerS = 32.0;  // of the torque: an eighth of a second, in which a motor alone does not run far
constexpr double kPressRad = 1.0 * kDegree;  // one way, and no fewer counts of the encoder than a tenth is told by ...
constexpr double kFewCounts = 16.0, kEnoughCounts = 30.0;  // ... nor more than are needed
constexpr double kSpringsBack = 0.06;                      // of the way; tendons on 0.11 to 0.29, off 0 to 0.083
// Of the way, when the torque is largest. A motor with dry friction alone has gone a sixth at most, the cube of the
// time from where it lets go (with viscous friction a half, but it does not spring back); on tendons 0.68 to 0.92.
constexpr double kAtPeak = 1.0 / 3.0;
constexpr double kAtPeakCounts = 6.0;   // each way: a count is half of that third
constexpr double kOneSided = 3.0;       // of the ways
constexpr double kLeastHalfRad = 0.05;  // of a corridor: less is no way for any step
// limits.following_error: half of it without a count is `encoder_frozen`. A coarse encoder and friction leave elbows
// 4000 to 4006 without a count for more than the half of 32 (0.05 rad), not of 60.
constexpr double kFrozenRad = 0.05, kFrozenCounts = 100.0;
constexpr double kOffForS = 3.0;     // a leg of `travel`, in which friction is not known yet
constexpr double kHomeShare = 0.05;  // of the corridor
constexpr int kMostWaits = 30;       // of a second, until it is at home
// Of the continuous torque, for a motor whose answer to the board's own dither, half as large, is fewer counts than
// that: of the 50 elbows 1300 to 1349 four with 1.2 and less did not show their inertia. They
// travel a third further, too.
constexpr double kLouderDither = 0.1;
constexpr double kFewDitherCounts = 1.3;
constexpr double kDitherHz = 83.3;

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

auto CommissionSteps::motor_here() -> double {
  return joint_.column(joint_.rows("log", "20 10"), "q1_rad").mean();
}

auto CommissionSteps::corridor() const -> Corridor {
  const double home = all_.progress.home_rad.value_or(stood_rad_);
  const double low = std::max(home - options_.corridor_rad, joint_.value("limits.joint_min"));
  const double high = std::min(home + options_.corridor_rad, joint_.value("limits.joint_max"));
  return {.middle = 0.5 * (low + high), .half = 0.5 * (high - low)};
}

void CommissionSteps::keep_to_corridor() {
  const std::string stands = "the joint stands at " + rounded(stood_rad_, 3) + " rad, ";
  if (stood_rad_ < joint_.value("limits.joint_min") || stood_rad_ > joint_.value("limits.joint_max")) {
    throw Refusal(stands +
                  "outside limits.joint_min to limits.joint_max: turn it back by hand, set its angle with "
                  "'zero', or hook the tendon that came off");
  }
  if (corridor_.half < kLeastHalfRad) {
    throw Refusal(stands + "so limits.joint_min and limits.joint_max leave it a corridor of " +
                  rounded(std::max(0.0, 2.0 * corridor_.half), 2) + " rad; turn it towards their middle");
  }
  if (std::fabs(stood_rad_ - corridor_.middle) > corridor_.half + kLeastHalfRad) {
    throw Refusal(stands + "outside the corridor from " + rounded(corridor_.middle - corridor_.half, 3) + " to " +
                  rounded(corridor_.middle + corridor_.half, 3) +
                  " rad about where it stood at first: turn it back by hand, or start again with --again");
  }
  joint_.set("limits.joint_min", rounded(corridor_.middle - corridor_.half, 6) + " rad");
  joint_.set("limits.joint_max", rounded(corridor_.middle + corridor_.half, 6) + " rad");
}

void CommissionSteps::go_home() {
  joint_.ask("move " + joint_.name() + " " + rounded(corridor_.middle, 6) + " rad");
  for (int i = 0; i < kMostWaits; ++i) {
    const Eigen::VectorXd angle = joint_.column(joint_.rows("log", "20 50"), "q2_est_rad");
    if (std::fabs(angle[angle.size() - 1] - corridor_.middle) < kHomeShare * corridor_.half) {
      return;
    }
  }
  throw Refusal("the joint does not go to the middle of its corridor, at " + rounded(corridor_.middle, 3) +
                " rad, so it is blocked or presses against something; free it");
}

void CommissionSteps::watch_frozen() {
  joint_.set("observer.inertia", "0");
  const double still = std::max(kFrozenRad, kFrozenCounts * joint_.count_rad() * joint_.value("motor_angle.beta"));
  joint_.set("limits.following_error", rounded(std::min(still, joint_.value("limits.following_error"))) + " rad");
  joint_.set("limits.following_time", rounded(std::max(kOffForS, joint_.value("limits.following_time"))) + " s");
}

void CommissionSteps::calm() {
  joint_.set("control.stiffness", rounded(kCalmStiffness * all_.progress.inertia_kgm2, 6) + " Nm/rad");
  joint_.set("control.damping", rounded(kCalmDamping * all_.progress.inertia_kgm2, 6) + " Nms/rad");
  // Of tuned gains the rate's filter is far faster: a coarse encoder's steps drown the shake (elbows 4580 to 4582).
  const LoopGains usual;
  joint_.set("control.rate_time_constant", rounded(usual.rate_time_constant_s) + " s");
  joint_.set("control.kp", rounded(usual.kp));
  joint_.set("control.ki", rounded(usual.ki_per_s) + " 1/s");
  joint_.set("control.reversal_time", rounded(kCalmReversalS) + " s");
  joint_.set("control.torque_backward", rounded(all_.progress.backward_nm, 6) + " Nm");
  joint_.set("control.torque_forward", rounded(all_.progress.forward_nm, 6) + " Nm");
  joint_.set("control.reversal_angle", rounded(all_.progress.reversal_rad, 3) + " rad");
}

void CommissionSteps::let_go() {
  keep_to_corridor();
  const double motor = motor_here();
  std::array<std::pair<const char*, double>, 2> limits{
      {{"limits.motor_min", motor - kMotorWayRad}, {"limits.motor_max", motor + kMotorWayRad}}};
  if (limits[0].second >= joint_.value(limits[1].first)) {
    std::swap(limits[0], limits[1]);  // the board takes no least angle above the largest
  }
  for (const auto& [name, angle] : limits) {
    joint_.set(name, rounded(angle, 6) + " rad");
  }
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
                  " A a thousand times without any noise, so it is dead; check its cable and supply");
  }
  if (std::fabs(current.mean()) > kMostZeroShare * joint.value("limits.current")) {
    throw Refusal("without torque the current sensor shows " + rounded(current.mean(), 3) +
                  " A; adjust its zero, or check that the amplifier is off");
  }
  if (angle.maxCoeff() - angle.minCoeff() > 20.0 * joint.count_rad()) {
    throw Refusal("the motor moves without torque; hold it, or remove what drives it");
  }
  steps.find("current sensor: zero " + rounded(1e3 * current.mean(), 2) + " mA, noise " + rounded(1e3 * noise, 2) +
             " mA");
}

auto CommissionSteps::pressed(double torque_nm) -> std::optional<CsvLog> {
  joint_.arm();
  try {
    CsvLog log = joint_.rows("experiment", "torque_triangle every=1 cycles=1 amplitude=" + rounded(torque_nm, 6) +
                                               "Nm rates=" + rounded(kPressPerS * torque_nm, 6) + "Nm/s");
    joint_.disarm();
    return log;
  } catch (const Refusal& refusal) {
    joint_.disarm();
    if (std::string(refusal.what()).find("left its limits") == std::string::npos) {
      throw;
    }
    return std::nullopt;
  }
}

void CommissionSteps::press(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.let_go();
  const double enough = std::clamp(kPressRad, kFewCounts * joint.count_rad(), kEnoughCounts * joint.count_rad());
  for (double share = kFirstPressShare; share < 1.0; share *= kPressGrowth) {
    const double torque = share * steps.continuous_nm();
    const std::optional<CsvLog> log = steps.pressed(torque);
    if (!log) {
      throw Refusal(
          "at " + rounded(torque, 2) +
          " Nm the motor lets go and runs further than 2.9 deg at once: no tendon pulls at it; hook both, and "
          "give them pretension");
    }
    const Eigen::VectorXd angle = joint.column(*log, "q1_rad");
    const double middle = angle[angle.size() / 2];  // without torque again, after the way forward
    const double up = angle.maxCoeff() - angle[0];
    const double down = middle - angle.minCoeff();
    // Tendons bend before they slide: the motor goes with the torque and springs back. A motor alone goes on while the
    // torque falls, and stays where its friction holds it.
    const double at_peak =
        std::min((angle[angle.size() / 4] - angle[0]) / up, (middle - angle[3 * angle.size() / 4]) / down);
    const double back = std::min((angle.maxCoeff() - middle) / up, (angle[angle.size() - 1] - angle.minCoeff()) / down);
    const auto require_tendons = [&](bool pull) {
      if (!pull) {
        throw Refusal("the motor turns by " + rounded(std::max(up, down) / kDegree, 2) + " deg under friction alone, " +
                      rounded(100.0 * at_peak, 2) + " % of it before the torque falls, and springs back by " +
                      rounded(100.0 * back, 2) + " %: no tendon pulls at it; hook both, and give them pretension");
      }
    };
    if (std::min(up, down) >= kAtPeakCounts * joint.count_rad()) {
      require_tendons(at_peak >= kAtPeak);
    }
    if (std::max(up, down) < enough) {
      continue;
    }
    if (up > kOneSided * down || down > kOneSided * up) {
      throw Refusal(std::string("the motor turns far more easily ") + (up > down ? "forward" : "backward") +
                    ": one tendon is loose or off; hook both, and give both the same pretension");
    }
    // A way back is known to a count; one that decides is worth a harder press, at which tendons give back more.
    if (std::fabs(back - kSpringsBack) < joint.count_rad() / std::min(up, down) && share * kPressGrowth < 1.0) {
      continue;
    }
    require_tendons(back >= kSpringsBack);
    steps.find("both tendons pull: " + rounded(torque / std::max(up, down), 3) + " Nm/rad at the motor at first, " +
               rounded(100.0 * back, 2) + " % of the travel springs back");
    return;
  }
  throw Refusal("the motor does not turn by " + rounded(enough / kDegree, 2) +
                " deg under its continuous torque: it is blocked; free it, or check limits.continuous_current and "
                "motor.torque_per_current");
}

auto CommissionSteps::commission_by_board(const std::string& order) -> bool {
  const std::string prefix = joint_.name() + ".";
  try {
    for (const std::string& line : joint_.order(order)) {
      if (line.starts_with(prefix + "observer.")) {
        const std::size_t blank = line.find(' ');
        decide(line.substr(prefix.size(), blank - prefix.size()), line.substr(blank + 1));
      }
    }
  } catch (const Refusal& refusal) {
    if (std::string(refusal.what()).find("not_here") == std::string::npos) {
      throw;
    }
    return false;
  }
  return true;
}

void CommissionSteps::motor(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.keep_to_corridor();
  steps.calm();
  steps.watch_frozen();
  joint.arm();
  steps.go_home();
  const double softest = 0.5 * kLouderDither * steps.continuous_nm() /
                         (steps.all_.progress.inertia_kgm2 * std::pow(2.0 * std::numbers::pi * kDitherHz, 2));
  const bool louder = softest < kFewDitherCounts * joint.count_rad();
  const double reach = std::min(louder ? 0.4 : 0.3, 0.8 * steps.corridor_.half);
  const std::string order = "commission " + joint.name() + " amplitude=" + rounded(reach) + "rad" +
                            (louder ? " dither=" + rounded(kLouderDither * steps.continuous_nm(), 4) + "Nm" : "");
  if (!steps.commission_by_board(order)) {
    steps.find(
        "this board cannot find the motor observer's values; commission the joint on Linux and set observer.* here");
    return;
  }
  steps.require_no_lighter(1e-3 * joint.value("observer.inertia"));
  steps.find("the motor observer is set: inertia " + joint.text("observer.inertia"));
}

}  // namespace capstan::tools
