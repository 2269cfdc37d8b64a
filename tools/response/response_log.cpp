// SPDX-License-Identifier: Apache-2.0
// What a response is read from, and whether it is good enough to decide by.
#include <algorithm>
#include <cmath>

#include "capstan/tools/response/response.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33; what
// response_on_plant_test and docs/tuning.md report of margins is of seeds 31 and 32.
constexpr double kBand = 3.0;             // the loop's gain is between 1/3 and 3 where margins are decided
constexpr double kMostDistortion = 0.12;  // a joint that stands had 0.18 to 0.3, one that travels 0 to 0.09
constexpr double kRounding = 1e-6;        // of a signal: logs carry seven digits at least
// Rms of backward less forward where the loop's gain matters, relative: half of it is what the mean of both is off, 5 %
// or 0.4 dB. Chosen 29 November 2026 on seeds 700 to 702: forceps and fingers, whose tendons are alike, 0.00 to 0.03;
// wrists 0.11 to 0.36, RAVEN's elbows 0.5 to 1.1.
constexpr double kOneWayApart = 0.1;

auto matters(const Response& response, const ResponsePoint& point) -> bool {
  const double gain = std::abs(point.loop.value);
  return !response.on_torque || (gain > 1.0 / kBand && gain < kBand);
}

/// How much louder a shake has to be for the least coherence, if what does not repeat stays as it is.
auto louder(double coherence) -> double {
  const double over_noise = std::max(coherence, 0.01) / (1.0 - coherence);
  return std::sqrt(kLeastCoherence / (1.0 - kLeastCoherence) / over_noise);
}

void require_coherent(const Response& response) {
  const ResponsePoint* worst = nullptr;
  for (const ResponsePoint& point : response.points) {
    if (matters(response, point) && (worst == nullptr || point.coherence < worst->coherence)) {
      worst = &point;
    }
  }
  if (worst != nullptr && worst->coherence < kLeastCoherence) {
    std::string other = ", or let the joint travel faster";
    if (!response.multisine) {
      other = ", or record 'experiment joint0 multisine on=torque travel=0.4 speed=0.4': a chirp does not travel";
    } else if (!response.travels) {
      other = ", or let the joint travel (travel=0.4 speed=0.4)";
    }
    throw FaintShake(
        response.name + ": at " + rounded(worst->hz, 3) + " Hz only " + rounded(100.0 * worst->coherence, 2) +
            " % of the power " + (response.multisine ? "repeats with" : "follows") +
            " what shakes (80 % are needed where the loop's gain is near 1); shake with " +
            rounded(louder(worst->coherence), 2) + " times the amplitude at least" + other +
            "; to shake for longer does not help, as " +
            (response.multisine ? "each period is as noisy" : "the noise grows with the time as the shake does"),
        louder(worst->coherence));
  }
}

}  // namespace

auto read_response(const CsvLog& log, int axis) -> ResponseLog {
  const std::string prefix = "axis" + std::to_string(axis) + "/";
  if (!log.has(prefix + "tau_exc_Nm")) {
    throw BadInput(log.name() + ": has no column " + prefix +
                   "tau_exc_Nm, so it is not a log of 'experiment jointN chirp' or 'multisine on=torque'; record one");
  }
  ResponseLog result{.name = log.name(),
                     .time_s = log.time(),
                     .q1_rad = log.column(prefix + "q1_rad"),
                     .torque_nm = log.column(prefix + "tau_cmd_Nm"),
                     .q2_rad = log.column(prefix + "q2_est_rad"),
                     .reference_rad = log.column(prefix + "q2_ref_rad"),
                     .excitation_nm = log.column(prefix + "tau_exc_Nm")};
  const Eigen::Index rows = result.time_s.size();
  if (rows < 4 * kMultisinePeriodMs) {
    throw BadInput(log.name() + ": has " + std::to_string(rows) + " rows, and a response takes " +
                   std::to_string(4 * kMultisinePeriodMs) + "; shake for longer");
  }
  const double step = result.time_s[1] - result.time_s[0];
  for (Eigen::Index i = 1; i < rows; ++i) {
    if (std::fabs(result.time_s[i] - result.time_s[i - 1] - step) > 1e-4) {
      throw BadInput(place(log.name(), log.line_of(static_cast<std::size_t>(i))) +
                     "a row is missing before this one, and a response needs every one; record it over a faster "
                     "connection, or a multisine with a larger odd 'every'");
    }
  }
  return result;
}

