// SPDX-License-Identifier: Apache-2.0
// The plant behind a response as a motor with its delay, and a joint that swings on its tendons.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/tools/identify/bounded_search.hpp"
#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {
namespace {

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33, those
// of the joint on robot fingers 910 to 915, that of its drag on RAVEN's elbows 1150 to 1154.
constexpr double kResonanceDb = 6.0;  // above the model of motor and delay
constexpr double kLongestDelayS = 0.01, kDelayStepS = 5e-4, kFineDelayStepS = 2e-5;
constexpr std::array<double, 3> kLagsS = {0.0, 5e-4, 1e-3};  // of the amplifier
constexpr double kLagStepS = 5e-4;
constexpr double kJointStep = 1.05;  // from one frequency that is tried to the next
constexpr std::array<double, 5> kJointDampings = {0.01, 0.03, 0.07, 0.15, 0.3};
constexpr std::array<double, 3> kJointDrags = {0.0, 0.05, 0.15};
constexpr double kDragStep = 0.1;
constexpr double kJointIsWorth = 0.7;  // of what is left without it
constexpr int kRefinements = 7;
constexpr double kModelShare = 0.02;  // of a line, that no model explains
constexpr double kMeasureHz = 10.0;   // where a step of viscous friction and stiffness is one of the inertia's torque

/// A joint on its tendons.
struct Joint {
  double hz = 0.0;  ///< 0: none
  double damping = 0.0, drag = 0.0;
};

/// What the model is not linear in.
struct Shape {
  double delay_s = 0.0, lag_s = 0.0;
  Joint joint = {};
};

/// m's factor in the dynamic stiffness: what binds the joint to the motor, in series with its inertia and drag.
auto joint_part(double w, const Joint& joint) -> Complex {
  const double own = 2.0 * std::numbers::pi * joint.hz;
  const Complex bound(own * own, 2.0 * joint.damping * own * w);
  const Complex moved(-w * w, 2.0 * joint.drag * own * w);
  return bound * moved / (bound + moved);
}

/// The board holds its torque for a cycle, and a step of that length has so much of a sine; its half a cycle of delay
/// is in the delay.
auto held(double hz, double hold_s) -> double {
  const double half = std::numbers::pi * hz * hold_s;
  return half > 0.0 ? std::sin(half) / half : 1.0;
}

/// 1 / G = (k - J w2 + j w b + m ...) exp(j w T) (1 + j w l) / held: linear but for the shape, which is looked for.
class LeastSquares {
 public:
  LeastSquares(const Response& response, double hold_s) : points_(clear_points(response)), hold_s_(hold_s) {}
  [[nodiscard]] auto points() const -> const std::vector<ResponsePoint>& { return points_; }

  [[nodiscard]] auto solve(const Shape& shape) const -> MotorModel {
    const auto rows = static_cast<Eigen::Index>(points_.size());
    const Eigen::Index unknowns = shape.joint.hz > 0.0 ? 4 : 3;
    Eigen::MatrixXd columns(2 * rows, unknowns);
    Eigen::VectorXd one = Eigen::VectorXd::Zero(2 * rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const ResponsePoint& point = points_[static_cast<std::size_t>(i)];
      const double w = 2.0 * std::numbers::pi * point.hz;
      const Complex turned = point.motor.value * std::polar(1.0, w * shape.delay_s) * Complex(1.0, w * shape.lag_s) /
                             held(point.hz, hold_s_);
      const double weight = 1.0 / (kModelShare + point.motor.radius95 / std::abs(point.motor.value));
      const std::array<Complex, 4> parts = {-w * w * turned, Complex(0.0, w) * turned, turned,
                                            unknowns == 4 ? turned * joint_part(w, shape.joint) : Complex{}};
      for (Eigen::Index c = 0; c < unknowns; ++c) {
        columns(2 * i, c) = weight * parts[static_cast<std::size_t>(c)].real();
        columns(2 * i + 1, c) = weight * parts[static_cast<std::size_t>(c)].imag();
      }
      one[2 * i] = weight;
    }
    const Eigen::VectorXd x = columns.colPivHouseholderQr().solve(one);
    MotorModel model{.inertia_kgm2 = x[0],
                     .viscous_nms = x[1],
                     .stiffness_nm = x[2],
                     .delay_s = shape.delay_s,
                     .lag_s = shape.lag_s,
                     .joint_inertia_kgm2 = unknowns == 4 ? x[3] : 0.0,
                     .joint_hz = shape.joint.hz,
                     .joint_damping = shape.joint.damping,
                     .joint_drag = shape.joint.drag,
                     .hold_s = hold_s_};
    model.share_left = (columns * x - one).norm() / one.norm();
    return model;
  }

