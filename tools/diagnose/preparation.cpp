// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/preparation.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Decisions need no more rows than this; means over several samples lose nothing that lasts as long as a row.
constexpr Eigen::Index kEnoughRows = 8000;
constexpr double kLongestRowS = 0.04;
constexpr double kGapS = 0.1;
constexpr Eigen::Index kDerivativeReach = 2;  // samples to either side
constexpr Eigen::Index kShortestGap = 10;     // at least the noise model's order

/// `averaged`: half width of the mean that an effort's columns have been through. Rows closer than that would only
/// repeat each other, and whitening would bring out what little they differ by.
auto choose_factor(const std::vector<AxisLog>& logs, Eigen::Index averaged) -> Eigen::Index {
  const auto longest = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(kLongestRowS / logs.front().period_s));
  const Eigen::Index enough = std::clamp<Eigen::Index>(total_samples(logs) / kEnoughRows, 1, longest);
  return std::max(enough, 1 + averaged);
}

/// Noise in the torque is noise in a regressor, and a law that happens to average it, as a fractional delay does, would
/// look better for that alone. So everything is averaged alike, until the torque's noise is small against the torque.
auto choose_smoothing(const std::vector<AxisLog>& logs) -> Eigen::Index {
  constexpr double kNoiseShare = 0.002;
  constexpr double kLongestS = 0.015;
  Eigen::Index smoothing = 0;
  for (const auto& log : logs) {
    const double noise = white_noise_level(log.tau_nm);
    const double wanted = kNoiseShare * rms(log.tau_nm);
    if (noise > wanted && wanted > 0.0) {
      const double neighbours = 0.5 * (noise / wanted) * (noise / wanted);
      smoothing = std::max(smoothing, static_cast<Eigen::Index>(std::min(neighbours, kLongestS / log.period_s)));
    }
  }
  return smoothing;
}

/// Rows before the torque has first been at an end of its range: until then the past of the friction counts. Half at
/// most.
auto first_saturation(const Samples& samples) -> Eigen::Index {
  constexpr double kInside = 0.01;
  const auto by_torque = [](const auto& a, const auto& b) { return a.tau < b.tau; };
  const auto ends = std::minmax_element(samples.begin(), samples.end(), by_torque);
  const double margin = kInside * (ends.second->tau - ends.first->tau);
  const auto first = std::find_if(samples.begin(), samples.end(), [&](const auto& s) {
    return s.tau < ends.first->tau + margin || s.tau > ends.second->tau - margin;
  });
  return std::min(first - samples.begin(), static_cast<std::ptrdiff_t>(samples.size() / 2));
}

/// Rows before the second reversal, where terms with memory still depend on a past that was not logged; a twentieth at
/// most.
auto warm_up(const Samples& samples, TargetKind target) -> Eigen::Index {
  if (target == TargetKind::kForce) {
    return first_saturation(samples);
  }
  const auto changes = direction_changes(samples);
  const auto rows = static_cast<Eigen::Index>(samples.size());
  const Eigen::Index settled = changes.size() >= 2 ? static_cast<Eigen::Index>(changes[1]) : rows;
  return std::min(settled, rows / 20);
}

/// Columns q1, dq1, ddq1, tau, forward, tau_rev, q1_rev, time of one log at full rate.
auto signal_columns(const AxisLog& log, const Samples& samples, double start_s) -> Eigen::MatrixXd {
  Eigen::MatrixXd columns(log.samples(), 8);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const auto& sample = samples[static_cast<std::size_t>(i)];
    columns.row(i) << sample.q1, sample.dq1, sample.ddq1, sample.tau, (sample.forward ? 1.0 : 0.0), sample.tau_reversal,
        sample.q1_reversal, start_s + log.time_s[i] - log.time_s[0];
  }
  return columns;
}

auto coarse_signals(const Preparation& p) -> CoarseSignals {
  Eigen::MatrixXd all(p.noncausal.rows(), 8);
  Eigen::Index row = 0;
  double start_s = 0.0;
  for (std::size_t i = 0; i < p.logs.size(); ++i) {
    const auto& log = p.logs[i];
    all.middleRows(row, log.samples()) = signal_columns(log, p.noncausal.samples()[i], start_s);
    row += log.samples();
    start_s += static_cast<double>(log.samples()) * log.period_s;
  }
  const Eigen::MatrixXd coarse = decimated(moving_mean(all, p.noncausal.log_rows(), p.smoothing), p.factor);
  CoarseSignals s{coarse.col(7), coarse.col(0), coarse.col(1),
                  coarse.col(2), coarse.col(3), coarse.col(4),
                  coarse.col(5), coarse.col(6), {}};
  if (p.logs.size() == 1) {
    for (const auto& side : p.logs.front().side) {
      if (varies(side.values)) {
        s.side.push_back({side.name, decimated(side.values, p.factor)});
      }
    }
  }
  return s;
}

