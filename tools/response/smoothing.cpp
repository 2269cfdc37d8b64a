// SPDX-License-Identifier: Apache-2.0
// Lines of a response weighed against the model behind it (Gaussian process regression; Rasmussen and Williams, 2006,
// chapters 2 and 5).
#include <array>
#include <cmath>

#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {
namespace {

// The mean square of what is within a circle of 95 %, of its radius's square; less where it is of few windows.
constexpr double kNoiseShare = 1.0 / 3.0;
constexpr double kLeastNoise = 1e-6;  // relative power: no line is known to better than a thousandth
// What the lines choose from: how far the model is wrong (rms, relative), over how many octaves that changes, and what
// differs from line to line beyond noise (rms, relative).
constexpr std::array<double, 8> kWrong = {0.003, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64};
constexpr std::array<double, 3> kOctaves = {0.35, 0.7, 1.4};
constexpr std::array<double, 6> kScatter = {0.0, 0.01, 0.03, 0.06, 0.12, 0.24};

using Prior = Smoothing::Prior;

/// Covariance of the smooth rest there with that at the lines.
auto alike(double octave, const Eigen::VectorXd& octaves, const Prior& prior) -> Eigen::VectorXd {
  return prior.wrong * prior.wrong *
         (-0.5 * ((octaves.array() - octave) / prior.octaves).square()).exp();
}

auto octaves_of(const std::vector<ResponsePoint>& points) -> Eigen::VectorXd {
  Eigen::VectorXd octaves(static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < octaves.size(); ++i) {
    octaves[i] = std::log2(points[static_cast<std::size_t>(i)].hz);
  }
  return octaves;
}

/// Covariance of the lines, factored.
class Factored {
 public:
  Factored(const Eigen::VectorXd& octaves, const Eigen::VectorXd& noise, const Prior& prior) {
    Eigen::MatrixXd all(octaves.size(), octaves.size());
    for (Eigen::Index i = 0; i < octaves.size(); ++i) {
      all.col(i) = alike(octaves[i], octaves, prior);
    }
    all.diagonal().array() += noise.array() + prior.scatter * prior.scatter;
    factor_ = all.llt();
  }
  [[nodiscard]] auto solve(const Eigen::VectorXd& x) const -> Eigen::VectorXd { return factor_.solve(x); }
  [[nodiscard]] auto solve(const Eigen::VectorXcd& x) const -> Eigen::VectorXcd {
    Eigen::VectorXcd solved(x.size());
    solved.real() = factor_.solve(x.real());
    solved.imag() = factor_.solve(x.imag());
    return solved;
  }
  [[nodiscard]] auto log_likelihood(const Eigen::VectorXcd& rest) const -> double {
    const Eigen::MatrixXd root = factor_.matrixL();
    return -2.0 * root.diagonal().array().log().sum() - rest.dot(solve(rest)).real();
  }

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace

Smoothing::Smoothing(const std::vector<ResponsePoint>& points, const MotorModel& model)
    : model_(model), octaves_(octaves_of(points)), noise_(octaves_.size()) {
  Eigen::VectorXcd rest(octaves_.size());
  for (Eigen::Index i = 0; i < rest.size(); ++i) {
    const ResponsePoint& point = points[static_cast<std::size_t>(i)];
    const Complex expected = model.at(point.hz);
    rest[i] = point.motor.value / expected - 1.0;
    noise_[i] = kLeastNoise + kNoiseShare * std::norm(point.motor.radius95 / expected);
  }
  double highest = -1e300;
  for (const double octaves : kOctaves) {
    for (const double wrong : kWrong) {
      for (const double scatter : kScatter) {
        const Prior prior{wrong, octaves, scatter};
        if (const double now = Factored(octaves_, noise_, prior).log_likelihood(rest); now > highest) {
          highest = now;
          prior_ = prior;
        }
      }
    }
  }
  weighed_ = Factored(octaves_, noise_, prior_).solve(rest);
}

auto Smoothing::at(double hz) const -> Estimate {
  const Eigen::VectorXd near = alike(std::log2(hz), octaves_, prior_);
  const Complex rest(near.dot(weighed_.real()), near.dot(weighed_.imag()));
  const double off = prior_.wrong * prior_.wrong - near.dot(Factored(octaves_, noise_, prior_).solve(near));
  const Complex expected = model_.at(hz);
  return {.value = expected * (1.0 + rest),
          .radius95 = std::abs(expected) * std::sqrt(std::max(0.0, off) / kNoiseShare)};
}

}  // namespace capstan::tools
