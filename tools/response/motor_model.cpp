// SPDX-License-Identifier: Apache-2.0
// The plant behind a response as a motor with its delay, and a joint that swings on its tendons.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {
namespace {

constexpr double kPi = std::numbers::pi;

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33, those
// of the joint on robot fingers 910 to 915.
constexpr double kResonanceDb = 6.0;  // above the model of motor and delay
constexpr double kLongestDelayS = 0.01, kDelayStepS = 2e-5, kCoarseDelayStepS = 2e-4;
constexpr double kJointStep = 1.05;  // from one frequency that is tried to the next
constexpr std::array<double, 5> kJointDampings = {0.01, 0.03, 0.07, 0.15, 0.3};
constexpr double kJointIsWorth = 0.7;  // of what is left without it
constexpr int kRefinements = 6;

/// m's factor in the dynamic stiffness.
auto joint_part(double w, double joint_hz, double damping) -> Complex {
  const double own = 2.0 * kPi * joint_hz;
  const Complex bound(own * own, 2.0 * damping * own * w);
  return -w * w * bound / (bound - w * w);
}

/// 1 / G = (k - J w2 + j w b + m ...) exp(j w T): linear but for T and the joint's frequency and damping, which are
/// looked for.
class LeastSquares {
 public:
  explicit LeastSquares(const Response& response) : points_(clear_points(response)) {}
  [[nodiscard]] auto points() const -> const std::vector<ResponsePoint>& { return points_; }

  /// @param joint_hz  0: the motor alone
  [[nodiscard]] auto solve(double delay_s, double joint_hz = 0.0, double damping = 0.0) const -> MotorModel {
    const auto rows = static_cast<Eigen::Index>(points_.size());
    const Eigen::Index unknowns = joint_hz > 0.0 ? 4 : 3;
    Eigen::MatrixXd columns(2 * rows, unknowns);
    Eigen::VectorXd one = Eigen::VectorXd::Zero(2 * rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const ResponsePoint& point = points_[static_cast<std::size_t>(i)];
      const double w = 2.0 * kPi * point.hz;
      const Complex turned = point.motor.value * std::polar(1.0, w * delay_s);
      const double weight = 1.0 / (0.02 + point.motor.radius95 / std::abs(point.motor.value));
      const std::array<Complex, 4> parts = {-w * w * turned, Complex(0.0, w) * turned, turned,
                                            unknowns == 4 ? turned * joint_part(w, joint_hz, damping) : Complex{}};
      for (Eigen::Index c = 0; c < unknowns; ++c) {
        columns(2 * i, c) = weight * parts[static_cast<std::size_t>(c)].real();
        columns(2 * i + 1, c) = weight * parts[static_cast<std::size_t>(c)].imag();
      }
      one[2 * i] = weight;
    }
    const Eigen::VectorXd x = columns.colPivHouseholderQr().solve(one);
    MotorModel model{.inertia_kgm2 = x[0], .viscous_nms = x[1], .stiffness_nm = x[2], .delay_s = delay_s};
    model.share_left = (columns * x - one).norm() / one.norm();
    if (unknowns == 4) {
      model.joint_inertia_kgm2 = x[3];
      model.joint_hz = joint_hz;
      model.joint_damping = damping;
    }
    return model;
  }

 private:
  std::vector<ResponsePoint> points_;
};

auto motor_alone(const LeastSquares& squares) -> MotorModel {
  MotorModel best;
  best.share_left = 1e9;
  for (double delay = 0.0; delay < kLongestDelayS; delay += kDelayStepS) {
    if (const MotorModel model = squares.solve(delay); model.share_left < best.share_left) {
      best = model;
    }
  }
  double furthest = std::pow(10.0, kResonanceDb / 20.0);
  for (const ResponsePoint& point : squares.points()) {
    const double above = (std::abs(point.motor.value) - point.motor.radius95) / std::abs(best.at(point.hz));
    if (above > furthest) {
      furthest = above;
      best.resonance_hz = point.hz;
    }
  }
  return best;
}

}  // namespace

auto MotorModel::at(double hz) const -> Complex {
  const double w = 2.0 * kPi * hz;
  const Complex joint =
      joint_inertia_kgm2 > 0.0 ? joint_inertia_kgm2 * joint_part(w, joint_hz, joint_damping) : Complex{};
  return std::polar(1.0, -w * delay_s) / (Complex(stiffness_nm - inertia_kgm2 * w * w, viscous_nms * w) + joint);
}

auto fit_motor(const Response& response) -> MotorModel {
  return motor_alone(LeastSquares(response));
}

auto fit_motor_and_joint(const Response& response) -> MotorModel {
  const LeastSquares squares(response);
  const MotorModel alone = motor_alone(squares);
  MotorModel best = alone;
  const auto try_one = [&](double delay, double hz, double damping) {
    const MotorModel model = squares.solve(delay, hz, damping);
    if (model.share_left < best.share_left && model.joint_inertia_kgm2 > 0.0 && model.inertia_kgm2 > 0.0) {
      best = model;
    }
  };
  for (double delay = 0.0; delay < kLongestDelayS; delay += kCoarseDelayStepS) {
    for (double hz = squares.points().front().hz; hz < squares.points().back().hz; hz *= kJointStep) {
      for (const double damping : kJointDampings) {
        try_one(delay, hz, damping);
      }
    }
  }
  if (best.joint_hz == 0.0 || best.share_left > kJointIsWorth * alone.share_left) {
    return alone;
  }
  for (double step = 0.5, i = 0; i < kRefinements; ++i, step *= 0.5) {
    const MotorModel from = best;
    for (const double later : {-step, 0.0, step}) {
      for (const double higher : {-step, 0.0, step}) {
        for (const double wider : {-step, 0.0, step}) {
          try_one(std::max(0.0, from.delay_s + later * kCoarseDelayStepS), from.joint_hz * std::pow(kJointStep, higher),
                  from.joint_damping * std::exp(wider));
        }
      }
    }
  }
  best.resonance_hz = alone.resonance_hz;
  return best;
}

}  // namespace capstan::tools
