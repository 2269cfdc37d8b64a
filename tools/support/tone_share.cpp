// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/tone_share.hpp"

#include <algorithm>
#include <complex>
#include <numbers>

namespace capstan::tools {
namespace {

constexpr double kPieceS = 15.0;
constexpr double kLowestHz = 0.3;
constexpr double kHighestHz = 25.0;
constexpr double kStepHz = 0.2 / kPieceS;  // so fine that a tone between two steps loses 3 % of its energy at most
constexpr Eigen::Index kFewest = 8;        // values of a piece: fewer are explained by any tone

}  // namespace

auto tone_share(const Eigen::VectorXd& time_s, const Eigen::VectorXd& signal) -> double {
  const auto steps = static_cast<Eigen::Index>((kHighestHz - kLowestHz) / kStepHz);
  Eigen::ArrayXd explained = Eigen::ArrayXd::Zero(steps);
  double energy = 0.0;
  for (Eigen::Index begin = 0; begin < signal.size();) {
    Eigen::Index end = begin;
    while (end < signal.size() && time_s[end] < time_s[begin] + kPieceS) {
      ++end;
    }
    const Eigen::Index rows = end - begin;
    const Eigen::ArrayXd values = signal.segment(begin, rows).array() - signal.segment(begin, rows).mean();
    energy += values.square().sum();
    // A phasor of each value, turned on by one step of frequency at a time: the periodogram of uneven times.
    const Eigen::ArrayXd turn = 2.0 * std::numbers::pi * time_s.segment(begin, rows).array();
    Eigen::ArrayXcd phasor(rows), step(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      phasor[i] = std::polar(1.0, kLowestHz * turn[i]);
      step[i] = std::polar(1.0, kStepHz * turn[i]);
    }
    for (Eigen::Index k = 0; rows >= kFewest && k < steps; ++k) {
      explained[k] += 2.0 / static_cast<double>(rows) * std::norm((phasor * values).sum());
      phasor *= step;
    }
    begin = end;
  }
  return energy > 0.0 ? std::min(1.0, explained.maxCoeff() / energy) : 0.0;
}

}  // namespace capstan::tools
