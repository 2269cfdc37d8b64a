// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/tuning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "capstan/model/scalar.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegreesPerTurn = 360.0;
constexpr double kCycleS = 1e-3;
constexpr int kBetween = 8;  // points from line to line

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 and 2; what is reported in
// docs/tuning.md is of other seeds.
constexpr double kServoReserveDeg = 6.0;  // that the joint loop may take of the servo's phase margin
constexpr double kEncoderShare = 0.02;    // rms torque of the encoder's steps, of the continuous torque
constexpr double kResonanceDb = 6.0;      // above the model of motor and delay
constexpr double kLeastCoherence = 0.8;
constexpr double kMostCircle = 0.5;    // radius over value; above, the phase is anybody's guess
constexpr double kAboveFirst = 1.5;    // crossover over the first clear line: below it, the loop is not known
constexpr double kAboveAsked = 1.15;   // crossover over the one that was asked for
constexpr double kCascade = 0.1;       // joint loop over servo: a cascade's usual distance, and little to hunt with
constexpr double kMostMismatch = 0.1;  // of measured loop and gains; 0.01 to 0.03 where they belong together
constexpr std::size_t kLeastLines = 5;
constexpr double kNeighbourOctaves = 0.35;  // either way: two to four lines of a multisine
constexpr double kTwoSigma = 2.0;
constexpr double kLowGain = 1.0 / 3.0;
constexpr double kStepUp = 1.12;  // how much more gain is tried to see what limits
constexpr double kMostStiffness = 100.0, kMostDamping = 10.0, kMostKi = 100.0;  // of the parameters

/// What control makes of an angle at one frequency.
struct Law {
  Complex servo;  // Nm per rad of the motor
  Complex joint;  // motor rad per joint rad
};
auto law_of(const LoopGains& gains, double hz) -> Law {
  const Complex back = std::polar(1.0, -2.0 * kPi * hz * kCycleS);
  const double gain = SamplePeriod<double>(kCycleS).filter_gain(gains.rate_time_constant_s);
  const Complex rate = (1.0 - back) / kCycleS;
  return {.servo = gains.stiffness + gains.damping * rate * gain / (1.0 - (1.0 - gain) * back),
          .joint = gains.kp + gains.ki_per_s * kCycleS / (1.0 - back) + gains.kd_s * rate};
}

/// The response between its lines: magnitude and phase run straight over the logarithm of the frequency.
struct Dense {
  std::vector<double> hz;
  std::vector<Complex> motor, joint, loop;                    // joint: per motor angle
  std::vector<double> motor_share, joint_share, loop_radius;  // radii; the first two relative
};

auto between(Complex a, Complex b, double share) -> Complex {
  const double turn = std::arg(b / a);
  return std::polar(std::abs(a) * std::pow(std::abs(b) / std::abs(a), share), std::arg(a) + share * turn);
}

/// Lines that noise buries say nothing of a margin.
auto clear_points(const Response& response) -> std::vector<ResponsePoint> {
  std::vector<ResponsePoint> clear;
  for (const ResponsePoint& point : response.points) {
    // Where the gain is low the circle alone decides, for the gain margin is looked for there.
    const bool coherent = point.coherence >= kLeastCoherence || std::abs(point.loop.value) < kLowGain;
    if (coherent && point.motor.radius95 < kMostCircle * std::abs(point.motor.value)) {
      clear.push_back(point);
    }
  }
  if (clear.size() < kLeastLines) {
    throw Refusal(response.name + ": only " + std::to_string(clear.size()) +
                  " lines rise clearly above the noise; shake with a larger amplitude, or for longer");
  }
  return clear;
}

