// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/thinned_design.hpp"

#include <algorithm>

#include "capstan/tools/identify/mean_sample.hpp"

namespace capstan::tools {
namespace {

/// The two filters that a causal sample's torque and acceleration went through (SampleConditioner): the second one's
/// gain is in the sample, and its time constant is four times the first one's.
class Lateness {
 public:
  Lateness(double late_gain, double period_s) : second_(late_gain > 0.0 ? late_gain : 1.0) {
    first_ = SamplePeriod<double>(period_s).filter_gain(0.25 * period_s * (1.0 / second_ - 1.0));
  }
  /// Through both.
  [[nodiscard]] auto of(const Eigen::VectorXd& signal) const -> Eigen::VectorXd {
    return filtered(filtered(signal, first_), second_);
  }
  void delay(Samples& samples) const {
    const auto through_both = [&](double Sample<double>::*member) {
      Eigen::VectorXd signal(static_cast<Eigen::Index>(samples.size()));
      std::transform(samples.begin(), samples.end(), signal.begin(), [&](const auto& s) { return s.*member; });
      signal = of(signal);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].*member = signal[static_cast<Eigen::Index>(i)];
      }
    };
    through_both(&Sample<double>::q1);
    through_both(&Sample<double>::h);
  }

 private:
  static auto filtered(Eigen::VectorXd signal, double gain) -> Eigen::VectorXd {
    for (Eigen::Index i = 1; i < signal.size(); ++i) {
      signal[i] = signal[i - 1] + gain * (signal[i] - signal[i - 1]);
    }
    return signal;
  }
  double first_ = 1.0;
  double second_;
};

}  // namespace

auto thinned(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, Eigen::Index wanted)
    -> Thinned {
  const Eigen::Index factor = std::max<Eigen::Index>(1, rows_in(rows) / wanted);
  std::vector<Samples> samples;
  std::vector<double> periods;
  std::vector<Eigen::Index> place(static_cast<std::size_t>(design.rows()) + 1);  // of each row among the means
  std::vector<double> means;
  Eigen::Index begin = 0;
  for (std::size_t log = 0; log < design.samples().size(); ++log) {
    Samples all = design.samples()[log];
    const Lateness late(all.empty() ? 0.0 : all.front().late_gain, design.period_s(log));
    late.delay(all);
    const Eigen::VectorXd seen = late.of(target.segment(begin, static_cast<Eigen::Index>(all.size())));
    const auto count = static_cast<Eigen::Index>(all.size()) / factor;
    Samples own;
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(all.size()); ++i) {
      place[static_cast<std::size_t>(begin + i)] =
          static_cast<Eigen::Index>(means.size()) + std::min(i / factor, count);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      own.push_back(mean_sample({&all[static_cast<std::size_t>(i * factor)], static_cast<std::size_t>(factor)}));
      own.back().late_gain = 0.0;
      means.push_back(seen.segment(i * factor, factor).mean());
    }
    begin += static_cast<Eigen::Index>(all.size());
    samples.push_back(std::move(own));
    periods.push_back(design.period_s(log) * static_cast<double>(factor));
  }
  place.back() = static_cast<Eigen::Index>(means.size());
  Blocks kept;
  for (const auto& block : rows) {
    const RowRange coarse = {place[static_cast<std::size_t>(block.begin)],
                             place[static_cast<std::size_t>(block.end - 1)]};
    if (coarse.size() > 0) {
      kept.push_back(coarse);
    }
  }
  return {LawDesign(std::move(samples), std::move(periods)),
          Eigen::Map<const Eigen::VectorXd>(means.data(), static_cast<Eigen::Index>(means.size())), std::move(kept)};
}

}  // namespace capstan::tools
