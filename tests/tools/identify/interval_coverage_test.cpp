// SPDX-License-Identifier: Apache-2.0
// Counts how often 95 % intervals hold the truth. The joints are formulas written down here, not the model's terms.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include "capstan/tools/identify/identify.hpp"

namespace capstan::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRateHz = 100.0;
constexpr Eigen::Index kRows = 3000;
constexpr double kNoise = 0.002;  // rad, standard deviation

using Random = std::mt19937_64;

auto between(Random& random, double low, double high) -> double {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// First-order autoregressive, of unit variance; memory 0 is white.
auto autoregressive(Random& random, double memory) -> Eigen::VectorXd {
  std::normal_distribution<double> normal;
  Eigen::VectorXd noise(kRows);
  double x = normal(random);
  for (double& value : noise) {
    x = memory * x + std::sqrt(1.0 - memory * memory) * normal(random);
    value = x;
  }
  return noise;
}

/// A hum of unknown phase whose pitch is not quite steady, in white noise of the same variance.
auto periodic(Random& random) -> Eigen::VectorXd {
  constexpr double kPitchHz = 1.3;
  constexpr double kWander = 0.05;  // rad a sample, standard deviation
  std::normal_distribution<double> normal;
  Eigen::VectorXd noise(kRows);
  double phase = between(random, 0.0, 2.0 * kPi);
  for (double& value : noise) {
    phase += 2.0 * kPi * kPitchHz / kRateHz + kWander * normal(random);
    value = std::sin(phase) + std::sqrt(0.5) * normal(random);
  }
  return noise;
}

const std::map<std::string, std::function<Eigen::VectorXd(Random&)>> kNoises = {
    {"white", [](Random& random) { return autoregressive(random, 0.0); }},
    {"autoregressive", [](Random& random) { return autoregressive(random, 0.95); }},
    {"slow", [](Random& random) { return autoregressive(random, 0.985); }},
    {"periodic", periodic}};

/// One joint with its motion, all drawn.
struct Joint {
  double beta = 1.0, offset = 0.0, top = -0.9, bottom = -0.6;
  double half_gap_rad = 0.0, delay_s = 0.0;
  std::vector<double> amplitude, pitch, phase;  // of the motor's sines
  double load = 0.0;

  explicit Joint(Random& random)
      : beta(between(random, 0.8, 1.2)),
        offset(between(random, -0.1, 0.1)),
        top(between(random, -1.0, -0.6)),
        bottom(between(random, -0.8, -0.4)),
        load(between(random, 0.01, 0.02)) {
    for (const double base : {0.3, 0.9, 1.7, 3.1}) {  // rad/s
      amplitude.push_back(between(random, 0.2, 0.4));
      pitch.push_back(base * between(random, 0.8, 1.2));
      phase.push_back(between(random, 0.0, 2.0 * kPi));
    }
  }
  [[nodiscard]] auto motor(double t) const -> double {
    double q = 0.0;
    for (std::size_t i = 0; i < pitch.size(); ++i) {
      q += amplitude[i] * std::sin(pitch[i] * t + phase[i]);
    }
    return q;
  }
  [[nodiscard]] auto speed(double t) const -> double {
    double v = 0.0;
    for (std::size_t i = 0; i < pitch.size(); ++i) {
      v += amplitude[i] * pitch[i] * std::cos(pitch[i] * t + phase[i]);
    }
    return v;
  }
  [[nodiscard]] auto torque(double t) const -> double {
    return 0.03 * motor(t) + 0.02 * std::tanh(speed(t) / 0.2) + load * std::sin(1.1 * t + phase[0]);
  }
};

auto record(const Joint& joint, const Eigen::VectorXd& noise) -> AxisLog {
  AxisLog log;
  log.name = "drawn";
  log.target = "axis0/q2_rad";
  log.period_s = 1.0 / kRateHz;
  log.has_torque = true;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, static_cast<double>(kRows - 1) / kRateHz);
  log.q1_rad = log.time_s.unaryExpr([&](double t) { return joint.motor(t); });
  log.tau_nm = log.time_s.unaryExpr([&](double t) { return joint.torque(t); });
  log.q2_rad.resize(kRows);
  // The gap is followed in fine steps, from where it was at the start.
  constexpr int kFine = 4;
  double follower = joint.motor(-joint.delay_s);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    double t = 0.0;
    for (int k = 1 - kFine; k <= 0; ++k) {
      t = (static_cast<double>(i) + static_cast<double>(k) / kFine) / kRateHz - joint.delay_s;
      const double q = joint.motor(t);
      follower = std::min(std::max(follower, q - joint.half_gap_rad), q + joint.half_gap_rad);
    }
    const double elongation = joint.speed(t) > 0.0 ? joint.top : joint.bottom;
    log.q2_rad[i] = joint.beta * follower + joint.offset + elongation * joint.torque(t) + kNoise * noise[i];
  }
  return log;
}

