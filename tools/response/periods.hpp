// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "capstan/tools/response/response.hpp"

namespace capstan::tools {

enum Signal : std::size_t { kShaken, kTorque, kMotor, kJoint, kSignals };
/// One window, or one bin: the spectra of all signals at one frequency.
using Spectra = std::array<Complex, kSignals>;
using Signals = std::array<const Eigen::VectorXd*, kSignals>;

/// Windows of one period of the board's multisine each, in which the joint goes one way or stands.
class Periods {
 public:
  explicit Periods(const ResponseLog& log, bool on_torque);
  [[nodiscard]] auto count() const -> std::size_t { return starts_.size(); }
  [[nodiscard]] auto travels() const -> bool { return travels_; }
  /// Those windows alone in which the motor goes that way.
  [[nodiscard]] auto going(bool forward) const -> Periods;

  /// Spectra of each window at one harmonic, less the ramps that find_slopes found. @param is_line  it is one that
  /// shakes
  [[nodiscard]] auto at(std::size_t harmonic, const Signals& signals, bool is_line = false) const
      -> std::vector<Spectra>;
  /// Of the first window alone: what shakes has no noise.
  [[nodiscard]] auto shaken_power(std::size_t harmonic, const Eigen::VectorXd& shaken) const -> double;
  /// Over the windows in which the motor goes that way.
  [[nodiscard]] auto mean_torque(bool forward) const -> double;
  [[nodiscard]] auto mean_speed() const -> double;

  /// A joint that travels adds a ramp: its slope beside the lines that shake, by least squares. A period of rows has
  /// every phase once, so lines are orthogonal to each other and to a constant, and only the ramp is not.
  void find_slopes(const std::vector<std::size_t>& lines, const Signals& signals);

 private:
  /// As many as there is room for, as late as can be: what a turn left has died away most then.
  void fill(Eigen::Index from, Eigen::Index end);
  void find(bool on_torque);
  /// Of the motor in a window, rad.
  [[nodiscard]] auto way(Eigen::Index start) const -> double;
  /// Mean of a period of x[i] exp(-j w tick[i]), each times its weight, twice.
  [[nodiscard]] auto spectrum_at(const Eigen::VectorXd& x, Eigen::Index from, const Eigen::VectorXd& weights,
                                 std::size_t harmonic) const -> Complex;

  const ResponseLog& log_;
  std::vector<Complex> table_;
  std::vector<int> phases_;
  std::vector<Eigen::Index> starts_;
  std::vector<std::array<double, kSignals>> slopes_;
  Eigen::VectorXd ramp_;
  Eigen::VectorXd flat_, von_hann_;
  int step_ms_ = 1;
  bool travels_ = false;
};

}  // namespace capstan::tools
