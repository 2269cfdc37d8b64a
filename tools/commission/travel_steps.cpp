// SPDX-License-Identifier: Apache-2.0
// The steps of commissioning that move the joint slowly: how far it goes, and what torque that takes.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "capstan/tools/commission/steps.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

// Numbers that decide, chosen in November 2026 on the drawn forceps 720, 721 and 740 to 759 of commission_test;
// docs/tuning.md reports other seeds.
constexpr double kTurnShare = 0.1;  // of the whole way: less is no turn
// Ways over which friction may go over to the other direction; on the elbows 1150 to 1159 they are 0.1 to 0.4 rad.
constexpr double kReversalFromRad = 0.005, kReversalStep = 1.1;
constexpr double kBlocked = 0.25;  // rise of the torque over the last half of a leg, of that at its end
constexpr double kReach = 0.6;     // of the corridor, either way
constexpr double kSlowLegS = 3.0;  // of a slow motion

// `ends`, chosen in November 2026 on the forceps 4478, the elbow 4530 and the wrist 4530; docs/tuning.md reports other
// seeds. Free steps took the same torque within 1 %, the first two at a stop 18 to 36 % more.
constexpr double kEndsReach = 0.3;       // of the corridor: where friction is measured first
constexpr double kStepOfError = 0.4;     // of limits.following_error: at half of it without a count the encoder is dead
constexpr double kArrived = 0.5;         // of a step
constexpr int kArriveLooks = 20;         // of a tenth of a second
constexpr std::size_t kSteadySteps = 4;  // that took the same ...
constexpr double kSteady = 0.05;         // ... within this share, ...
constexpr double kRises = 1.15;          // ... and then this much more: a stop
constexpr double kEndsTorque = 1.3;      // of what friction takes: a stop in any case ...
constexpr double kEndsShare = 0.95;   // ... as is this of the continuous torque, which is the most the motor has here
constexpr double kMarginSteps = 2.0;  // from the stop to the joint's limit: tendons bend there

/// Rows at which a motion to and fro turns.
auto turns_of(const Eigen::VectorXd& angle) -> std::vector<Eigen::Index> {
  const double least = kTurnShare * (angle.maxCoeff() - angle.minCoeff());
  std::vector<Eigen::Index> turns;
  bool forward = true;
  Eigen::Index furthest = 0;
  for (Eigen::Index i = 1; i < angle.size(); ++i) {
    const double back = (forward ? 1.0 : -1.0) * (angle[furthest] - angle[i]);
    if (back > least) {
      turns.push_back(furthest);
      forward = !forward;
    }
    furthest = back > least || back < 0.0 ? i : furthest;
  }
  return turns;
}

/// Tendons bend before they slide: after a turn, what is left of the other direction's torque falls as exp(-way /
/// angle). That angle, rad, by least squares over the first half of every leg; 0: at once.
/// @param steady_nm  backward and forward
auto reversal_angle(const Eigen::VectorXd& angle, const Eigen::VectorXd& torque, const std::array<double, 2>& steady_nm)
    -> double {
  const double half = 0.5 * (angle.maxCoeff() - angle.minCoeff());
  std::vector<std::array<double, 2>> rows;  // way since the turn, share that is left
  const std::vector<Eigen::Index> turns = turns_of(angle);
  for (std::size_t k = 0; k + 1 < turns.size(); ++k) {
    const double from = angle[turns[k]];
    const std::size_t to = angle[turns[k + 1]] > from ? 1 : 0;
    for (Eigen::Index i = turns[k]; i < turns[k + 1] && std::fabs(angle[i] - from) < half; ++i) {
      rows.push_back({std::fabs(angle[i] - from), (torque[i] - steady_nm[to]) / (steady_nm[1 - to] - steady_nm[to])});
    }
  }
  const auto off = [&rows](double over) {
    double squares = 0.0;
    for (const auto& [way, left] : rows) {
      squares += std::pow(left - (over > 0.0 ? std::exp(-way / over) : 0.0), 2);
    }
    return squares;
  };
  double best = 0.0;
  for (double over = kReversalFromRad; over < half; over *= kReversalStep) {
    best = off(over) < off(best) ? over : best;
  }
  return best;
}

/// Backward and forward, N m: about the middle of the way, and towards its ends.
struct ToAndFro {
  std::array<double, 2> at_middle{}, at_end{};
};

