// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/adequacy.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/side_by_side.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kCertain = 0.005;
constexpr double kRepeatsItself = 0.001;  // stricter: small errors of the noncausal direction repeat as well
constexpr double kFlexibleWhite = 2.7;    // t over some 40 blocks at kCertain
constexpr double kCeilingRaw = 2.0;

/// Energy per learned block of what the sensors hide. A flexible model may find that, since torque says where between
/// two counts the motor is, and the angle says what the torque is.
auto hidden_energy(const Preparation& p, const Eigen::MatrixXd& sensing) -> Eigen::VectorXd {
  const Blocks blocks = p.split.learned();
  Eigen::VectorXd energy(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    energy[static_cast<Eigen::Index>(i)] = sensing.middleRows(blocks[i].begin, blocks[i].size()).squaredNorm();
  }
  return energy;
}

/// Energy of the cycles' mean against that of their differences, both whitened; and in the measured quantity. The mean
/// has in it what the encoder hides.
void test_repetition(const Preparation& p, const Evidence& evidence, Adequacy& result) {
  const Repeats cycles = learned_cycles(p);
  const auto count = static_cast<double>(cycles.count);
  const auto rows = static_cast<double>(cycles.length);
  auto energies = [&](const Eigen::VectorXd& signal, const Eigen::VectorXd& hidden, double& mean, double& difference) {
    const Eigen::VectorXd pure = pure_error(signal, cycles);
    double total = 0.0;
    for (Eigen::Index i = 0; i < cycles.count; ++i) {
      const RowRange cycle = cycles.cycle(i);
      total += signal.segment(cycle.begin, cycles.length).squaredNorm();
      total -= hidden.segment(cycle.begin, cycles.length).squaredNorm();
    }
    // pure_error() scales each cycle's deviation by count / (count - 1) in variance.
    difference = pure.squaredNorm() / count / rows;
    mean = (total - pure.squaredNorm() * (count - 1.0) / count) / (rows - static_cast<double>(evidence.layout.law));
  };
  double mean = 0.0;
  double difference = 0.0;
  energies(evidence.white_error, evidence.white_sensing.col(0), mean, difference);
  const double spread = difference * std::sqrt(2.0 / rows + 2.0 / (rows * (count - 1.0)));
  result.lack_of_fit_p = spread > 0.0 ? normal_tail((mean - difference) / spread) : (mean > 0.0 ? 0.0 : 1.0);
  energies(evidence.error, evidence.sensing.col(0), mean, difference);
  mean = std::max(mean, 0.0);  // what the encoder hides is one draw, and may be more than there is
  result.reducible_share = std::max(result.reducible_share, (mean - difference) / (mean + (count - 1.0) * difference));
}

}  // namespace

auto learned_cycles(const Preparation& p) -> Repeats {
  Repeats cycles = *p.repeats;
  Eigen::Index last = 0;
  for (const auto& rows : p.split.learned()) {
    last = std::max(last, rows.end);
  }
  while (cycles.count > 2 && cycles.cycle(cycles.count - 1).begin >= last) {
    --cycles.count;
  }
  while (cycles.count > 2 && cycles.first < p.coarse_logs.front().begin) {  // the first one is still warming up
    cycles.first += cycles.length;
    --cycles.count;
  }
  return cycles;
}

auto pure_error_level(const Preparation& p, const Eigen::VectorXd& error) -> double {
  const Repeats cycles = learned_cycles(p);
  std::vector<bool> certain(static_cast<std::size_t>(cycles.length), true);  // by the place in the cycle
  for (const auto& doubtful : p.uncertain) {
    for (Eigen::Index row = std::max(doubtful.begin, cycles.first); row < doubtful.end; ++row) {
      certain[static_cast<std::size_t>((row - cycles.first) % cycles.length)] = false;
    }
  }
  const Eigen::VectorXd deviation =
      pure_error(error, {cycles.first * p.factor, cycles.length * p.factor, cycles.count});
  double squares = 0.0;
  Eigen::Index samples = 0;
  for (Eigen::Index i = 0; i < cycles.count * cycles.length; ++i) {
    if (certain[static_cast<std::size_t>(i % cycles.length)]) {
      squares += deviation.segment((cycles.first + i) * p.factor, p.factor).squaredNorm();
      samples += p.factor;
    }
  }
  return samples > 0 ? std::sqrt(squares / static_cast<double>(samples)) : 0.0;
}

