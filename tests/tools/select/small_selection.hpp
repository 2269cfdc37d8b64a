// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tests/tools/diagnose/small_evidence.hpp"
#include "capstan/tests/tools/play_operator.hpp"
#include "capstan/tools/select/forward_score.hpp"

namespace capstan::tools::test {

/// Few parts and no rows left out for settling, so that scores can be written out.
inline auto few_parts() -> DecidingNumbers {
  DecidingNumbers numbers;
  numbers.settling.most_share_of_rows = numbers.settling_of_few_strokes.most_share_of_rows = 0.0;
  numbers.parts = 4;
  numbers.first_judged_part = 2;
  numbers.parts_left_out = 2;
  numbers.pieces_per_part = 2;
  numbers.run = 1;
  numbers.resamplings = 100;
  return numbers;
}

/// A log whose motor angles are these; it moves forward where they grow.
inline auto samples_of(const Eigen::VectorXd& q1) -> Samples {
  Samples samples(static_cast<std::size_t>(q1.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    samples[i].q1 = samples[i].h = q1[row];
    samples[i].forward = row == 0 || q1[row] >= q1[row - 1];
    samples[i].dq1 = samples[i].dh = row == 0 ? 0.0 : q1[row] - q1[row - 1];
  }
  return samples;
}

/// Two logs of one joint, each with a run of its own.
inline auto preparation_of_both(const Eigen::VectorXd& first, const Eigen::VectorXd& second,
                                const Eigen::VectorXd& target) -> Preparation {
  Eigen::VectorXd q1(first.size() + second.size());
  q1 << first, second;
  Preparation p = preparation_of(samples_of(q1), target, {});
  p.causal = p.noncausal = LawDesign({samples_of(first), samples_of(second)}, {1.0, 1.0});
  return p;
}

/// Two sines without a common period, from -1.4 to 1.4.
inline auto two_sines(Eigen::Index rows) -> Eigen::VectorXd {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(rows, 0.0, 0.05 * static_cast<double>(rows - 1));
  return ((1.3 * t).sin() + 0.4 * (3.1 * t).sin()).matrix();
}

/// One log as the choice of a law sees it, a sample per coarse row.
struct SmallSelection {
  SmallSelection(Samples samples, const Eigen::VectorXd& target, const DecidingNumbers& numbers = few_parts())
      : p(preparation_of(std::move(samples), target, split_of(1, target.size(), {Role::kFit}))),
        data(p, term_catalogue(), numbers) {}
  SmallSelection(const Eigen::VectorXd& q1, const Eigen::VectorXd& target, const DecidingNumbers& numbers = few_parts())
      : SmallSelection(samples_of(q1), target, numbers) {}
  SmallSelection(const SmallSelection&) = delete;
  auto operator=(const SmallSelection&) -> SmallSelection& = delete;
  ~SmallSelection() = default;

  Preparation p;
  SelectionData data;
  ForwardScore forward{data, data.logs()};
};

inline auto law_of(const std::vector<TermChoice>& terms, const std::vector<double>& plays = {}) -> LawCandidate {
  LawCandidate law;
  for (const auto& choice : terms) {
    law = with_term(term_catalogue(), law, choice);
  }
  law.plays = plays;
  return law;
}

/// What every law begins with.
inline auto ratio_law() -> LawCandidate {
  return law_of({{"motor_angle", {}}, {"joint_offset", {}}});
}

}  // namespace capstan::tools::test