void require_signals(const ResponseLog& log, bool on_torque) {
  if (range_of(on_torque ? log.excitation_nm : log.reference_rad) < 1e-7) {
    throw Refusal(log.name + ": nothing shakes the joint; record it with 'experiment joint0 multisine on=torque'");
  }
  if (range_of(log.q1_rad) == 0.0) {
    throw Refusal(log.name +
                  ": the motor's angle stands still throughout; check the encoder, or name its column with "
                  "--map axis0/q1_rad=COLUMN");
  }
  if (on_torque && range_of(log.torque_nm - log.excitation_nm) <= kRounding * range_of(log.excitation_nm)) {
    throw Refusal(log.name +
                  ": the torque is what shakes and nothing else, so no loop was closed; tau_cmd_Nm has to be control "
                  "and shake together: record it with 'experiment joint0 multisine on=torque' on an armed joint");
  }
  if (range_of(log.q2_rad) <= kRounding * range_of(log.q1_rad)) {
    throw Refusal(log.name +
                  ": the joint's estimate stands still while the motor moves, so the joint loop cannot be determined; "
                  "give the board a law whose estimate follows ('status' says whether it is valid) and shake again");
  }
}

auto is_multisine(const Eigen::VectorXd& shaken) -> bool {
  // Rows an odd number of ms apart come back to the same phases after as many rows as the period has ms.
  const Eigen::Index first = kMultisinePeriodMs / 2;
  if (shaken.size() < first + 2 * kMultisinePeriodMs) {
    return false;
  }
  const Eigen::VectorXd now = shaken.segment(first, kMultisinePeriodMs);
  const Eigen::VectorXd later = shaken.segment(first + kMultisinePeriodMs, kMultisinePeriodMs);
  return (now - later).norm() < 0.01 * now.norm();
}

auto views_of(const Response& response) -> std::vector<const Response*> {
  if (response.ways.empty()) {
    return {&response};
  }
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < response.points.size(); ++i) {
    if (matters(response, response.points[i])) {
      const Estimate& a = response.ways[0].points[i].motor;
      const Estimate& b = response.ways[1].points[i].motor;
      squares += (std::norm(a.value - b.value) - noise_between(a, b)) / std::norm(response.points[i].motor.value);
      ++count;
    }
  }
  if (squares < count * kOneWayApart * kOneWayApart) {
    return {&response};
  }
  return {&response.ways[0], &response.ways[1]};
}

auto spliced(Response low, const Response& high) -> Response {
  low.ways.resize(std::min(low.ways.size(), high.ways.size()));
  for (std::size_t i = 0; i < low.ways.size(); ++i) {
    low.ways[i] = spliced(std::move(low.ways[i]), high.ways[i]);
  }
  if (!high.points.empty()) {
    std::erase_if(low.points, [&](const ResponsePoint& point) { return point.hz >= high.points.front().hz; });
    low.points.insert(low.points.end(), high.points.begin(), high.points.end());
  }
  low.distortion = {.known = low.distortion.known && high.distortion.known,
                    .even = std::max(low.distortion.even, high.distortion.even),
                    .odd = std::max(low.distortion.odd, high.distortion.odd),
                    .noise = std::max(low.distortion.noise, high.distortion.noise)};
  low.windows = std::min(low.windows, high.windows);
  low.motor_shake_rad_s = std::max(low.motor_shake_rad_s, high.motor_shake_rad_s);
  return low;
}

void require_usable(const Response& response) {
  for (const Response* view : views_of(response)) {
    require_coherent(*view);
  }
  if (response.distortion.known && response.distortion.odd > kMostDistortion) {
    throw Refusal(response.name + ": " + rounded(100.0 * response.distortion.odd, 2) +
                  " % of the motor's motion is odd distortion, as of a joint that friction holds; let it travel " +
                  std::string(response.travels ? "faster, or shake it less" : "(travel=0.4 speed=0.4)") +
                  ", so that friction keeps its sign");
  }
}

}  // namespace capstan::tools
