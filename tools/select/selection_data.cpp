// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/selection_data.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/mean_sample.hpp"
#include "capstan/tools/select/play_start.hpp"
#include "capstan/tools/support/geometric_grid.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// The causal samples with the joint angle of the cycle before as `q2` has it.
auto running_on(const Preparation& p, const Eigen::VectorXd& q2) -> LawDesign {
  if (q2.size() == 0) {
    return p.causal;
  }
  std::vector<Samples> samples = p.causal.samples();
  Eigen::Index row = 0;
  for (auto& of_log : samples) {
    const Eigen::Index first = row;
    for (auto& sample : of_log) {
      sample.q2 = q2[std::max(first, row - 1)];
      ++row;
    }
  }
  return {p.logs, std::move(samples), p.causal.smoothing()};
}

struct Range {
  double least = 0.0, most = 0.0;
  explicit Range(const Eigen::VectorXd& values) : least(values.minCoeff()), most(values.maxCoeff()) {}
  [[nodiscard]] auto span() const -> double { return most - least; }
  [[nodiscard]] auto centre() const -> double { return 0.5 * (most + least); }
};

}  // namespace

SelectionData::SelectionData(const Preparation& p, const Catalogue& catalogue, const DecidingNumbers& numbers,
                             const Eigen::VectorXd& q2)
    : p_(p),
      causal_(running_on(p, q2)),
      catalogue_(&catalogue),
      numbers_(numbers),
      target_(decimated(p.target, p.factor)) {
  for (const auto& samples : causal_.samples()) {
    const auto rows = static_cast<Eigen::Index>(samples.size()) / p.factor;
    logs_.push_back({static_cast<Eigen::Index>(coarse_.size()), static_cast<Eigen::Index>(coarse_.size()) + rows});
    for (Eigen::Index row = 0; row < rows; ++row) {
      auto& mean = coarse_.emplace_back(
          mean_sample({&samples[static_cast<std::size_t>(row * p.factor)], static_cast<std::size_t>(p.factor)}));
      mean.h = mean.q1;
      mean.dh = mean.dq1;
    }
  }
  q1_.resize(rows());
  std::transform(coarse_.begin(), coarse_.end(), q1_.begin(), [](const auto& sample) { return sample.q1; });
  measure_ranges();
  settle();
  find_widths();
}

void SelectionData::measure_ranges() {
  const auto signal = [&](auto&& of) {
    Eigen::VectorXd values(rows());
    std::transform(coarse_.begin(), coarse_.end(), values.begin(), of);
    return Range(values);
  };
  const Range q1(q1_);
  const Range tau = signal([](const auto& s) { return s.tau; });
  ranges_.q1 = q1.span();
  ranges_.q1_centre = q1.centre();
  ranges_.tau = tau.span();
  ranges_.tau_centre = tau.centre();
  ranges_.period_s = causal_.period_s(0);
  ranges_.length_s = static_cast<double>(causal_.rows()) * ranges_.period_s;
  for (std::size_t other = 0; other < kMostOthers; ++other) {
    const Range range = signal([other](const auto& s) { return s.others[other].q1; });
    ranges_.others.push_back(range.span());
    ranges_.others_centre.push_back(range.centre());
  }
  measure_motion();
}

/// Of what tables are drawn over beside angles and torque.
void SelectionData::measure_motion() {
  Eigen::VectorXd rate(rows()), since(rows()), travelled(rows()), warmth(rows());
  for (const auto& log : logs_) {
    Eigen::Index turned = log.begin;
    for (Eigen::Index i = log.begin; i < log.end; ++i) {
      const auto& sample = coarse_[static_cast<std::size_t>(i)];
      turned = i > log.begin && sample.forward != coarse_[static_cast<std::size_t>(i) - 1].forward ? i : turned;
      rate[i] = sample.dq1;
      since[i] = static_cast<double>(i - turned) * p_.coarse_period_s;
      travelled[i] = std::abs(sample.q1 - sample.q1_reversal);
      warmth[i] = sample.warmth;
    }
  }
  const double outside = numbers_.share_outside_table;
  const double slowest = quantile(rate, outside);
  const double fastest = quantile(rate, 1.0 - outside);
  ranges_.rate = fastest - slowest;
  ranges_.rate_centre = 0.5 * (fastest + slowest);
  ranges_.since_s = quantile(since, 1.0 - outside);
  ranges_.travelled = quantile(travelled, 1.0 - outside);
  const Range warm(warmth);
  ranges_.warmth = warm.span();
  ranges_.warmth_centre = warm.centre();
}

void SelectionData::settle() {
  const int turns =
      turns_of_play(q1_, logs_, 0.5 * numbers_.way_of_a_stroke * ranges_.q1, numbers_.way_of_a_turn * ranges_.q1);
  if (turns < numbers_.turns_of_a_cycle || turns >= numbers_.turns_of_two_cycles) {
    settled_ = settled_rows(q1_, logs_, numbers_.settling);
    return;
  }
  settled_ = settled_rows(q1_, logs_, numbers_.settling_of_few_strokes);
  for (const auto& log : logs_) {
    starts_.push_back(start_of_plays(q1_.segment(log.begin, log.size()), target_.segment(log.begin, log.size())));
  }
}

void SelectionData::find_widths() {
  if (ranges_.q1 <= 0.0) {
    return;
  }
  for (const double width :
       geometric_grid(numbers_.narrowest_play * ranges_.q1, numbers_.widest_play * ranges_.q1, numbers_.play_widths)) {
    if (turns_of_play(q1_, logs_, width, numbers_.way_of_a_turn * ranges_.q1) >= numbers_.fewest_turns_of_play) {
      widths_.push_back(width);
    }
  }
}

auto SelectionData::lead_of_plays(double half_width) const -> Eigen::VectorXd {
  Eigen::VectorXd lead(causal_.rows());
  Eigen::Index row = 0;
  for (std::size_t log = 0; log < starts_.size(); ++log) {
    const Samples& samples = causal_.samples()[log];
    lead.segment(row, std::ssize(samples)) = lead_of_play(samples, half_width, starts_[log]);
    row += std::ssize(samples);
  }
  return causal_.smoothed(lead);
}

auto SelectionData::columns(const TermChoice& choice, const TermChoice* output) -> const Eigen::MatrixXd& {
  const std::string key = key_of(choice) + (output != nullptr ? "|" + key_of(*output) : "");
  const auto [found, is_new] = kept_.try_emplace(key);
  if (is_new) {
    Eigen::MatrixXd columns = causal_.columns(catalogue_->term(choice.term), choice.shapes);
    if (choice.term == "play" && !starts_.empty()) {
      columns.col(0) += lead_of_plays(choice.shapes.front());
    }
    if (output != nullptr) {
      columns = causal_.apply(catalogue_->term(output->term), output->shapes, columns);
    }
    found->second = decimated(columns, p_.factor);
  }
  return found->second;
}

auto SelectionData::columns_at(const TermChoice& choice, const Eigen::VectorXd& h) -> Eigen::MatrixXd {
  for (Eigen::Index row = 0; row < h.size(); ++row) {
    coarse_[static_cast<std::size_t>(row)].h = h[row];
  }
  return catalogue_->term(choice.term).columns(coarse_, p_.coarse_period_s, choice.shapes);
}

}  // namespace capstan::tools