/// Friction that turns its sign now and then repeats from period to period, so no circle shows it, but it differs from
/// line to line. So the response over the model of motor and delay is averaged over neighbours, each by its circle, and
/// by how much they differ the circle grows.
auto smoothed(const std::vector<ResponsePoint>& points, const MotorModel& model) -> std::vector<ResponsePoint> {
  std::vector<ResponsePoint> smooth = points;
  for (ResponsePoint& point : smooth) {
    Complex sum{};
    double weights = 0.0;
    double squares = 0.0;
    int count = 0;
    for (const ResponsePoint& beside : points) {
      if (std::fabs(std::log2(beside.hz / point.hz)) > kNeighbourOctaves) {
        continue;
      }
      const Complex ratio = beside.motor.value / model.at(beside.hz);
      const double weight = 1.0 / (1e-6 + std::pow(beside.motor.radius95 / std::abs(beside.motor.value), 2));
      sum += weight * ratio;
      squares += weight * std::norm(ratio);
      weights += weight;
      ++count;
    }
    const Complex mean = sum / weights;
    const double apart = std::max(0.0, squares / weights - std::norm(mean));
    const double scatter = count > 1 ? apart / (count - 1) : 0.0;
    point.motor.value = mean * model.at(point.hz);
    point.motor.radius95 = std::abs(point.motor.value) * std::sqrt(1.0 / weights + kTwoSigma * kTwoSigma * scatter);
  }
  return smooth;
}

auto dense(const Response& response) -> Dense {
  Dense all;
  const std::vector<ResponsePoint> points = smoothed(clear_points(response), fit_motor(response));
  const auto add = [&all](const ResponsePoint& a, const ResponsePoint& b, double share) {
    const auto mix = [share](double x, double y) { return x + share * (y - x); };
    all.hz.push_back(a.hz * std::pow(b.hz / a.hz, share));
    all.motor.push_back(between(a.motor.value, b.motor.value, share));
    all.joint.push_back(between(a.joint.value, b.joint.value, share));
    all.loop.push_back(between(a.loop.value, b.loop.value, share));
    all.motor_share.push_back(
        mix(a.motor.radius95 / std::abs(a.motor.value), b.motor.radius95 / std::abs(b.motor.value)));
    all.joint_share.push_back(
        mix(a.joint.radius95 / std::abs(a.joint.value), b.joint.radius95 / std::abs(b.joint.value)));
    all.loop_radius.push_back(mix(a.loop.radius95, b.loop.radius95));
  };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    for (int k = 0; k < kBetween; ++k) {
      add(points[i], points[i + 1], static_cast<double>(k) / kBetween);
    }
  }
  add(points.back(), points.back(), 0.0);
  return all;
}

/// The joint turns against the motor where the transmission is crossed, and the firmware corrects that way round.
auto sense_of(const Dense& all) -> double {
  double sum = 0.0;
  for (const Complex& one : all.joint) {
    sum += one.real();
  }
  return sum < 0.0 ? -1.0 : 1.0;
}