/// Nothing: the motor did not go both ways.
auto torque_to_and_fro(const Eigen::VectorXd& angle, const Eigen::VectorXd& torque) -> std::optional<ToAndFro> {
  const double middle = 0.5 * (angle.maxCoeff() + angle.minCoeff());
  const double half = 0.5 * (angle.maxCoeff() - angle.minCoeff());
  ToAndFro sums;
  std::array<int, 2> middles{};
  std::array<int, 2> ends{};
  for (Eigen::Index i = angle.size() / 3; i + 4 < angle.size(); ++i) {
    const std::size_t forward = angle[i + 4] > angle[i] ? 1 : 0;
    const double place = (forward == 1 ? 1.0 : -1.0) * (angle[i] - middle) / half;
    if (std::fabs(place) < 0.15) {
      sums.at_middle[forward] += torque[i];
      ++middles[forward];
    } else if (place > 0.7 && place < 0.95) {
      sums.at_end[forward] += torque[i];
      ++ends[forward];
    }
  }
  if (middles[0] * middles[1] * ends[0] * ends[1] == 0) {
    return {};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    sums.at_middle[i] /= middles[i];
    sums.at_end[i] /= ends[i];
  }
  return sums;
}

auto median_of(const std::vector<double>& values, std::size_t from, std::size_t to) -> double {
  return median(Eigen::Map<const Eigen::VectorXd>(values.data() + from, static_cast<Eigen::Index>(to - from)));
}

/// Whether the last step took more torque than some steps before it, which took the same: a stop, where a weight or
/// tendons that still bend change it slowly or all the time.
auto rises(const std::vector<double>& torque) -> bool {
  if (torque.size() < kSteadySteps + 2) {
    return false;
  }
  const std::size_t to = torque.size() - 2;
  const std::size_t from = to - kSteadySteps;
  const double level = median_of(torque, from, to);
  const auto [least, most] = std::minmax_element(torque.begin() + static_cast<std::ptrdiff_t>(from),
                                                 torque.begin() + static_cast<std::ptrdiff_t>(to));
  return *most - *least < kSteady * level && torque.back() > kRises * level;
}

/// The last step ahead of a stop.
auto last_free(const std::vector<double>& torque) -> std::size_t {
  const double level = median_of(torque, 0, torque.size());
  std::size_t free = torque.size() - 1;
  while (free > 0 && torque[free] > (1.0 + kSteady) * level) {
    --free;
  }
  return free;
}

}  // namespace

auto CommissionSteps::slow_motion(double reach_rad) -> SlowMotion {
  calm();
  joint_.set("limits.current", joint_.text("limits.continuous_current"));
  watch_frozen();
  joint_.arm();
  const CsvLog log = [&] {
    try {
      return joint_.rows("experiment", "triangle every=5 cycles=3 repeats=1 amplitude=" + rounded(reach_rad, 6) +
                                           "rad offset=" + rounded(corridor_.middle, 6) +
                                           "rad speeds=" + rounded(2.0 * reach_rad / kSlowLegS, 6) + "rad/s");
    } catch (const Refusal& refusal) {
      throw Refusal(
          std::string(
              "the joint does not follow a slow motion, so it is blocked or presses against something; free it (") +
          refusal.what() + ")");
    }
  }();
  joint_.disarm();
  const Eigen::VectorXd torque = joint_.column(log, "tau_Nm");
  const Eigen::VectorXd angle = joint_.column(log, "q1_rad");
  const auto means = torque_to_and_fro(angle, torque);
  if (!means) {
    throw Refusal("the motor did not move both ways as commanded; look at the log of 'experiment " + joint_.name() +
                  " triangle'");
  }
  const auto& [at_middle, at_end] = *means;
  const double band = at_end[1] - at_end[0];
  return {.backward_nm = at_middle[0],
          .forward_nm = at_middle[1],
          .rise = (band - (at_middle[1] - at_middle[0])) / band,
          .reversal_rad = reversal_angle(angle, torque, at_middle)};
}

void CommissionSteps::require_free(const SlowMotion& motion) {
  if (motion.rise > kBlocked) {
    throw Refusal("the torque goes on rising as the motor turns (" + rounded(100.0 * motion.rise, 2) +
                  " % over half a leg): the joint is blocked or presses against something; free it, or make the "
                  "corridor smaller, or have its end stops looked for (--find-ends); or its tendons have so much "
                  "friction that they only stretch over such a short travel: then make the corridor larger");
  }
}

void CommissionSteps::know(const SlowMotion& motion) {
  all_.progress.backward_nm = motion.backward_nm;
  all_.progress.forward_nm = motion.forward_nm;
  all_.progress.reversal_rad = motion.reversal_rad;
}