/// How often the interval of each parameter held its truth.
using Count = std::map<std::string, int>;

void count_inside(const std::string& name, double truth, const std::optional<Interval>& interval, Count& held) {
  held[name] += interval && (*interval)[0] <= truth && truth <= (*interval)[1] ? 1 : 0;
}

void count_joint(const Joint& joint, const JointFile& law, Count& held) {
  const auto coefficient = [&](const char* term, std::size_t i) {
    return law.coefficient_ci95[catalogue_term(term).first_coefficient + i];
  };
  count_inside("beta", joint.beta, coefficient("motor_angle", 0), held);
  count_inside("offset", joint.offset, coefficient("joint_offset", 0), held);
  count_inside("top", joint.top, coefficient("tendon_elongation", 0), held);
  count_inside("bottom", joint.bottom, coefficient("tendon_elongation", 1), held);
  if (law.has("play")) {
    count_inside("gap", joint.half_gap_rad, law.shape_ci95[catalogue_term("play").first_shape], held);
    count_inside("gain", joint.beta, coefficient("play", 0), held);
  }
  if (law.has("transport_delay")) {
    count_inside("delay", joint.delay_s, law.shape_ci95[catalogue_term("transport_delay").first_shape], held);
  }
}

auto pseudo_kinematic() -> LawForm {
  LawForm form;
  form.terms = terms_of_model("pseudo_kinematic");
  return form;
}

/// Of `draws`, as many as 95 % allow: fewer by chance once in some 10^4.
auto fewest(int draws) -> double {
  return 0.95 * draws - 3.7 * std::sqrt(draws * 0.95 * 0.05);
}

/// Intervals of least squares that take the noise for white.
auto naive_intervals(const Joint& joint, const AxisLog& log) -> std::map<std::string, Interval> {
  const Eigen::ArrayXd forward =
      log.time_s.unaryExpr([&](double t) { return joint.speed(t) > 0.0 ? 1.0 : 0.0; }).array();
  Eigen::MatrixXd columns(kRows, 4);
  columns << log.q1_rad, Eigen::VectorXd::Ones(kRows), (forward * log.tau_nm.array()).matrix(),
      ((1.0 - forward) * log.tau_nm.array()).matrix();
  const Eigen::MatrixXd inverse = (columns.transpose() * columns).inverse();
  const Eigen::VectorXd theta = inverse * columns.transpose() * log.q2_rad;
  const double variance = (log.q2_rad - columns * theta).squaredNorm() / static_cast<double>(kRows - 4);
  std::map<std::string, Interval> intervals;
  const char* const names[] = {"beta", "offset", "top", "bottom"};
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double half = 1.96 * std::sqrt(variance * inverse(i, i));
    intervals[names[i]] = {theta[i] - half, theta[i] + half};
  }
  return intervals;
}

class Coverage : public testing::TestWithParam<std::string> {};

