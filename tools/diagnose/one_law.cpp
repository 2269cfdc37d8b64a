// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/one_law.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Whether a slice is there to judge by; the others are fitted to and choose. By the parity of its number's ones (Thue
/// and Morse), which has no period: slices that took turns would be the same stretches of every cycle.
auto judges(std::size_t slice) -> bool {
  return std::popcount(slice) % 2 == 1;
}

/// Slices from `begin` to `end`, of either kind.
auto slices_between(const Blocks& slices, std::size_t begin, std::size_t end, bool judging) -> Blocks {
  Blocks some;
  for (std::size_t i = begin; i < end; ++i) {
    if (judges(i) == judging) {
      some.push_back(slices[i]);
    }
  }
  return some;
}

/// Products of a law's columns and the target over some rows.
struct RowProducts {
  Eigen::MatrixXd gram;
  Eigen::VectorXd with_target;
  double energy = 0.0;

  [[nodiscard]] auto left(const Eigen::VectorXd& theta) const -> double {
    return std::max(0.0, energy - 2.0 * with_target.dot(theta) + theta.dot(gram * theta));
  }
};

/// A law at a first look: fitted to any of the slices, its shapes along a straight line.
class SlicedLaw {
 public:
  SlicedLaw(const Preparation& p, const LawForm& form, const Blocks& slices) {
    const Eigen::MatrixXd plain = law_columns(p.noncausal, form);
    const LinearFit fit = fit_columns(plain, p.target, p.certain(), law_signs(form));
    Eigen::MatrixXd columns = p.coarse(with_sensitivities(p.noncausal, form, fit.theta, plain));
    const Eigen::RowVectorXd sizes = columns.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
    columns = columns.array().rowwise() / sizes.array();
    const Eigen::VectorXd target = p.coarse(p.target);
    for (const auto& slice : slices) {
      const auto x = columns.middleRows(slice.begin, slice.size());
      const auto y = target.segment(slice.begin, slice.size());
      products_.push_back({x.transpose() * x, x.transpose() * y, y.squaredNorm()});
    }
    whole_ = fitted(0, products_.size());
  }

  [[nodiscard]] auto numbers() const -> Eigen::Index { return products_.front().with_target.size(); }

  /// Fitted to those slices from `begin` to `end` that do not judge.
  [[nodiscard]] auto fitted(std::size_t begin, std::size_t end) const -> Eigen::VectorXd {
    constexpr double kRidge = 1e-9;  // columns that the part does not tell apart
    RowProducts sum{0.0 * products_.front().gram, 0.0 * products_.front().with_target};
    for (std::size_t i = begin; i < end; ++i) {
      if (!judges(i)) {
        sum.gram += products_[i].gram;
        sum.with_target += products_[i].with_target;
      }
    }
    sum.gram.diagonal().array() += kRidge * sum.gram.trace();
    return sum.gram.ldlt().solve(sum.with_target);
  }

  /// Energy left of slices of either kind by a law for the part before slice `at` and one for the part behind it; that
  /// slice, in which the joint may have changed, is no part of either.
  [[nodiscard]] auto left_by_two(std::size_t at, bool judging) const -> double {
    const Eigen::VectorXd before = fitted(0, at);
    const Eigen::VectorXd behind = fitted(at + 1, products_.size());
    return left(0, at, before, judging) + left(at + 1, products_.size(), behind, judging);
  }
  /// The same by one law for all.
  [[nodiscard]] auto left_by_one(std::size_t at, bool judging) const -> double {
    return left(0, at, whole_, judging) + left(at + 1, products_.size(), whole_, judging);
  }

 private:
  [[nodiscard]] auto left(std::size_t begin, std::size_t end, const Eigen::VectorXd& theta, bool judging) const
      -> double {
    double energy = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      energy += judges(i) == judging ? products_[i].left(theta) : 0.0;
    }
    return energy;
  }

  std::vector<RowProducts> products_;
  Eigen::VectorXd whole_;  ///< fitted to all of the log
};

