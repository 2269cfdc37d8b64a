// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <string>
#include <vector>

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

using Complex = std::complex<double>;

/// The log of `experiment jointN chirp` or `multisine on=...`.
struct ResponseLog {
  std::string name;
  Eigen::VectorXd time_s{}, q1_rad{}, torque_nm{}, q2_rad{}, reference_rad{};
  Eigen::VectorXd excitation_nm{};  ///< what was added to the torque; zero where the reference was shaken
};

/// Throws BadInput: a missing column, rows that are not evenly spaced, or nothing that shakes.
auto read_response(const CsvLog& log, int axis) -> ResponseLog;

/// Throws Refusal where nothing shakes, the torque is what shakes alone, or the joint's estimate stands still.
void require_signals(const ResponseLog& log, bool on_torque);

/// Whether what shakes repeats with the board's period.
auto is_multisine(const Eigen::VectorXd& shaken) -> bool;

/// A ratio of two spectra at one frequency.
struct Estimate {
  Complex value{};
  double radius95 = 0.0;  ///< the true value lies in this circle in 95 of 100 estimates
};

/// The mean square of what is within a circle of 95 %, of its radius's square; less where it is of few windows.
inline constexpr double kNoiseShare = 1.0 / 3.0;

/// Mean square by which noise makes two estimates of the same value differ.
inline auto noise_between(const Estimate& a, const Estimate& b) -> double {
  return kNoiseShare * (a.radius95 * a.radius95 + b.radius95 * b.radius95);
}

struct ResponsePoint {
  double hz = 0.0;
  Estimate motor{};  ///< motor angle per torque, rad/Nm
  Estimate joint{};  ///< estimated joint angle per motor angle
  Estimate loop{};   ///< of the closed loop, broken at the torque; nothing where the reference was shaken
  /// Of torque and motor angle with what shakes, the lower one: the share of the power that repeats with it.
  double coherence = 0.0;
};

/// Power of the motor angle where nothing shakes, over what the lines beside it have.
struct Distortion {
  bool known = false;  ///< of a multisine only
  double even = 0.0;   ///< amplitude over that of the lines: asymmetric nonlinearity, such as a spring with a stop
  double odd = 0.0;    ///< symmetric: friction, play, saturation
  double noise = 0.0;  ///< what does not repeat from period to period, at the same lines
};

/// What was shaken does not rise above the noise; a larger amplitude would.
class FaintShake : public Refusal {
 public:
  /// @param louder  times the amplitude that it takes at least
  FaintShake(const std::string& why, double louder) : Refusal(why), louder_(louder) {}
  [[nodiscard]] auto louder() const -> double { return louder_; }

 private:
  double louder_;
};

struct Response {
  std::string name;
  std::vector<ResponsePoint> points;  ///< by rising frequency
  Distortion distortion;
  bool multisine = true;
  bool on_torque = true;
  std::size_t windows = 0;                     ///< periods averaged; of a chirp 1
  bool travels = false;                        ///< the joint was on its way meanwhile
  double backward_nm = 0.0, forward_nm = 0.0;  ///< then: mean torque either way
  double motor_speed_rad_s = 0.0;              ///< and how fast the motor went
  double motor_shake_rad_s = 0.0;              ///< rms of what the shake added to that
  std::vector<Response> ways{};  ///< of a joint that travelled long enough: backward and forward by themselves
};

/// The period of the board's multisine; a test compares it with the firmware's.
inline constexpr int kMultisinePeriodMs = 2048;

/// H1 with what shakes as the instrument: S_yr / S_ur, which no feedback biases; plain H1 where that is the torque
/// itself. Periods in which a travelling joint turns are left out. Throws Refusal with the cure where there are too
/// few.
auto estimate_response(const ResponseLog& log) -> Response;

/// What gains have to suit: backward and forward by themselves where they differ by more than noise explains, as of
/// tendons that are not alike; else the joint as one. They live as long as `response`.
auto views_of(const Response& response) -> std::vector<const Response*>;

/// Of one joint under the same gains, shaken twice: the lines of `high` from its first on, below it those of `low`. A
/// shake of high frequencies alone may be louder, for it moves the motor less.
auto spliced(Response low, const Response& high) -> Response;

/// Below it a line does not count. Chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and
/// 33; what response_on_plant_test and docs/tuning.md report of margins is of seeds 31 and 32.
inline constexpr double kLeastCoherence = 0.8;

/// Throws Refusal where the coherence is below that in the band that matters, where the loop's gain is 1/3 to 3
/// (without a loop: everywhere), of each of its views, or distortion rules; the sentence says what to change.
void require_usable(const Response& response);

}  // namespace capstan::tools