/// Noncausal samples of all logs, and copies with what q1's resolution and, unless an effort is the target, the
/// torque's noise may hide.
struct NoncausalLogs {
  std::vector<Samples> samples, coarse_angle, noisy_torque;
  Blocks uncertain;  ///< coarse rows touched by uncertain samples
};

auto noncausal_of(const std::vector<AxisLog>& logs, const ConditionerShape<double>& conditioner,
                  const AngleNoise& noise, Eigen::Index factor, Eigen::Index smoothing) -> NoncausalLogs {
  NoncausalLogs all;
  Random random(0x70C0);
  Eigen::Index begin = 0;
  for (const auto& log : logs) {
    const bool effort = log.motion_alone();
    NoncausalSamples noncausal =
        effort ? given_motion(log, conditioner, noise) : noncausal_samples(log, conditioner, noise);
    for (const auto& rows : noncausal.uncertain) {
      const Eigen::Index first = std::max<Eigen::Index>(0, rows.begin - smoothing);
      const Eigen::Index last = std::min(rows.end - 1 + smoothing, log.samples() - 1);
      all.uncertain.push_back({begin + first / factor, begin + last / factor + 1});
    }
    if (effort) {
      all.coarse_angle.push_back(motion_seen_again(log, noncausal, noise));
    } else {
      all.coarse_angle.push_back(noncausal.samples);
      all.noisy_torque.push_back(noncausal.samples);
      const double torque_noise = white_noise_level(log.tau_nm);
      for (std::size_t i = 0; i < noncausal.samples.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        auto& sample = all.coarse_angle.back()[i];
        set_motion(sample, sample.q1 + noncausal.hidden_rad[row], sample.dq1 + noncausal.hidden_rate[row]);
        sample.ddq1 += noncausal.hidden_acceleration[row];
        auto& noisy = all.noisy_torque.back()[i];
        noisy.tau += torque_noise * random.normal();
        noisy.tau_late = noisy.tau;
      }
    }
    all.samples.push_back(std::move(noncausal.samples));
    begin += log.samples() / factor;
  }
  return all;
}

/// Coarse rows of each log, without its warm-up and at least without its edges.
auto rows_of_logs(const Preparation& p, TargetKind target, Eigen::Index edge) -> Blocks {
  Blocks blocks;
  Eigen::Index row = 0;
  for (const auto& samples : p.noncausal.samples()) {
    const Eigen::Index rows = static_cast<Eigen::Index>(samples.size()) / p.factor;
    blocks.push_back({row + std::max(edge, warm_up(samples, target) / p.factor), row + rows - edge});
    row += rows;
  }
  return blocks;
}

/// What takes no part, for people: no verdict rests on rows that were changed in silence.
auto left_out_note(const Preparation& p) -> std::string {
  Eigen::Index kept = 0;
  for (const auto& rows : p.coarse_logs) {
    kept += rows.size();
  }
  const double total_s = static_cast<double>(p.noncausal.rows() / p.factor) * p.coarse_period_s;
  const double left_out_s = total_s - static_cast<double>(kept) * p.coarse_period_s;
  const double uncertain_s = static_cast<double>(rows_in(p.uncertain)) * p.coarse_period_s;
  return "decided on means over " + std::to_string(p.factor) + " samples, without the first " + rounded(left_out_s, 2) +
         " s, whose past was not logged; within " + rounded(uncertain_s, 2) +
         " s around reversals, whose direction the encoder does not show, law and target are interpolated alike";
}

/// Strokes of the motor there and back: how often it turns by more than a tenth of its range.
auto strokes(const std::vector<AxisLog>& logs) -> int {
  constexpr double kShareOfRange = 0.1;
  int count = 0;
  for (const auto& log : logs) {
    const Eigen::VectorXd& q1 = log.q1_rad;
    const double half_width = 0.5 * kShareOfRange * (q1.maxCoeff() - q1.minCoeff());
    double place = q1[0];
    int direction = 0;
    for (const double angle : q1) {
      const double next = std::clamp(place, angle - half_width, angle + half_width);
      const int now = next > place ? 1 : (next < place ? -1 : direction);
      count += now != direction ? 1 : 0;
      direction = now;
      place = next;
    }
  }
  return count;
}

