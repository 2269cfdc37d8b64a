// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/periods.hpp"

#include <cmath>
#include <numbers>

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRampMs = 256;  // the board's, at either end

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33; what
// response_on_plant_test and docs/tuning.md report of margins is of seeds 31 and 32.
constexpr int kSettleMs = 500;      // after a turn of a joint that travels
constexpr double kTurnRadS = 2e-3;  // change of the reference's rate in a row that is a turn, not rounding

/// What a turn leaves dies away slowly, so it differs at both ends of a window, and that leaks into all lines as 1 / f:
/// of a RAVEN elbow, twice what was shaken at 15 Hz. Under von Hann's window it leaks as 1 / f3, and a line mixes with
/// its two neighbours alone, which are even and empty.
auto von_hann() -> Eigen::VectorXd {
  return 1.0 - (Eigen::ArrayXd::LinSpaced(kMultisinePeriodMs, 0, kMultisinePeriodMs - 1) *
                (2.0 * std::numbers::pi / kMultisinePeriodMs))
                   .cos();
}

}  // namespace

Periods::Periods(const ResponseLog& log, bool on_torque)
    : log_(log), flat_(Eigen::VectorXd::Ones(kMultisinePeriodMs)), von_hann_(von_hann()) {
  for (int i = 0; i < kMultisinePeriodMs; ++i) {
    table_.push_back(std::polar(1.0, -2.0 * std::numbers::pi * i / kMultisinePeriodMs));
  }
  for (Eigen::Index i = 0; i < log.time_s.size(); ++i) {
    phases_.push_back(static_cast<int>(std::llround((log.time_s[i] - log.time_s[0]) * 1e3) % kMultisinePeriodMs));
  }
  step_ms_ = static_cast<int>(std::llround((log.time_s[1] - log.time_s[0]) * 1e3));
  find(on_torque);
}

auto Periods::way(Eigen::Index start) const -> double {
  return log_.q1_rad[start + kMultisinePeriodMs - 1] - log_.q1_rad[start];
}

auto Periods::going(bool forward) const -> Periods {
  Periods one = *this;
  one.starts_.clear();
  one.slopes_.clear();
  for (std::size_t w = 0; w < starts_.size(); ++w) {
    if ((way(starts_[w]) > 0.0) == forward) {
      one.starts_.push_back(starts_[w]);
      one.slopes_.push_back(slopes_[w]);
    }
  }
  return one;
}

auto Periods::spectrum_at(const Eigen::VectorXd& x, Eigen::Index from, const Eigen::VectorXd& weights,
                          std::size_t harmonic) const -> Complex {
  Complex sum{};
  for (Eigen::Index i = 0; i < kMultisinePeriodMs; ++i) {
    const std::size_t place = harmonic * static_cast<std::size_t>(phases_[static_cast<std::size_t>(from + i)]);
    sum += weights[i] * x[from + i] * table_[place % kMultisinePeriodMs];
  }
  return sum * (2.0 / kMultisinePeriodMs);
}

auto Periods::at(std::size_t harmonic, const Signals& signals, bool is_line) const -> std::vector<Spectra> {
  std::vector<Spectra> all(starts_.size());
  for (std::size_t w = 0; w < starts_.size(); ++w) {
    const auto of = [&](const Eigen::VectorXd& x) {
      return spectrum_at(x, starts_[w], is_line && travels_ ? von_hann_ : flat_, harmonic);
    };
    const Complex ramp = of(ramp_);
    for (std::size_t s = 0; s < kSignals; ++s) {
      all[w][s] = of(*signals[s]) - (slopes_.empty() ? 0.0 : slopes_[w][s]) * ramp;
    }
  }
  return all;
}

auto Periods::shaken_power(std::size_t harmonic, const Eigen::VectorXd& shaken) const -> double {
  return std::norm(spectrum_at(shaken, starts_.front(), flat_, harmonic));
}

auto Periods::mean_torque(bool forward) const -> double {
  double sum = 0.0;
  int count = 0;
  for (const Eigen::Index from : starts_) {
    if ((way(from) > 0.0) == forward) {
      sum += log_.torque_nm.segment(from, kMultisinePeriodMs).mean();
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

auto Periods::mean_speed() const -> double {
  double sum = 0.0;
  for (const Eigen::Index from : starts_) {
    sum += std::fabs(way(from)) / (log_.time_s[from + kMultisinePeriodMs - 1] - log_.time_s[from]);
  }
  return sum / static_cast<double>(starts_.size());
}

void Periods::find_slopes(const std::vector<std::size_t>& lines, const Signals& signals) {
  std::vector<std::array<double, kSignals>> slopes(starts_.size());
  for (std::size_t w = 0; w < starts_.size(); ++w) {
    Eigen::VectorXd rest = ramp_.segment(starts_[w], kMultisinePeriodMs);
    rest.array() -= rest.mean();
    for (const std::size_t line : lines) {
      const Complex own = spectrum_at(ramp_, starts_[w], flat_, line);
      for (Eigen::Index i = 0; i < kMultisinePeriodMs; ++i) {
        const std::size_t place = line * static_cast<std::size_t>(phases_[static_cast<std::size_t>(starts_[w] + i)]);
        rest[i] -= (own * std::conj(table_[place % kMultisinePeriodMs])).real();
      }
    }
    for (std::size_t s = 0; s < kSignals; ++s) {
      slopes[w][s] = rest.dot(signals[s]->segment(starts_[w], kMultisinePeriodMs)) / rest.squaredNorm();
    }
  }
  slopes_ = std::move(slopes);
}

void Periods::fill(Eigen::Index from, Eigen::Index end) {
  for (Eigen::Index start = end - kMultisinePeriodMs; start >= from; start -= kMultisinePeriodMs) {
    starts_.push_back(start);
  }
}

void Periods::find(bool on_torque) {
  const Eigen::VectorXd& reference = log_.reference_rad;
  ramp_ = log_.time_s.array() - log_.time_s[0];
  const Eigen::Index rows = reference.size();
  Eigen::Index from = static_cast<Eigen::Index>(kMultisinePeriodMs);  // the first period settles
  for (Eigen::Index i = 2; i < rows; ++i) {
    const double turn = (reference[i] - 2.0 * reference[i - 1] + reference[i - 2]) * 1e3 / step_ms_;
    if (on_torque && std::fabs(turn) > kTurnRadS) {
      travels_ = true;
      fill(from, i - 1);
      from = i + kSettleMs / step_ms_;
    }
  }
  fill(from, rows - kRampMs / step_ms_);
}

}  // namespace capstan::tools