auto loop_of(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint> {
  const double sense = sense_of(all);
  std::vector<LoopPoint> loop;
  for (std::size_t i = 0; i < all.hz.size(); ++i) {
    const Law law = law_of(gains, all.hz[i]);
    const Complex through_joint = sense * gains.stiffness * law.joint * all.joint[i];
    const Complex feedback = law.servo + through_joint;
    const double radius = std::abs(all.motor[i]) *
                          (all.motor_share[i] * std::abs(feedback) + all.joint_share[i] * std::abs(through_joint));
    loop.push_back({all.hz[i], all.motor[i] * feedback, radius});
  }
  return loop;
}

/// Of the joint loop alone, broken where it corrects the motor's reference.
auto outer_loop(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint> {
  const double sense = sense_of(all);
  std::vector<LoopPoint> loop;
  for (std::size_t i = 0; i < all.hz.size(); ++i) {
    const Law law = law_of(gains, all.hz[i]);
    const Complex inner = 1.0 + all.motor[i] * law.servo;
    loop.push_back({all.hz[i], sense * gains.stiffness * law.joint * all.joint[i] * all.motor[i] / inner, 0.0});
  }
  return loop;
}

auto keeps(const Margins& margins, const Wanted& wanted, double reserve_deg = 0.0) -> bool {
  return margins.phase_deg >= wanted.phase_deg + reserve_deg && margins.gain_db >= wanted.gain_db &&
         margins.modulus >= wanted.modulus;
}

/// Rms torque that the encoder's steps make, N m: white noise of a step's twelfth through the servo.
auto encoder_torque(const LoopGains& gains) -> double {
  constexpr int kPoints = 64;
  double power = 0.0;
  for (int i = 1; i <= kPoints; ++i) {
    power += std::norm(law_of(gains, 0.5 / kCycleS * i / kPoints).servo) / kPoints;
  }
  return 2.0 * kPi / gains.counts_per_turn / std::sqrt(12.0) * std::sqrt(power);
}
auto too_coarse(const LoopGains& gains) -> bool {
  return encoder_torque(gains) > kEncoderShare * gains.continuous_nm;
}

auto servo_only(LoopGains gains) -> LoopGains {
  gains.kp = gains.ki_per_s = gains.kd_s = 0.0;
  return gains;
}

struct Found {
  LoopGains gains;
  Margins margins;
};

/// The servo by a grid: 5 % from one stiffness to the next, and damping from a fifth of a millisecond's to a tenth of a
/// second's share of it. The stiffest that keeps the margins, at the bandwidth that was asked for.
auto tune_servo(const Dense& all, const std::vector<LoopPoint>& known, const LoopGains& present, const Wanted& wanted)
    -> std::optional<Found> {
  std::optional<Found> best;
  for (double share_s = 2e-4; share_s < 0.1; share_s *= 1.12) {
    for (double stiffness = 0.01 * present.stiffness; stiffness < 100.0 * present.stiffness; stiffness *= 1.05) {
      LoopGains gains = servo_only(present);
      gains.stiffness = stiffness;
      gains.damping = stiffness * share_s;
      if (gains.stiffness > kMostStiffness || gains.damping > kMostDamping || too_coarse(gains)) {
        break;
      }
      const std::vector<LoopPoint> loop = loop_of(all, gains);
      const Margins margins = margins_of(loop);
      if (margins.crossover_hz < kAboveFirst * all.hz.front() || !keeps(margins, wanted, kServoReserveDeg) ||
          (wanted.bandwidth_hz && (margins.crossover_hz < *wanted.bandwidth_hz ||
                                   margins.crossover_hz > kAboveAsked * *wanted.bandwidth_hz))) {
        continue;
      }
      const bool better = !best || gains.stiffness > best->gains.stiffness;
      if (better && as_stable_as(loop, known)) {
        best = Found{gains, margins};
      }
    }
  }
  return best;
}

/// The joint loop's corner: where its gain comes to 1, below the lines as an integral goes on.
auto joint_bandwidth(const Dense& all, const LoopGains& gains) -> double {
  const std::vector<LoopPoint> outer = outer_loop(all, gains);
  if (std::abs(outer.front().value) < 1.0) {
    return outer.front().hz * std::abs(outer.front().value);
  }
  const auto below =
      std::find_if(outer.begin(), outer.end(), [](const LoopPoint& point) { return std::abs(point.value) < 1.0; });
  return below == outer.end() ? outer.back().hz : below->hz;
}

/// The joint loop's integral as fast as the margins and a tenth of the servo's crossover allow; kp as it was, or less.
auto tune_joint(const Dense& all, const std::vector<LoopPoint>& known, const Found& servo, const LoopGains& present,
                const Wanted& wanted) -> std::optional<Found> {
  const double most = std::min(kMostKi, 2.0 * kPi * kCascade * servo.margins.crossover_hz);
  for (const double part : {1.0, 0.5, 0.25, 0.0}) {
    for (double ki = most; ki > 0.1; ki *= 0.9) {
      LoopGains gains = servo.gains;
      gains.kp = part * present.kp;
      gains.ki_per_s = ki;
      gains.kd_s = part * present.kd_s;
      const std::vector<LoopPoint> loop = loop_of(all, gains);
      const Margins margins = margins_of(loop);
      if (keeps(margins, wanted) && keeps(margins_of(outer_loop(all, gains)), wanted) && as_stable_as(loop, known)) {
        return Found{gains, margins};
      }
    }
  }
  return {};
}

auto sentence_of(const char* what, double hz, const MotorModel& motor, double filter_s) -> std::string {
  const bool resonant = motor.resonance_hz > 0.0 && std::fabs(std::log2(hz / motor.resonance_hz)) < 0.5;
  if (resonant) {
    return std::string("a resonance near ") + rounded(motor.resonance_hz, 3) + " Hz: there the " + what +
           " is used up; stiffen what swings, or lower the bandwidth";
  }
  return std::string("delay: at ") + rounded(hz, 3) + " Hz, where the " + what + " is used up, " +
         rounded(1e3 * motor.delay_s, 2) + " ms of delay in drive and sensor take " +
         rounded(kDegreesPerTurn * hz * motor.delay_s, 2) + " deg, and the filter of the rate of " +
         rounded(1e3 * filter_s, 2) + " ms (conditioner.rate_time_constant) up to " +
         rounded(kDegreesPerTurn * hz * filter_s, 2) + " deg";
}

auto limit_of(const Dense& all, const Tuning& tuning, const Wanted& wanted, double last_hz) -> std::string {
  LoopGains more = servo_only(tuning.gains);
  more.stiffness *= kStepUp;
  more.damping *= kStepUp;
  if (too_coarse(more)) {
    return "encoder: its steps of " + rounded(2e3 * kPi / more.counts_per_turn, 2) +
           " mrad would shake the torque by more than 2 % of the continuous one; a finer encoder allows more";
  }
  const Margins margins = margins_of(loop_of(all, more));
  if (margins.gain_db < wanted.gain_db) {
    return sentence_of("gain margin", margins.gain_hz, tuning.motor, more.rate_time_constant_s);
  }
  if (margins.phase_deg < wanted.phase_deg + kServoReserveDeg) {
    return sentence_of("phase margin", margins.phase_hz, tuning.motor, more.rate_time_constant_s);
  }
  if (margins.modulus < wanted.modulus) {
    return sentence_of("modulus margin", margins.modulus_hz, tuning.motor, more.rate_time_constant_s);
  }
  return "nothing up to " + rounded(last_hz, 3) + " Hz, where the log ends; shake up to a higher frequency";
}

/// The measured loop is the plant's response times the present gains', or these are not the gains of the log.
void require_same_gains(const Response& response, const Dense& all, const LoopGains& present) {
  const std::vector<LoopPoint> loop = loop_of(all, present);
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (std::abs(all.loop[i]) > 1.0 / 3.0 && std::abs(all.loop[i]) < 3.0) {
      sum += std::norm(loop[i].value / all.loop[i] - 1.0);
      ++count;
    }
  }
  const double off = count > 0 ? std::sqrt(sum / count) : 0.0;
  if (off > kMostMismatch) {
    throw Refusal(
        response.name + ": the loop that was measured is " + rounded(100.0 * off, 2) +
        " % off the one of these gains, so the log was made with others; give the board's 'dump' of that time "
        "with --dump");
  }
}

}  // namespace