/// Changes of the direction, but for the one that is only the beginning of a motion backward.
auto reversals_in(const Samples& samples) -> std::size_t {
  const auto changes = direction_changes(samples);
  const bool begins_backward = !changes.empty() && samples[changes.front()].q1 < samples.front().q1;
  return changes.size() - (begins_backward ? 1 : 0);
}

/// Another axis that moves otherwise in each of the cycles: they are no repeats of one experiment then. Empty if none.
auto axis_of_another_course(const Preparation& p) -> std::string {
  for (std::size_t slot = 0; slot < p.logs.front().others.size(); ++slot) {
    Eigen::VectorXd motion(p.noncausal.rows());
    Eigen::Index row = 0;
    for (const auto& log : p.logs) {
      motion.segment(row, log.samples()) =
          slot < log.others.size() ? log.others[slot].q1_rad : Eigen::VectorXd(Eigen::VectorXd::Zero(log.samples()));
      row += log.samples();
    }
    if (!comes_again(decimated(motion, p.factor), *p.repeats)) {
      return "axis" + std::to_string(p.logs.front().others[slot].number);
    }
  }
  return {};
}

}  // namespace

auto Preparation::interpolated(Eigen::MatrixXd columns) const -> Eigen::MatrixXd {
  for (const auto& rows : uncertain) {
    const Eigen::Index before = rows.begin - 1;
    const Eigen::Index after = rows.end;
    if (before < 0 || after >= columns.rows()) {
      continue;
    }
    const Eigen::RowVectorXd from = columns.row(before);
    const Eigen::RowVectorXd step = (columns.row(after) - from) / static_cast<double>(after - before);
    for (Eigen::Index row = rows.begin; row < rows.end; ++row) {
      columns.row(row) = from + step * static_cast<double>(row - before);
    }
  }
  return columns;
}

auto Preparation::coarse(const Eigen::MatrixXd& columns) const -> Eigen::MatrixXd {
  return interpolated(smoothing == 0 ? decimated(columns, factor)
                                     : decimated(moving_mean(columns, noncausal.log_rows(), smoothing), factor));
}

auto Preparation::certain() const -> Blocks {
  Blocks rows;
  for (const auto& block : split.learned()) {
    Eigen::Index begin = block.begin;
    for (const auto& doubtful : uncertain) {  // in order
      if (doubtful.end <= begin || doubtful.begin >= block.end) {
        continue;
      }
      if (doubtful.begin > begin) {
        rows.push_back({begin * factor, doubtful.begin * factor});
      }
      begin = doubtful.end;
    }
    if (begin < block.end) {
      rows.push_back({begin * factor, block.end * factor});
    }
  }
  return rows;
}

auto reason_unfit(const std::vector<AxisLog>& logs) -> std::string {
  constexpr Eigen::Index kFewestSamples = 150;
  constexpr double kFewestNoises = 30.0;       // the motion's range in standard deviations of the sensors
  constexpr double kFewestEffortNoises = 6.0;  // efforts are noisier, and averaged before they are looked at
  if (total_samples(logs) < kFewestSamples) {
    return "only " + std::to_string(total_samples(logs)) + " samples; record at least 10 s at 100 Hz or more";
  }
  const AngleNoise noise = motor_angle_noise(logs);
  std::size_t reversals = 0;
  double q1_range = 0.0;
  const bool effort = logs.front().effort.size() > 0;
  double range = 0.0;
  double target_noise = 0.0;
  for (const auto& log : logs) {
    ConditionerShape<double> shape;
    shape.direction_threshold_rad = direction_thresholds(logs, noise).back();
    reversals += reversals_in(causal_samples(log, shape));
    q1_range = std::max(q1_range, log.q1_rad.maxCoeff() - log.q1_rad.minCoeff());
    range = std::max(range, log.measured().maxCoeff() - log.measured().minCoeff());
    target_noise = std::max({target_noise, white_noise_level(log.measured()), quantisation_step(log.measured())});
  }
  if (q1_range < kFewestNoises * std::max(noise.step_rad, noise.white_rad)) {
    return "the motor moves by " + rounded(q1_range, 2) +
           " rad only, hardly more than its sensor's noise; record a larger motion";
  }
  if (effort && range < kFewestEffortNoises * target_noise) {
    return "the effort varies by " + rounded(range, 2) + " only, hardly more than its noise of " +
           rounded(target_noise, 2) + "; record a faster motion or a better sensor";
  }
  if (!effort && range < kFewestNoises * target_noise) {
    return "the joint moves by " + rounded(range, 2) + " rad only, hardly more than its sensor's noise of " +
           rounded(target_noise, 2) + " rad; record a larger motion or a better joint sensor";
  }
  if (reversals == 0) {
    return "the motor never reverses; record a motion that goes back and forth several times at several speeds";
  }
  return {};
}