void CommissionSteps::travel(CommissionSteps& steps) {
  steps.keep_to_corridor();
  const SlowMotion motion = steps.slow_motion(kReach * steps.corridor_.half);
  require_free(motion);
  steps.know(motion);
  steps.find("friction: " + rounded(motion.forward_nm, 3) + " Nm forward, " + rounded(motion.backward_nm, 3) +
             " Nm backward; it changes over within " + rounded(motion.reversal_rad, 2) + " rad of the motor");
}

auto CommissionSteps::step_to(double target_rad, const Pace& pace) -> Stood {
  Stood stood{};
  for (int look = 0; look < kArriveLooks && !stood.there; ++look) {
    const CsvLog log = joint_.rows("log", "10 10");
    const Eigen::VectorXd angle = joint_.column(log, "q2_est_rad");
    const Eigen::VectorXd motor = joint_.column(log, "q1_rad");
    stood = {.motor_rad = motor[motor.size() - 1],
             .joint_rad = angle[angle.size() - 1],
             .torque_nm = std::fabs(joint_.column(log, "tau_Nm").mean()),
             .there = std::fabs(angle[angle.size() - 1] - target_rad) < kArrived * pace.step_rad};
    if (stood.torque_nm > pace.most_nm) {
      stood.there = false;
      break;
    }
  }
  return stood;
}

auto CommissionSteps::end_towards(double sign, const Pace& pace) -> std::optional<End> {
  std::vector<Stood> way;
  std::vector<double> torque;
  for (double on = pace.step_rad; on <= corridor_.half; on += pace.step_rad) {
    const double target = corridor_.middle + sign * on;
    static_cast<void>(joint_.order("move " + joint_.name() + " " + rounded(target, 6) + " rad"));
    way.push_back(step_to(target, pace));
    torque.push_back(way.back().torque_nm);
    if (!way.back().there || rises(torque)) {
      return End{.motor_rad = way.back().motor_rad, .joint_rad = way[last_free(torque)].joint_rad};
    }
  }
  return {};
}

void CommissionSteps::decide_end(const End& end, double sign, double margin_rad) {
  decide(sign > 0.0 ? "limits.joint_max" : "limits.joint_min", rounded(end.joint_rad - sign * margin_rad, 4) + " rad");
  // Beyond where it pressed the motor has nothing to do; the limits that were given stay where they are nearer.
  const bool up = (sign > 0.0) == (joint_.value("motor_angle.beta") > 0.0);
  const std::string limit = up ? "limits.motor_max" : "limits.motor_min";
  if (up ? end.motor_rad < joint_.value(limit) : end.motor_rad > joint_.value(limit)) {
    decide(limit, rounded(end.motor_rad, 4) + " rad");
  }
}

void CommissionSteps::ends(CommissionSteps& steps) {
  JointConsole& joint = steps.joint_;
  steps.keep_to_corridor();
  const SlowMotion motion = steps.slow_motion(kEndsReach * steps.corridor_.half);
  require_free(motion);
  steps.know(motion);
  steps.calm();  // with that friction
  const Pace pace{
      .step_rad = kStepOfError * joint.value("limits.following_error"),
      .most_nm = std::min(kEndsShare * steps.continuous_nm(),
                          kEndsTorque * std::max(std::fabs(motion.forward_nm), std::fabs(motion.backward_nm)))};
  joint.arm();
  std::array<std::optional<End>, 2> found;
  for (const std::size_t up : {std::size_t{0}, std::size_t{1}}) {
    steps.go_home();
    found[up] = steps.end_towards(up == 1 ? 1.0 : -1.0, pace);
  }
  steps.go_home();
  joint.disarm();
  std::string sentence;
  for (const std::size_t up : {std::size_t{0}, std::size_t{1}}) {
    const std::string side = up == 1 ? "forward" : "backward";
    if (found[up]) {
      steps.decide_end(*found[up], up == 1 ? 1.0 : -1.0, kMarginSteps * pace.step_rad);
      sentence += side + " a stop at " + rounded(found[up]->joint_rad, 3) + " rad (motor " +
                  rounded(found[up]->motor_rad, 3) + " rad), ";
    } else {
      sentence += side + " none within the corridor, ";
    }
  }
  steps.find(sentence + "pressed with " + rounded(pace.most_nm, 2) + " Nm at most");
  steps.corridor_ = steps.corridor();
}

}  // namespace capstan::tools