auto read_gains(const std::string& dump, int axis) -> LoopGains {
  LoopGains gains;
  double torque_per_current = 0.1;
  double continuous_a = 1.5;
  const std::string prefix = "joint" + std::to_string(axis) + ".";
  const std::vector<std::pair<std::string, double*>> rows = {
      {"control.kp", &gains.kp},
      {"control.ki", &gains.ki_per_s},
      {"control.kd", &gains.kd_s},
      {"control.stiffness", &gains.stiffness},
      {"control.damping", &gains.damping},
      {"conditioner.rate_time_constant", &gains.rate_time_constant_s},
      {"motor.encoder_counts", &gains.counts_per_turn},
      {"motor.torque_per_current", &torque_per_current},
      {"limits.continuous_current", &continuous_a}};
  std::istringstream text(dump);
  int found = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string set;
    std::string name;
    std::string value;
    words >> set >> name >> value;
    for (const auto& [row, into] : rows) {
      if (set == "set" && name == prefix + row) {
        const std::optional<double> number = parse_number(value);
        if (!number) {
          throw BadInput("the dump's line '" + line +
                         "' has no number; write 'dump' at the prompt and keep its answer");
        }
        *into = *number;
        ++found;
      }
    }
  }
  if (found == 0) {
    throw BadInput("the dump has no line 'set " + prefix +
                   "control...'; write 'dump' at the board's prompt and keep its answer in a file");
  }
  gains.continuous_nm = torque_per_current * continuous_a;
  return gains;
}

auto MotorModel::at(double hz) const -> Complex {
  const double w = 2.0 * kPi * hz;
  return std::polar(1.0, -w * delay_s) / Complex(stiffness_nm - inertia_kgm2 * w * w, viscous_nms * w);
}

