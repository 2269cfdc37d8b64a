// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/load_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {
namespace {

/// Both tendons sliding under a load L of the joint, by the motor's torque (2.16), (2.18), (5.35): while both are taut
/// the load comes through one to one beside their friction f, beyond that one is slack and the other passes it on by
/// e^eta against the motion, by e^-eta with it.
///   tau = s max(s L + f, s L e^(+-eta)),  + where the load is against the motion
struct Carried {
  double load = 0.0;       ///< L per regressor
  double eta = 0.0;        ///< of both tendons
  double elsewhere = 0.0;  ///< friction that is not the tendons', Nm

  /// What the load changes of the torque. @param friction  of all, without load
  [[nodiscard]] auto torque(double regressor, double sense, double friction) const -> double {
    const double against = sense * load * regressor;
    const double tendons = friction - elsewhere;
    const double slack = against * std::exp(against > 0.0 ? eta : -eta);
    return sense * (std::max(against + tendons, slack) - tendons);
  }
};

/// What a change of torque may have beside its cause: a constant, and perhaps another friction.
class Beside {
 public:
  explicit Beside(Eigen::MatrixXd columns)
      : columns_(std::move(columns)), inverse_((columns_.transpose() * columns_).inverse()) {}

  [[nodiscard]] auto columns() const -> const Eigen::MatrixXd& { return columns_; }
  /// Squares that are left of a signal.
  [[nodiscard]] auto left(const Eigen::VectorXd& signal) const -> double {
    const Eigen::VectorXd part = columns_.transpose() * signal;
    return signal.squaredNorm() - part.dot(inverse_ * part);
  }

 private:
  Eigen::MatrixXd columns_, inverse_;
};

/// The load that explains a change of torque, of one regressor.
class LoadFit {
 public:
  LoadFit(const LoadRows& of, double friction)
      : of_(of),
        x_(of.regressor),
        s_(of.sense),
        change_(of.change),
        friction_(friction),
        beside_(of.other_friction ? with_offset(s_) : Eigen::MatrixXd::Ones(s_.size(), 1)) {}

  void run(double start) {
    for (const double eta : {0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5}) {
      for (const double share : {0.0, 0.15, 0.3, 0.5}) {
        try_one(start, eta, share);
      }
    }
  }
  /// A lean with which clearly less is left than without one; else 0.
  auto find_lean(double start) -> double {
    constexpr double kLargest = 1.0;  // 45 degrees
    constexpr int kSteps = 20;
    std::pair<double, double> best;
    double upright = 0.0;
    for (int i = -kSteps; i <= kSteps; ++i) {
      const double lean = kLargest * i / kSteps;
      hang(lean);
      left_ = std::numeric_limits<double>::infinity();
      for (const double eta : {0.2, 0.45, 0.8, 1.25, 2.0}) {
        try_one(start, eta, 0.15);
      }
      upright = i == 0 ? left_ : upright;
      if (i == -kSteps || left_ < best.second) {
        best = {lean, left_};
      }
    }
    left_ = std::numeric_limits<double>::infinity();
    const double lean = best.second < kLeanLeaves * upright ? best.first : 0.0;
    hang(lean);
    return lean;
  }
  [[nodiscard]] auto left() const -> double { return left_; }
  [[nodiscard]] auto best() const -> const Carried& { return best_; }
  /// Half width of the load's interval, eta and the other friction free.
  [[nodiscard]] auto half_95() const -> double {
    Eigen::MatrixXd slopes(x_.size(), leans_ ? 4 : 3);
    if (leans_) {
      constexpr double kStep = 1e-3;
      LoadFit more = *this;
      more.hang(lean_ + kStep);
      slopes.col(3) = (more.told(best_) - told(best_)) / kStep;
    }
    for (Eigen::Index k = 0; k < 3; ++k) {
      double Carried::*const part[] = {&Carried::load, &Carried::eta, &Carried::elsewhere};
      Carried more = best_;
      const double step = 1e-3 * std::max(std::abs(best_.*part[k]), 1e-2 * (k == 1 ? 1.0 : friction_));
      more.*part[k] += step;
      slopes.col(k) = (told(more) - told(best_)) / step;
    }
    Eigen::MatrixXd columns(x_.size(), slopes.cols() + beside_.columns().cols());
    columns << slopes, beside_.columns();
    return half_interval(fitted(columns, change_ - told(best_)), 0);
  }

