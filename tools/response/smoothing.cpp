// SPDX-License-Identifier: Apache-2.0
// Lines of a response weighed against the model behind it (Gaussian process regression; Rasmussen and Williams, 2006,
// chapters 2 and 5).
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {
namespace {

constexpr double kLeastNoise = 1e-6;  // relative power: no line is known to better than a thousandth
// What may be, all as likely before a line is looked at: how far the model is wrong (rms, relative), over how many
// octaves that changes, and what differs from line to line beyond noise (rms, relative).
constexpr std::array<double, 6> kWrong = {0.02, 0.04, 0.08, 0.16, 0.32, 0.64};
constexpr std::array<double, 3> kOctaves = {0.35, 0.7, 1.4};
constexpr std::array<double, 6> kScatter = {0.0, 0.01, 0.03, 0.06, 0.12, 0.24};

constexpr double kLeastWeight = 1e-3;  // of what is most likely; less is left out

// Numbers of the model; as many take their share of the noise, two to a line, with them into it.
constexpr double kNumbers = 5.0, kJointNumbers = 4.0;

using Prior = Smoothing::Prior;

/// Covariance of the smooth rest there with that at the lines.
auto alike(double octave, const Eigen::VectorXd& octaves, const Prior& prior) -> Eigen::VectorXd {
  return prior.wrong * prior.wrong * (-0.5 * ((octaves.array() - octave) / prior.octaves).square()).exp();
}

auto octaves_of(const std::vector<ResponsePoint>& points) -> Eigen::VectorXd {
  Eigen::VectorXd octaves(static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < octaves.size(); ++i) {
    octaves[i] = std::log2(points[static_cast<std::size_t>(i)].hz);
  }
  return octaves;
}

/// Covariance of the lines, factored.
auto factored(const Eigen::VectorXd& octaves, const Eigen::VectorXd& noise, const Prior& prior)
    -> Eigen::LLT<Eigen::MatrixXd> {
  Eigen::MatrixXd all(octaves.size(), octaves.size());
  for (Eigen::Index i = 0; i < octaves.size(); ++i) {
    all.col(i) = alike(octaves[i], octaves, prior);
  }
  all.diagonal().array() += noise.array() + prior.scatter * prior.scatter;
  return all.llt();
}

}  // namespace

Smoothing::Smoothing(const std::vector<ResponsePoint>& points, const MotorModel& model)
    : model_(model), octaves_(octaves_of(points)), noise_(octaves_.size()) {
  Eigen::VectorXd real(octaves_.size());
  Eigen::VectorXd imag(octaves_.size());
  for (Eigen::Index i = 0; i < octaves_.size(); ++i) {
    const ResponsePoint& point = points[static_cast<std::size_t>(i)];
    const Complex expected = model.at(point.hz);
    const Complex rest = point.motor.value / expected - 1.0;
    real[i] = rest.real();
    imag[i] = rest.imag();
    noise_[i] = kLeastNoise + kNoiseShare * std::norm(point.motor.radius95 / expected);
  }
  double highest = -std::numeric_limits<double>::infinity();
  for (const double octaves : kOctaves) {
    for (const double wrong : kWrong) {
      for (const double scatter : kScatter) {
        Tried one{.prior = {wrong, octaves, scatter}};
        one.factor = factored(octaves_, noise_, one.prior);
        one.real = one.factor.solve(real);
        one.imag = one.factor.solve(imag);
        // Logarithm of the likelihood of circular complex values, less a constant.
        one.weight =
            -2.0 * one.factor.matrixLLT().diagonal().array().log().sum() - real.dot(one.real) - imag.dot(one.imag);
        highest = std::max(highest, one.weight);
        tried_.push_back(std::move(one));
      }
    }
  }
  for (Tried& one : tried_) {
    one.weight = std::exp(one.weight - highest);
  }
  std::erase_if(tried_, [](const Tried& one) { return one.weight < kLeastWeight; });
  double all = 0.0;
  for (const Tried& one : tried_) {
    all += one.weight;
  }
  for (Tried& one : tried_) {
    one.weight /= all;
  }
}

auto Smoothing::at(double hz) const -> Estimate {
  const double octave = std::log2(hz);
  Complex rest{};
  double square = 0.0;
  for (const Tried& one : tried_) {
    const Eigen::VectorXd near = alike(octave, octaves_, one.prior);
    const Complex here(near.dot(one.real), near.dot(one.imag));
    const double off = one.prior.wrong * one.prior.wrong - near.dot(one.factor.solve(near));
    rest += one.weight * here;
    square += one.weight * (std::max(0.0, off) + std::norm(here));
  }
  Eigen::Index nearest = 0;
  (octaves_.array() - octave).abs().minCoeff(&nearest);
  const double numbers = model_.joint_inertia_kgm2 > 0.0 ? kNumbers + kJointNumbers : kNumbers;
  const double fitted = noise_[nearest] * std::min(1.0, numbers / (2.0 * static_cast<double>(octaves_.size())));
  const Complex expected = model_.at(hz);
  return {.value = expected * (1.0 + rest),
          .radius95 = std::abs(expected) * std::sqrt((std::max(0.0, square - std::norm(rest)) + fitted) / kNoiseShare)};
}

}  // namespace capstan::tools