TEST_P(Coverage, IntervalsOfCoefficientsHoldTheTruth) {
  constexpr int kDraws = 150;
  Random random(71);
  Count held;
  Count held_naively;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Joint joint(random);
    const AxisLog log = record(joint, kNoises.at(GetParam())(random));
    count_joint(joint, identify({log}, pseudo_kinematic()).joint, held);
    const auto naive = naive_intervals(joint, log);
    count_inside("beta", joint.beta, naive.at("beta"), held_naively);
    count_inside("offset", joint.offset, naive.at("offset"), held_naively);
    count_inside("top", joint.top, naive.at("top"), held_naively);
    count_inside("bottom", joint.bottom, naive.at("bottom"), held_naively);
  }
  int all = 0;
  for (const auto& [name, count] : held) {
    EXPECT_GE(count, fewest(kDraws)) << name << ", of " << kDraws;
    all += count;
    const bool coloured = GetParam() == "autoregressive" || GetParam() == "slow";
    EXPECT_TRUE(!coloured || held_naively[name] < fewest(kDraws)) << "this test would pass intervals for white noise";
  }
  EXPECT_LE(all, 0.995 * 4 * kDraws) << "wider than 95 % need";
}

TEST_P(Coverage, IntervalsOfAGapAndOfADelayHoldTheTruth) {
  constexpr int kDraws = 35;  // of each
  Random random(72);
  Count held;
  for (int draw = 0; draw < 2 * kDraws; ++draw) {
    Joint joint(random);
    const bool late = draw % 2 == 0;
    // Without a jump where the motor turns: the switch notices it half a sample late, which is no noise.
    joint.bottom = joint.top;
    LawForm form = pseudo_kinematic();
    form.terms.push_back(late ? "transport_delay" : "play");
    (late ? joint.delay_s : joint.half_gap_rad) = late ? between(random, 0.004, 0.03) : between(random, 0.01, 0.03);
    count_joint(joint, identify({record(joint, kNoises.at(GetParam())(random))}, form).joint, held);
  }
  for (const auto& [name, count] : held) {
    const int draws = name == "delay" || name == "gap" || name == "gain" ? kDraws : 2 * kDraws;
    EXPECT_GE(count, fewest(draws)) << name << ", of " << draws;
  }
}

// The running switch sees a turn some counts late, and the rows until then are on the wrong side of the elongation's
// jump.
TEST(CoverageBehindAnEncoder, IntervalsOfElongationHoldTheTruth) {
  constexpr int kDraws = 40;
  constexpr double kStep = 2.0 * kPi / 4096.0;
  Random random(74);
  Count held;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Joint joint(random);
    AxisLog log = record(joint, 0.25 * kNoises.at("white")(random));
    log.q1_rad = (log.q1_rad.array() / kStep).round() * kStep;
    count_joint(joint, identify({log}, pseudo_kinematic()).joint, held);
  }
  for (const char* name : {"top", "bottom"}) {
    EXPECT_GE(held[name], fewest(kDraws)) << name << ", of " << kDraws;
  }
}

TEST(CoverageUnderNoisyTorque, IntervalsHoldWhatTheNoiseOfTheTorqueHides) {
  constexpr int kDraws = 60;
  constexpr double kTorqueNoiseNm = 0.002;  // of some 0.02
  Random random(73);
  Count held;
  Count held_naively;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Joint joint(random);
    AxisLog log = record(joint, kNoises.at("white")(random));
    log.tau_nm += kTorqueNoiseNm * autoregressive(random, 0.0);
    count_joint(joint, identify({log}, pseudo_kinematic()).joint, held);
    const auto naive = naive_intervals(joint, log);
    count_inside("top", joint.top, naive.at("top"), held_naively);
    count_inside("bottom", joint.bottom, naive.at("bottom"), held_naively);
  }
  for (const auto& [name, count] : held) {
    EXPECT_GE(count, fewest(kDraws)) << name << ", of " << kDraws;
  }
  EXPECT_LT(held_naively["top"] + held_naively["bottom"], kDraws) << "this test would pass what least squares say";
}

INSTANTIATE_TEST_SUITE_P(Noise, Coverage, testing::Values("white", "autoregressive", "slow", "periodic"),
                         [](const auto& named) { return named.param; });

}  // namespace
}  // namespace capstan::tools
