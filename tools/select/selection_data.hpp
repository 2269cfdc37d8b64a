// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "capstan/tools/diagnose/preparation.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/select/law_candidate.hpp"

namespace capstan::tools {

/// How far the signals of the logs go: shapes that are tried are shares of these, so nothing depends on a unit.
struct SignalRanges {
  double q1 = 0.0, tau = 0.0;  ///< largest less smallest
  double q1_centre = 0.0, tau_centre = 0.0;
  double rate = 0.0, rate_centre = 0.0;   ///< of the motor, but for a few rows at each end
  double since_s = 0.0, travelled = 0.0;  ///< time and way since a reversal that few rows exceed
  double warmth = 0.0, warmth_centre = 0.0;
  std::vector<double> others, others_centre;  ///< of the other joints' motor angles, by slot
  double length_s = 0.0, period_s = 0.0;      ///< of all logs, of a sample
};

/// The logs as the choice of a law sees them: columns of the causal law, as the firmware will run it, on the coarse
/// grid. A column is worked out when it is first asked for and kept.
class SelectionData {
 public:
  /// `q2`: the joint angle that a running law knows, every sample, as some law estimates it: the measured one would
  /// tell a law what it is to predict. Empty: no term of the laws reads it. @pre p outlives it
  SelectionData(const Preparation& p, const Catalogue& catalogue, const DecidingNumbers& numbers = {},
                const Eigen::VectorXd& q2 = {});

  [[nodiscard]] auto catalogue() const -> const Catalogue& { return *catalogue_; }
  [[nodiscard]] auto numbers() const -> const DecidingNumbers& { return numbers_; }
  [[nodiscard]] auto ranges() const -> const SignalRanges& { return ranges_; }
  [[nodiscard]] auto target() const -> const Eigen::VectorXd& { return target_; }
  [[nodiscard]] auto rows() const -> Eigen::Index { return target_.size(); }
  [[nodiscard]] auto q1() const -> const Eigen::VectorXd& { return q1_; }
  /// Coarse rows of each log.
  [[nodiscard]] auto logs() const -> const Blocks& { return logs_; }
  /// The same without those before the motor has first covered most of its range: what the joint did there hangs on a
  /// past that was not logged. Logs of a cycle or so can not spare them; there plays begin where the log says that they
  /// began.
  [[nodiscard]] auto settled() const -> const Blocks& { return settled_; }
  /// Half widths of plays that the motion carries both ways, ascending.
  [[nodiscard]] auto play_widths() const -> const std::vector<double>& { return widths_; }

  /// Coarse columns of a term of the sum, passed through an output term if there is one.
  auto columns(const TermChoice& choice, const TermChoice* output) -> const Eigen::MatrixXd&;
  /// Coarse columns of a term without memory at given motor angles behind the input stage.
  auto columns_at(const TermChoice& choice, const Eigen::VectorXd& h) -> Eigen::MatrixXd;

 private:
  void measure_ranges();
  void measure_motion();
  void settle();
  void find_widths();
  [[nodiscard]] auto lead_of_plays(double half_width) const -> Eigen::VectorXd;

  const Preparation& p_;
  LawDesign causal_;
  const Catalogue* catalogue_;
  DecidingNumbers numbers_;
  SignalRanges ranges_;
  Eigen::VectorXd target_, q1_;
  Samples coarse_;  ///< h is as columns_at() was last asked for
  Blocks logs_, settled_;
  std::vector<double> starts_;  ///< of the plays in each log, shares of their half widths; empty: in the middle
  std::vector<double> widths_;
  std::map<std::string, Eigen::MatrixXd> kept_;
};

}  // namespace capstan::tools