/// A law and the slice that the joint changes in.
struct LawSplit {
  std::size_t law = 0, at = 0;
};

/// Which law and which slice leave least of the slices that do not judge. The slice itself counts as one law leaves it,
/// or the one with the most energy would be the best to be without.
auto best_split(const std::vector<SlicedLaw>& laws, std::size_t slices) -> LawSplit {
  LawSplit best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t law = 0; law < laws.size(); ++law) {
    if (laws[law].numbers() > kMostNumbersOfAPart) {
      continue;
    }
    const double whole = laws[law].left_by_one(slices, false);
    for (std::size_t at = kSlicesOfAPart; at + kSlicesOfAPart < slices; ++at) {
      const double left = laws[law].left_by_two(at, false) + (whole - laws[law].left_by_one(at, false));
      if (left < least) {
        least = left;
        best = {law, at};
      }
    }
  }
  return best;
}

/// Samples of coarse rows whose direction is known.
auto certain_samples(const Preparation& p, const Blocks& coarse) -> Blocks {
  std::vector<bool> certain(static_cast<std::size_t>(p.coarse_logs.back().end), true);
  for (const auto& doubtful : p.uncertain) {
    std::fill(certain.begin() + doubtful.begin, certain.begin() + std::min(doubtful.end, p.coarse_logs.back().end),
              false);
  }
  Blocks samples;
  for (const auto& block : coarse) {
    for (Eigen::Index row = block.begin; row < block.end; ++row) {
      if (certain[static_cast<std::size_t>(row)]) {
        samples.push_back({row * p.factor, (row + 1) * p.factor});
      }
    }
  }
  return unbroken(samples);
}

/// A law as it fits some samples best, its shapes too, and what it gives over all of them.
struct FittedPart {
  LawForm form;
  Eigen::VectorXd estimate;
};

auto fitted_part(const Preparation& p, const LawForm& law, const Blocks& coarse) -> FittedPart {
  const Blocks rows = certain_samples(p, coarse);
  FittedPart part{refine_shapes(p.noncausal, p.target, rows, law), {}};
  const Eigen::MatrixXd columns = law_columns(p.noncausal, part.form);
  part.estimate = columns * fit_columns(columns, p.target, rows, law_signs(part.form)).theta;
  return part;
}

/// The first sample about a slice that the second of two laws fits better than the first.
auto row_of_change(const Preparation& p, const Blocks& slices, std::size_t at, const Eigen::VectorXd& before,
                   const Eigen::VectorXd& behind) -> Eigen::Index {
  const RowRange about{slices[at - 1].begin * p.factor, slices[at + 1].end * p.factor};
  double sum = 0.0;
  double least = 0.0;
  Eigen::Index row = about.begin;
  for (Eigen::Index i = about.begin; i < about.end; ++i) {
    const double a = p.target[i] - before[i];
    const double b = p.target[i] - behind[i];
    sum += a * a - b * b;
    if (sum < least) {
      least = sum;
      row = i + 1;
    }
  }
  return row;
}

/// The usual law with a gap: whatever was chosen as one law for a joint that changes need not be a law of either part.
auto usual_law_with_gap(const Preparation& p) -> LawForm {
  const bool torque = std::all_of(p.logs.begin(), p.logs.end(), [](const auto& log) { return log.has_torque; });
  LawForm law = form_of_model(torque ? kDefaultModel : "kinematic", p.logs);
  law.terms.emplace_back("play");
  return search_shapes(p.noncausal, p.target, p.certain(), law);
}