auto reason_nameless(const std::vector<AxisLog>& logs) -> std::string {
  constexpr Eigen::Index kEnoughSamples = 400;  // whatever the motion
  constexpr int kFewestStrokes = 3;             // there, back, and there again: both ends of a hysteresis
  if (total_samples(logs) >= kEnoughSamples || strokes(logs) >= kFewestStrokes) {
    return {};
  }
  return "only " + std::to_string(total_samples(logs)) +
         " samples in which the motor does not move forth, back and forth again; record at least 10 s at 100 Hz or "
         "more";
}

namespace {

constexpr Eigen::Index kFewestCoarseRows = 4;  // of one log: two ends, and something between

/// Of several logs, each has to have some coarse rows. Too short a single one was told before what it is not fit for.
void check_lengths(const std::vector<AxisLog>& logs, Eigen::Index fewest) {
  for (const auto& log : logs) {
    if (logs.size() > 1 && log.samples() < fewest) {
      throw BadInput(log.name + ": the log has " + std::to_string(log.samples()) + " rows, and beside the others " +
                     std::to_string(fewest) + " are the minimum for a useful fit; leave it out");
    }
  }
}

}  // namespace

auto prepare(std::vector<AxisLog> logs, const LawForm& base) -> Preparation {
  const bool effort = base.catalogue->target() == TargetKind::kEffort;
  const AngleNoise noise = motor_angle_noise(logs);
  // An effort's columns are averaged when they are made, twice.
  const Eigen::Index before = effort ? effort_smoothing(logs, noise) : 0;
  const Eigen::Index factor = choose_factor(logs, before);
  // Derivatives and means have no neighbours beyond the ends.
  const Eigen::Index edge = effort ? (2 * before + kDerivativeReach) / factor + 1 : 0;
  check_lengths(logs, factor * (2 * edge + kFewestCoarseRows));
  for (auto& log : logs) {
    const Eigen::Index rows = log.samples() / factor * factor;
    log = first_rows(std::move(log), rows);
  }
  std::vector<std::string> notes;
  const auto conditioner = choose_conditioner(logs, base, notes);
  const Eigen::Index smoothing = effort ? 0 : choose_smoothing(logs);
  NoncausalLogs seen = noncausal_of(logs, conditioner, noise, factor, smoothing + 2 * before);
  const LawDesign noncausal(logs, std::move(seen.samples), before);
  if (effort) {
    notes.push_back(averaging_note(noncausal));
  }
  Preparation p{logs,
                conditioner,
                noise,
                effort ? noncausal : LawDesign(logs, conditioner),
                noncausal,
                {},
                noncausal.smoothed(stacked_target(logs)),
                factor,
                smoothing,
                static_cast<double>(factor) * logs.front().period_s,
                {},
                {},
                {},
                {},
                {},
                std::move(notes)};
  p.uncertain = std::move(seen.uncertain);
  p.disturbed.emplace_back(logs, std::move(seen.coarse_angle), before);
  if (!effort) {
    p.disturbed.emplace_back(logs, std::move(seen.noisy_torque));
  }
  p.coarse_logs = rows_of_logs(p, base.catalogue->target(), edge);
  p.notes.push_back(left_out_note(p));
  p.signals = coarse_signals(p);
  p.repeats = find_repeats(p.signals.q1, noise.white_rad);
  if (const std::string axis = p.repeats ? axis_of_another_course(p) : ""; !axis.empty()) {
    p.repeats.reset();
    p.notes.push_back("the motor repeats its cycle and " + axis +
                      " does not, so differences between cycles are not counted as noise");
  }
  const auto gap = std::max<Eigen::Index>(kShortestGap, std::lround(kGapS / p.coarse_period_s));
  p.split = split_rows({p.coarse_logs, p.repeats, gap});
  return p;
}

auto with_rate_filter(Preparation p, double time_constant_s) -> Preparation {
  if (p.conditioner.rate_time_constant_s != time_constant_s) {
    p.conditioner.rate_time_constant_s = time_constant_s;
    p.causal = LawDesign(p.logs, p.conditioner);
  }
  return p;
}

}  // namespace capstan::tools