 private:
  std::vector<ResponsePoint> points_;
  double hold_s_;
};

/// The best of those that were tried.
class Best {
 public:
  explicit Best(const LeastSquares& squares) : squares_(squares) { model_.share_left = 1e9; }
  [[nodiscard]] auto model() const -> const MotorModel& { return model_; }

  void try_one(const Shape& shape) {
    const MotorModel model = squares_.solve(shape);
    const bool possible = shape.joint.hz == 0.0 || (model.joint_inertia_kgm2 > 0.0 && model.inertia_kgm2 > 0.0);
    if (model.share_left < model_.share_left && possible) {
      model_ = model;
    }
  }

  /// About the best, ever closer.
  void refine() {
    double step = 0.5;
    for (int i = 0; i < kRefinements; ++i, step *= 0.5) {
      const MotorModel from = model_;
      for (const double later : {-step, 0.0, step}) {
        for (const double slower : {-step, 0.0, step}) {
          const Shape shape{
              std::max(0.0, from.delay_s + later * kDelayStepS), std::max(0.0, from.lag_s + slower * kLagStepS), {}};
          refine_joint(from, shape, step);
        }
      }
    }
  }

 private:
  void refine_joint(const MotorModel& from, Shape shape, double step) {
    if (from.joint_hz == 0.0) {
      try_one(shape);
      return;
    }
    for (const double higher : {-step, 0.0, step}) {
      for (const double wider : {-step, 0.0, step}) {
        for (const double more : {-step, 0.0, step}) {
          shape.joint = {from.joint_hz * std::pow(kJointStep, higher), from.joint_damping * std::exp(wider),
                         std::max(0.0, from.joint_drag + more * kDragStep)};
          try_one(shape);
        }
      }
    }
  }

  const LeastSquares& squares_;
  MotorModel model_;
};

auto motor_alone(const LeastSquares& squares, bool with_lag) -> MotorModel {
  Best best(squares);
  // Without a lag a held motor's answer has several good delays, so none is passed over.
  for (double delay = 0.0; delay < kLongestDelayS; delay += with_lag ? kDelayStepS : kFineDelayStepS) {
    for (const double lag : kLagsS) {
      if (lag == 0.0 || with_lag) {
        best.try_one({delay, lag, {}});
      }
    }
  }
  if (with_lag) {
    best.refine();
  }
  MotorModel model = best.model();
  double furthest = std::pow(10.0, kResonanceDb / 20.0);
  for (const ResponsePoint& point : squares.points()) {
    const double above = (std::abs(point.motor.value) - point.motor.radius95) / std::abs(model.at(point.hz));
    if (above > furthest) {
      furthest = above;
      model.resonance_hz = point.hz;
    }
  }
  return model;
}

/// What noise has in a line pulls least squares over 1 / G towards less inertia and lag. So they end on G itself, each
/// line over its circle, from where those over 1 / G ended, in all numbers of the model: each is moved from there by a
/// measure of its own.
class OverCircles final : public SteppedResidual {
 public:
  OverCircles(const Response& response, MotorModel from)
      : points_(points_above_noise(response, from)),
        from_(std::move(from)),
        with_joint_(from_.joint_inertia_kgm2 > 0.0) {}