/// What moved from one part to the other, by the law fitted to each of them.
auto moved_in(const Preparation& p, const LawForm& before, const LawForm& behind, const Blocks& slices, std::size_t at)
    -> std::vector<MovedParameter> {
  const auto fitted = [&](const LawForm& form, auto begin, auto end) {
    const Blocks rows = certain_samples(p, Blocks(begin, end));
    const Eigen::MatrixXd columns = law_columns(p.noncausal, form);
    const Eigen::VectorXd left = p.target - columns * fit_columns(columns, p.target, rows, law_signs(form)).theta;
    return law_with_intervals(p.noncausal, p.target, interval_blocks(rows, left), form, p.conditioner);
  };
  const auto split = slices.begin() + static_cast<std::ptrdiff_t>(at);
  return moved_between(fitted(before, slices.begin(), split), fitted(behind, split + 1, slices.end()));
}

/// The change, its law's shapes searched for in each part. Nothing where two laws do not leave far less for certain.
auto confirmed_change(const Preparation& p, const LawForm& law, const Blocks& slices, std::size_t at,
                      const Eigen::VectorXd& one) -> std::optional<ChangedJoint> {
  const std::size_t n = slices.size();
  const FittedPart before = fitted_part(p, law, slices_between(slices, 0, at, false));
  const FittedPart behind = fitted_part(p, law, slices_between(slices, at + 1, n, false));
  Eigen::VectorXd two = before.estimate;
  const Eigen::Index from = slices[at].begin * p.factor;
  two.tail(two.size() - from) = behind.estimate.tail(two.size() - from);
  Blocks judging = slices_between(slices, 0, at, true);
  const Blocks later = slices_between(slices, at + 1, n, true);
  judging.insert(judging.end(), later.begin(), later.end());
  const Eigen::VectorXd target = p.coarse(p.target);
  const Eigen::VectorXd by_one = p.coarse(one);
  const Eigen::VectorXd by_two = p.coarse(two);
  if (ratio_interval(target, judging, by_one, by_two)[1] > kTwoLawsLeave) {
    return std::nullopt;
  }
  ChangedJoint changed{law, row_of_change(p, slices, at, before.estimate, behind.estimate),
                       rms(stacked(target - by_one, judging)), rms(stacked(target - by_two, judging))};
  changed.moved = moved_in(p, before.form, behind.form, slices, at);
  return changed;
}

/// "time_s 20.02 on (row 4005 of run.csv)". Rows of a long rest take no part, and without them a row's number is
/// another one.
auto when(const Preparation& p, Eigen::Index row) -> std::string {
  std::size_t log = 0;
  while (row >= p.logs[log].samples() && log + 1 < p.logs.size()) {
    row -= p.logs[log].samples();
    ++log;
  }
  const AxisLog& in = p.logs[log];
  row = std::min(row, in.samples() - 1);
  const double spanned = (in.time_s[row] - in.time_s[0]) / in.period_s;
  const bool all_rows = std::abs(spanned - static_cast<double>(row)) < 0.5;
  const std::string place = all_rows ? "row " + std::to_string(row + 1) + " of " + in.name : in.name;
  return "time_s " + rounded(in.time_s[row]) + " (" + place + ")";
}

}  // namespace