auto fit_motor(const Response& response) -> MotorModel {
  MotorModel best;
  best.share_left = 1e9;
  const std::vector<ResponsePoint> points = clear_points(response);
  const auto rows = static_cast<Eigen::Index>(points.size());
  // 1 / G = (k - J w2 + j w b) exp(j w T): linear but for T, which is looked for every 20 us.
  for (double delay = 0.0; delay < 0.01; delay += 2e-5) {
    Eigen::MatrixXd columns(2 * rows, 3);
    Eigen::VectorXd one(2 * rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const ResponsePoint& point = points[static_cast<std::size_t>(i)];
      const double w = 2.0 * kPi * point.hz;
      const Complex turned = point.motor.value * std::polar(1.0, w * delay);
      const double weight = 1.0 / (0.02 + point.motor.radius95 / std::abs(point.motor.value));
      const std::array<Complex, 3> parts = {-w * w * turned, Complex(0.0, w) * turned, turned};
      for (Eigen::Index c = 0; c < 3; ++c) {
        columns(2 * i, c) = weight * parts[static_cast<std::size_t>(c)].real();
        columns(2 * i + 1, c) = weight * parts[static_cast<std::size_t>(c)].imag();
      }
      one[2 * i] = weight;
      one[2 * i + 1] = 0.0;
    }
    const Eigen::VectorXd x = columns.colPivHouseholderQr().solve(one);
    const double left = (columns * x - one).norm() / one.norm();
    if (left < best.share_left) {
      best = {.inertia_kgm2 = x[0], .viscous_nms = x[1], .stiffness_nm = x[2], .delay_s = delay, .share_left = left};
    }
  }
  double furthest = std::pow(10.0, kResonanceDb / 20.0);
  for (const ResponsePoint& point : points) {
    const double above = (std::abs(point.motor.value) - point.motor.radius95) / std::abs(best.at(point.hz));
    if (above > furthest) {
      furthest = above;
      best.resonance_hz = point.hz;
    }
  }
  return best;
}

auto predicted_loop(const Response& response, const LoopGains& gains) -> std::vector<LoopPoint> {
  return loop_of(dense(response), gains);
}

auto measured_loop(const Response& response) -> std::vector<LoopPoint> {
  const Dense all = dense(response);
  std::vector<LoopPoint> loop;
  for (std::size_t i = 0; i < all.hz.size(); ++i) {
    loop.push_back({all.hz[i], all.loop[i], all.loop_radius[i]});
  }
  return loop;
}

auto margins_of(const std::vector<LoopPoint>& loop, bool with_circle) -> Margins {
  Margins margins;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double radius = with_circle ? loop[i].radius95 : 0.0;
    const double size = std::abs(loop[i].value);
    if (const double modulus = std::abs(1.0 + loop[i].value) - radius; modulus < margins.modulus) {
      margins.modulus = modulus;
      margins.modulus_hz = loop[i].hz;
    }
    if (i == 0) {
      continue;
    }
    const Complex before = loop[i - 1].value;
    const Complex now = loop[i].value;
    if ((std::abs(before) > 1.0) != (size > 1.0)) {
      margins.crossover_hz = loop[i].hz;
      const double share = std::log(1.0 / std::abs(before)) / std::log(size / std::abs(before));
      const Complex at = between(before, now, share);
      const double off = std::asin(std::min(1.0, radius)) * 180.0 / kPi;
      const double phase = std::fabs(std::arg(-at)) * 180.0 / kPi - off;  // from -1, either way round
      if (phase < margins.phase_deg) {
        margins.phase_deg = phase;
        margins.phase_hz = loop[i].hz;
      }
    }
    if (before.real() < 0.0 && now.real() < 0.0 && (before.imag() < 0.0) != (now.imag() < 0.0)) {
      const double share = before.imag() / (before.imag() - now.imag());
      const double at = std::abs(before + share * (now - before));
      const double db = at < 1.0 ? -20.0 * std::log10(at + radius) : 20.0 * std::log10(std::max(1e-9, at - radius));
      if (db < margins.gain_db) {
        margins.gain_db = db;
        margins.gain_hz = loop[i].hz;
      }
    }
  }
  // Where the phase does not come to 180 deg by the last line, the gain there bounds the margin.
  const double last = std::abs(loop.back().value) + (with_circle ? loop.back().radius95 : 0.0);
  if (margins.gain_hz < margins.crossover_hz && last < 1.0) {
    margins.gain_db = std::min(margins.gain_db, -20.0 * std::log10(last));
    margins.gain_hz = loop.back().hz;
  }
  return margins;
}

