// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/response/tuning.hpp"

namespace capstan::tools {

/// Period of the control that is tuned: a torque is held for so long.
inline constexpr double kCycleS = 1e-3;

/// What control makes of an angle at one frequency.
struct Law {
  Complex servo;  // Nm per rad of the motor
  Complex joint;  // motor rad per joint rad
};
auto law_of(const LoopGains& gains, double hz) -> Law;

/// The motor's response as all lines together have it. Over the model (motor, joint, delay) it is 1 and a smooth rest,
/// by which the model is wrong there. How large that is, over how many octaves it changes, and what differs from line
/// to line beyond the circles (friction that turns its sign now and then repeats from period to period) is weighed by
/// how likely it makes the lines; with that each line is weighed against its neighbours and the model: where noise
/// hides it, it is the model's.
class Smoothing {
 public:
  /// @param points  at least one
  Smoothing(const std::vector<ResponsePoint>& points, const MotorModel& model);
  /// The circle holds what noise and the model's error leave open there.
  [[nodiscard]] auto at(double hz) const -> Estimate;

  /// What is known of the rest before a line is looked at: rms of the smooth part and of what differs from line to
  /// line, both relative, and how far the smooth part stays alike.
  struct Prior {
    double wrong = 0.0, octaves = 0.0, scatter = 0.0;
  };

 private:
  MotorModel model_;
  Eigen::VectorXd octaves_, noise_;
  struct Tried {
    Prior prior;
    Eigen::LLT<Eigen::MatrixXd> factor{};
    Eigen::VectorXd real{}, imag{};  // of the rest, weighed
    double weight = 0.0;
  };
  std::vector<Tried> tried_;
};

/// The response between its lines, weighed. The loop's is the motor's times what control made of the angle, which the
/// log has without noise.
struct Dense {
  MotorModel model;
  std::vector<double> hz;
  std::vector<Complex> motor, joint, loop;       // joint: per motor angle
  std::vector<Complex> drawn;                    // the loop through its lines as they are, for comparison
  std::vector<double> motor_share, joint_share;  // radii, relative
  std::vector<double> loop_radius, drawn_radius;
  double motor_speed_rad_s = 0.0;  // of the joint that travelled; 0: it stood
  double friction_nm = 0.0;        // then
};

/// Of the lines that rise clearly above noise. Throws Refusal where they are too few.
auto dense(const Response& response) -> Dense;
/// The loop that was measured.
auto measured_loop(const Dense& all) -> std::vector<LoopPoint>;
/// Those lines.
auto clear_points(const Response& response) -> std::vector<ResponsePoint>;
/// The lines whose circles are smaller than what the model expects there, whatever they show: of lines that are chosen
/// by what they show, noise leaves the larger ones.
auto points_above_noise(const Response& response, const MotorModel& model) -> std::vector<ResponsePoint>;
/// -1 where the joint turns against the motor: the transmission is crossed, and the firmware corrects that way round.
auto sense_of(const Dense& all) -> double;
/// Torque per motor angle by way of the joint loop, Nm/rad. @param joint  joint angle per motor angle
auto through_joint(const LoopGains& gains, const Law& law, double sense, Complex joint) -> Complex;
/// Margins of the worse of two loops, each by itself; the lower of the crossovers.
auto worse(const Margins& a, const Margins& b) -> Margins;
/// The loop of these gains, broken at the torque.
auto loop_of(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint>;
/// Of the joint loop alone, broken where it corrects the motor's reference.
auto outer_loop(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint>;

}  // namespace capstan::tools