auto joint_that_changed(const Preparation& p, const std::vector<LawForm>& laws) -> std::optional<ChangedJoint> {
  if (rows_in(p.coarse_logs) < kRowsOfASlice * kLogSlices) {
    return std::nullopt;
  }
  const Blocks slices = even_parts(p.coarse_logs, kLogSlices);
  std::vector<LawForm> asked;
  const auto ask = [&asked](LawForm law) {
    law.held.clear();  // what one law need not move a change may
    const auto same = [&law](const LawForm& other) { return law.terms == other.terms && law.shapes == other.shapes; };
    if (std::none_of(asked.begin(), asked.end(), same)) {
      asked.push_back(std::move(law));
    }
  };
  std::for_each(laws.begin(), laws.end(), ask);
  if (std::none_of(laws.begin(), laws.end(), [](const auto& law) { return law.has("play"); })) {
    ask(usual_law_with_gap(p));
  }
  std::vector<SlicedLaw> sliced;
  std::transform(asked.begin(), asked.end(), std::back_inserter(sliced),
                 [&](const auto& law) { return SlicedLaw(p, law, slices); });
  const LawSplit split = best_split(sliced, slices.size());
  std::size_t best = 0;  // as one law; of rows that judge, which is to the disadvantage of a change
  for (std::size_t law = 0; law < sliced.size(); ++law) {
    best = sliced[law].left_by_one(split.at, true) < sliced[best].left_by_one(split.at, true) ? law : best;
  }
  const double one = sliced[best].left_by_one(split.at, true);
  if (sliced[split.law].left_by_two(split.at, true) > kWorthTwoLaws * kWorthTwoLaws * one) {
    return std::nullopt;
  }
  const FittedPart whole = fitted_part(p, asked[best], slices_between(slices, 0, slices.size(), false));
  return confirmed_change(p, asked[split.law], slices, split.at, whole.estimate);
}

void say_changed(const Preparation& p, const ChangedJoint& changed, Diagnosis& d) {
  constexpr std::size_t kMostSaid = 3;
  std::vector<std::string> moved;
  for (std::size_t i = 0; i < std::min(kMostSaid, changed.moved.size()); ++i) {
    moved.push_back(moved_sentence(changed.moved[i]));
  }
  std::string reason = "The joint changed at " + when(p, changed.row) +
                       ": on unseen rows one law for all of the log leaves an error of " +
                       rounded(changed.one_leaves, 3) + " " + d.unit + ", a law for each part " +
                       rounded(changed.two_leave, 3);
  reason += moved.empty() ? "." : "; " + joined(moved, "; ") + ".";
  say({Verdict::kUnknown, reason,
       "Split the log there and diagnose its parts separately (capstan compare BEFORE -- AFTER shows what changed), or "
       "find the change (a sheath's bend, a gap, the load, a slip) and record four equal cycles without it."},
      d);
  d.changed_at = changed.row;
  d.effects.clear();
  d.detectable.clear();
  if (d.law.status == LawStatus::kConfirmed) {
    d.law.status = LawStatus::kProvisional;
  }
  if (changed.two_leave < d.noise_floor) {
    d.noise_floor = changed.two_leave;
    d.floor_from = "laws of the parts";
  }
}

auto longer_part(const AxisLog& log, Eigen::Index changes_at) -> AxisLog {
  constexpr double kAboutEqual = 0.9;
  const auto before = static_cast<double>(changes_at);
  const auto behind = static_cast<double>(log.samples() - changes_at);
  return behind >= kAboutEqual * before ? rows_from(log, changes_at) : first_rows(log, changes_at);
}

void take_law_of_part(Diagnosis part, const AxisLog& log, Diagnosis& d) {
  if (part.verdict == Verdict::kDataUnfit || part.verdict == Verdict::kNotIdentifiable ||
      part.traces.after.size() == 0) {
    return;
  }
  if (part.law.status == LawStatus::kConfirmed) {  // of the part; no name is certain of a joint that changes
    part.law.status = LawStatus::kProvisional;
    part.candidates.clear();
    std::transform(part.effects.begin(), part.effects.end(), std::back_inserter(part.candidates),
                   [](const auto& effect) {
                     return CandidateShare{effect.name, effect.explained};
                   });
  }
  const std::string where = "time_s " + rounded(log.time_s[0]) + " to " + rounded(log.time_s[log.samples() - 1]);
  d.reason += " The law is that of the part from " + where + " alone, and so are the errors before and after.";
  part.verdict = d.verdict;
  part.reason = d.reason;
  part.next_experiment = d.next_experiment;
  part.changed_at = d.changed_at;
  part.samples = d.samples;
  part.warnings = d.warnings;
  part.effects.clear();
  part.detectable.clear();
  d = std::move(part);
}

}  // namespace capstan::tools