  [[nodiscard]] auto refined() -> MotorModel {
    constexpr double kFarthest = 10.0;
    const Eigen::Index count = with_joint_ ? kAll : kMotor;
    SearchBounds bounds{Eigen::VectorXd::Constant(count, -kFarthest), Eigen::VectorXd::Constant(count, kFarthest)};
    bounds.lower[kDelay] = -from_.delay_s / kTimeS;
    bounds.lower[kLag] = -from_.lag_s / kTimeS;
    if (with_joint_) {
      bounds.lower[kJointDrag] = -from_.joint_drag;
    }
    return at_moved(least_squares_within(bounds, Eigen::VectorXd::Zero(count), *this).parameters);
  }

 private:
  enum Number : Eigen::Index {
    kInertia,
    kViscous,
    kStiffness,
    kDelay,
    kLag,
    kMotor,  // so many without a joint
    kJointInertia = kMotor,
    kJointHz,
    kJointDamping,
    kJointDrag,
    kAll
  };
  static constexpr double kTimeS = 1e-3;

  [[nodiscard]] auto at_moved(const Eigen::VectorXd& moved) const -> MotorModel {
    const double rate = 2.0 * std::numbers::pi * kMeasureHz;
    MotorModel model = from_;
    model.inertia_kgm2 *= std::exp(moved[kInertia]);
    model.viscous_nms += from_.inertia_kgm2 * rate * moved[kViscous];
    model.stiffness_nm += from_.inertia_kgm2 * rate * rate * moved[kStiffness];
    model.delay_s += kTimeS * moved[kDelay];
    model.lag_s += kTimeS * moved[kLag];
    if (with_joint_) {
      model.joint_inertia_kgm2 *= std::exp(moved[kJointInertia]);
      model.joint_hz *= std::exp(moved[kJointHz]);
      model.joint_damping *= std::exp(moved[kJointDamping]);
      model.joint_drag += moved[kJointDrag];
    }
    return model;
  }
  auto left_of(const Eigen::VectorXd& moved) -> Eigen::VectorXd override {
    const MotorModel model = at_moved(moved);
    Eigen::VectorXd off(2 * static_cast<Eigen::Index>(points_.size()));
    Eigen::Index i = 0;
    for (const ResponsePoint& point : points_) {
      const Complex apart = (point.motor.value - model.at(point.hz)) /
                            (kModelShare * std::abs(from_.at(point.hz)) + point.motor.radius95);
      off[i++] = apart.real();
      off[i++] = apart.imag();
    }
    return off;
  }

  std::vector<ResponsePoint> points_;
  MotorModel from_;
  bool with_joint_;
};

}  // namespace

auto MotorModel::at(double hz) const -> Complex {
  const double w = 2.0 * std::numbers::pi * hz;
  const Complex joint =
      joint_inertia_kgm2 > 0.0 ? joint_inertia_kgm2 * joint_part(w, {joint_hz, joint_damping, joint_drag}) : Complex{};
  return std::polar(held(hz, hold_s), -w * delay_s) / Complex(1.0, w * lag_s) /
         (Complex(stiffness_nm - inertia_kgm2 * w * w, viscous_nms * w) + joint);
}

auto fit_motor(const Response& response, bool with_lag) -> MotorModel {
  return motor_alone(LeastSquares(response, with_lag ? kCycleS : 0.0), with_lag);
}

auto fit_motor_and_joint(const Response& response) -> MotorModel {
  const LeastSquares squares(response, kCycleS);
  const MotorModel alone = motor_alone(squares, true);
  Best best(squares);
  for (double delay = 0.0; delay < kLongestDelayS; delay += kDelayStepS) {
    for (double hz = squares.points().front().hz; hz < squares.points().back().hz; hz *= kJointStep) {
      for (const double damping : kJointDampings) {
        for (const double drag : kJointDrags) {
          best.try_one({delay, 0.0, {hz, damping, drag}});
        }
      }
    }
  }
  best.refine();
  MotorModel model = best.model();
  if (model.share_left > kJointIsWorth * alone.share_left) {
    return OverCircles(response, alone).refined();
  }
  model.resonance_hz = alone.resonance_hz;
  return OverCircles(response, model).refined();
}

}  // namespace capstan::tools