auto as_stable_as(const std::vector<LoopPoint>& loop, const std::vector<LoopPoint>& known) -> bool {
  double turned = 0.0;
  Complex before = (1.0 + loop.front().value) / (1.0 + known.front().value);
  double first = std::arg(before);
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const Complex now = (1.0 + loop[i].value) / (1.0 + known[i].value);
    turned += std::arg(now / before);
    before = now;
  }
  // From its value at the first line to that at the last, without a turn round zero.
  return std::fabs(first + turned) < kPi;
}

auto tune(const Response& response, const LoopGains& present, const Wanted& wanted) -> Tuning {
  if (!response.on_torque) {
    throw Refusal(response.name +
                  ": the reference was shaken, and gains need the loop at the torque; record "
                  "'experiment joint0 multisine on=torque'");
  }
  if (!response.multisine) {
    throw Refusal(response.name + ": a chirp does not show whether friction holds the joint, and gains for a held joint "
                                  "are far too high for one that moves; record 'experiment joint0 multisine on=torque "
                                  "travel=0.4 speed=0.2'");
  }
  const Dense all = dense(response);
  require_same_gains(response, all, present);
  const std::vector<LoopPoint> known = measured_loop(response);
  const auto servo = tune_servo(all, known, present, wanted);
  if (!servo) {
    throw Refusal(response.name + ": no gains of the motor servo keep " + rounded(wanted.phase_deg, 3) + " deg, " +
                  rounded(wanted.gain_db, 3) + " dB and a modulus of " + rounded(wanted.modulus, 2) +
                  (wanted.bandwidth_hz ? " at " + rounded(*wanted.bandwidth_hz, 3) + " Hz; ask for less bandwidth, or "
                                       : std::string("; ")) +
                  "shake for longer, for the circles of 95 % count against the margins");
  }
  const auto joint = tune_joint(all, known, *servo, present, wanted);
  if (!joint) {
    throw Refusal(response.name + ": beside the motor servo no joint loop keeps the margins; ask for less bandwidth");
  }
  Tuning tuning{.gains = joint->gains,
                .motor = fit_motor(response),
                .servo = servo->margins,
                .whole = joint->margins,
                .whole_nominal = {},
                .limited_by = {},
                .loop = loop_of(all, joint->gains)};
  if (response.travels) {
    tuning.gains.friction_nm = {{response.backward_nm, response.forward_nm}};
  }
  tuning.whole_nominal = margins_of(tuning.loop, false);
  tuning.joint_bandwidth_hz = joint_bandwidth(all, joint->gains);
  tuning.limited_by = wanted.bandwidth_hz ? "the bandwidth that was asked for"
                                          : limit_of(all, tuning, wanted, response.points.back().hz);
  return tuning;
}

auto tuning_lines(const LoopGains& gains, int axis) -> std::vector<std::string> {
  const std::string set = "set joint" + std::to_string(axis) + ".control.";
  std::vector<std::string> lines = {"begin",
                                    set + "stiffness " + rounded(gains.stiffness) + " Nm/rad",
                                    set + "damping " + rounded(gains.damping) + " Nms/rad",
                                    set + "kp " + rounded(gains.kp),
                                    set + "ki " + rounded(gains.ki_per_s) + " 1/s",
                                    set + "kd " + rounded(gains.kd_s) + " s"};
  if (gains.friction_nm) {
    lines.push_back(set + "torque_backward " + rounded(gains.friction_nm->first, 3) + " Nm");
    lines.push_back(set + "torque_forward " + rounded(gains.friction_nm->second, 3) + " Nm");
  }
  lines.emplace_back("commit");
  return lines;
}

}  // namespace capstan::tools
