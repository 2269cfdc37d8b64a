// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// Cubic through the 2 h + 1 samples around each, by least squares (Savitzky and Golay): its value, slope or curvature
/// there. At the ends it is the cubic of the first or last window. @pre at least 2 h + 1 samples, h > 1
class LocalCubic {
 public:
  explicit LocalCubic(Eigen::Index half_width);
  /// Derivative of order 0 to 2 per sample, at every `step`-th sample.
  [[nodiscard]] auto derivative(const Eigen::VectorXd& signal, int order, Eigen::Index step = 1) const
      -> Eigen::VectorXd;

 private:
  Eigen::Index half_;
  Eigen::MatrixXd from_window_;  ///< coefficients of the cubic from a window
};

/// How an effort's logs are looked at; part of its law.
struct EffortView {
  double window_s = 0.0;      ///< of the local cubic that motion is taken from
  bool averaged = false;      ///< whether law and effort are seen through the same cubic
  double standstill = 0.0;    ///< speed below which the direction stays what it was, unit of the motion per second
  double letting_go_s = 0.0;  ///< time constant with which dry friction lets go at a standstill; 0: it holds
  double skew_s = 0.0;        ///< how much later than logged the motor's torque acts; negative: its channel is late
};

/// An axis beside the one that a law is for.
struct KnownAxis {
  int axis = 0;
  bool linear = false;
  double range = 0.0;  ///< how far it moves over all logs, rad or m
};

/// Axes beside the one of these logs whose angles all of them have, and that move in one at least.
auto axes_beside(const std::vector<AxisLog>& logs) -> std::vector<KnownAxis>;

/// Logs of one axis as the terms of an effort's law see them, the motion being given; other axes beside it.
class EffortDesign {
 public:
  EffortDesign(const std::vector<AxisLog>& logs, const EffortView& view);

  [[nodiscard]] auto rows() const -> Eigen::Index { return rows_; }
  [[nodiscard]] auto samples() const -> const std::vector<Samples>& { return samples_; }
  /// Axes beside this one whose angle all logs have and that move in one of them.
  [[nodiscard]] auto others() const -> const std::vector<KnownAxis>& { return others_; }
  /// One column per coefficient of a term, seen as the effort is, every `step`-th sample of each log.
  [[nodiscard]] auto columns(const CatalogueTerm& term, const Shapes& shapes, Eigen::Index step = 1) const
      -> Eigen::MatrixXd;
  /// A signal of all logs, log by log, through a term that acts on it.
  [[nodiscard]] auto passed_through(const CatalogueTerm& term, const Shapes& shapes,
                                    const Eigen::VectorXd& signal) const -> Eigen::VectorXd;
  /// A signal of all logs as law and effort are compared: through the same cubic, where the view says so.
  [[nodiscard]] auto seen(const Eigen::VectorXd& signal, Eigen::Index step = 1) const -> Eigen::VectorXd;

 private:
  void add_other(const std::vector<AxisLog>& logs, int axis);

  EffortView view_;
  std::vector<Samples> samples_;
  std::vector<KnownAxis> others_;
  std::map<int, std::vector<Samples>> other_axes_;
  std::vector<double> periods_;
  Eigen::Index rows_ = 0;
};

/// The usual view of logs of an effort: the cubic's window, and as standstill 2 % of the speed that is exceeded in 1 %
/// of the samples.
auto usual_view(const std::vector<AxisLog>& logs) -> EffortView;

}  // namespace capstan::tools