auto averaged_out(const Preparation& p, const Eigen::VectorXd& error) -> double {
  const Eigen::VectorXd means = p.coarse(error);
  double fast = 0.0;
  Eigen::Index samples = 0;
  for (const auto& block : p.certain()) {
    const Eigen::Index rows = block.size() / p.factor;
    fast += error.segment(block.begin, block.size()).squaredNorm();
    fast -= static_cast<double>(p.factor) * means.segment(block.begin / p.factor, rows).squaredNorm();
    samples += block.size();
  }
  return std::max(0.0, fast / static_cast<double>(samples));
}

auto judge_adequacy(const Preparation& p, const Evidence& evidence, const SieveResult& sieve) -> Adequacy {
  Adequacy result;
  const ColumnModel law = law_model(evidence.layout);
  result.law_energy = cross_validated(evidence.raw(), evidence.learned, law);
  const Eigen::VectorXd hidden = hidden_energy(p, evidence.sensing);
  result.hidden_energy = hidden.sum();
  Eigen::VectorXd flexible[2];  // raw, white
  two_at_a_time(2, [&](std::size_t i) { flexible[i] = flexible_model(evidence.raw_white[i], evidence.learned); });
  result.flexible_energy = flexible[0] + hidden;
  const Eigen::VectorXd white_gain =
      cross_validated(evidence.white(), evidence.learned, law) - flexible[1] - hidden_energy(p, evidence.white_sensing);
  result.flexible_t = t_statistic(white_gain);
  const double left = result.law_energy.sum();
  result.reducible_share = left > 0.0 ? 1.0 - result.flexible_energy.sum() / left : 0.0;
  result.flexible_p = sieve.flexible_p;
  const bool certain = result.flexible_t > kFlexibleWhite || result.flexible_p < kCertain;
  const Eigen::VectorXd reducible = result.law_energy - result.flexible_energy;
  // A few blocks with much motion may hold most of the energy, and make the mean uncertain.
  const double reducible_t = std::max(t_statistic(reducible), signed_rank_score(reducible));
  const bool above_ceiling = result.reducible_share > kMatters && certain && reducible_t > kCeilingRaw;
  if (evidence.noise_from_repeats) {
    test_repetition(p, evidence, result);
  }
  // The flexible model's error never exceeds the law's; repeatable residual counts as explainable.
  if (const double flexible = result.flexible_energy.sum(); flexible > 0.0) {
    result.flexible_energy *= (1.0 - std::max(result.reducible_share, 0.0)) * left / flexible;
  }
  const bool repeats_itself = result.lack_of_fit_p < kRepeatsItself && result.reducible_share > kMatters;
  result.lacks_something = above_ceiling || repeats_itself;
  return result;
}

auto explained_share(const Eigen::VectorXd& before, const Eigen::VectorXd& after, const Eigen::VectorXd& flexible)
    -> ExplainedShare {
  constexpr int kResamplings = 400;
  auto share_of = [](double e0, double e1, double floor) {
    const double reducible = e0 - std::min(e1, floor);
    return reducible > 0.0 ? (e0 - e1) / reducible : 0.0;
  };
  Random random(0x5A4E);
  const auto n = before.size();
  Eigen::VectorXd shares(kResamplings);
  for (double& share : shares) {
    double e0 = 0.0;
    double e1 = 0.0;
    double floor = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = std::min(n - 1, static_cast<Eigen::Index>(random.uniform() * static_cast<double>(n)));
      e0 += before[at];
      e1 += after[at];
      floor += flexible[at];
    }
    share = share_of(e0, e1, floor);
  }
  return {share_of(before.sum(), after.sum(), flexible.sum()), quantile(shares, 0.05)};
}

}  // namespace capstan::tools