 private:
  void hang(double lean) {
    lean_ = lean;
    leans_ = lean != 0.0;
    x_ = of_.regressor;
    if (leans_) {
      x_ += lean * of_.lean;
    }
  }
  void try_one(double start, double eta, double share) {
    Carried trial{0.0, eta, share * friction_};
    settle(start, trial);
  }
  [[nodiscard]] auto told(const Carried& by) const -> Eigen::VectorXd {
    Eigen::VectorXd torque(x_.size());
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      torque[i] = by.torque(x_[i], s_[i], friction_);
    }
    return torque;
  }
  /// Golden section over the load, from a tenth to twice what it would be were all of it to come through one to one.
  void settle(double start, Carried& trial) {
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kHalvings = 16;
    const auto left = [&](double load) {
      trial.load = load;
      return beside_.left(change_ - told(trial));
    };
    double low = 0.1 * start;
    double high = 2.0 * start;
    for (int i = 0; i < kHalvings; ++i) {
      const double inner[2] = {high - kGolden * (high - low), low + kGolden * (high - low)};
      (left(inner[0]) < left(inner[1]) ? high : low) = left(inner[0]) < left(inner[1]) ? inner[1] : inner[0];
    }
    if (const double rest = left(0.5 * (low + high)); rest < left_) {
      left_ = rest;
      best_ = trial;
    }
  }

  LoadRows of_;
  Eigen::VectorXd x_, s_, change_;
  double friction_;
  double lean_ = 0.0;
  bool leans_ = false;
  Beside beside_;
  double left_ = std::numeric_limits<double>::infinity();
  Carried best_;
};

/// A load pulls at one tendon where its regressor is positive and at the other where it is negative, and the one that
/// takes most of it has a friction and a stiffness of its own: half of what two answers, of either alone, are apart.
auto between_tendons(const LoadRows& of, double friction, double start) -> double {
  std::array<double, 2> load{};
  for (const bool positive : {false, true}) {
    std::vector<Eigen::Index> here;
    for (Eigen::Index i = 0; i < of.regressor.size(); ++i) {
      if ((of.regressor[i] > 0.0) == positive) {
        here.push_back(i);
      }
    }
    if (static_cast<Eigen::Index>(here.size()) < kLoadBlocks) {
      return 0.0;
    }
    LoadFit fit({of.regressor(here), of.sense(here), of.change(here), of.other_friction}, friction);
    fit.run(start);
    load[positive] = fit.best().load;
  }
  return 0.5 * std::abs(load[1] - load[0]);
}

}  // namespace

auto fitted(const Eigen::MatrixXd& columns, const Eigen::VectorXd& torque) -> LinearFit {
  const std::vector<Sign> signs(static_cast<std::size_t>(columns.cols()), Sign::kAny);
  return fit_columns(columns, torque, even_parts({{0, columns.rows()}}, kLoadBlocks), signs);
}

auto with_offset(const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
  Eigen::MatrixXd all(columns.rows(), columns.cols() + 1);
  all << columns, Eigen::VectorXd::Ones(columns.rows());
  return all;
}

auto told_load(LoadRows of, double friction, double start) -> LoadAnswer {
  LoadFit fit(of, friction);
  const double lean = of.lean.size() > 0 ? fit.find_lean(start) : 0.0;
  if (lean != 0.0) {
    of.regressor += lean * of.lean;
  }
  fit.run(start);
  const double load = fit.best().load;
  const double leaning = lean != 0.0 ? kLeaningKnown * load : 0.0;
  return {load, std::hypot(fit.half_95(), between_tendons(of, friction, load), leaning)};
}

}  // namespace capstan::tools
