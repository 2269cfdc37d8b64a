// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/choice.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// What an estimate leaves of the rows whose direction is known.
auto mean_square_left(const Preparation& p, const Eigen::VectorXd& estimate) -> double {
  double left = 0.0;
  const Blocks rows = p.certain();
  for (const auto& block : rows) {
    left += (p.target - estimate).segment(block.begin, block.size()).squaredNorm();
  }
  return left / static_cast<double>(rows_in(rows));
}

class Chooser {
 public:
  Chooser(const Preparation& p, const JointFile& base, const std::optional<JointFile>& found,
          const DecidingNumbers& numbers)
      : p_(p),
        base_(base),
        found_(found),
        running_(estimates(p.logs, p.causal, found ? *found : base)),
        left_running_(found && found->has("gravity") ? mean_square_left(p, running_) : 0.0),
        data_(p, *base.catalogue, numbers, running_),
        learned_(data_, p.split.learned()),
        whole_(data_, data_.logs()) {
    given_ = {candidate_of(form_of(base))};
    if (found) {
      given_.push_back(candidate_of(form_of(*found)));
    }
    learned_.forward.limit_as(given_.front());
    whole_.forward.limit_as(given_.front());
  }

  auto run(Lacking lacking) -> LawChoice {
    for (Judged* judged : {&learned_, &whole_}) {
      select(given_, angle_vocabulary(data_), *judged);
    }
    const std::size_t place = whole_.delivered;
    if (place == kBasePlace ? lacking == Lacking::kSomething : !is_found(place)) {
      for (Judged* judged : {&learned_, &whole_}) {
        ask_again(*judged);
      }
    }
    return choice();
  }

 private:
  /// A choice from some of the rows.
  struct Judged {
    Judged(SelectionData& data, const Blocks& of) : rows(of), forward(data, of) {}
    Blocks rows;
    ForwardScore forward;
    Selection selection;
    std::size_t delivered = kBasePlace;
    bool base_may_stay = true;  ///< it has not lost to another law yet
  };

  [[nodiscard]] auto is_found(std::size_t place) const -> bool { return found_ && place == kFoundPlace; }

  void select(const std::vector<LawCandidate>& laws, const Vocabulary& vocabulary, Judged& judged) const {
    judged.selection = select_law(judged.forward, laws, vocabulary);
    judge_as_it_runs(judged.selection);
    judged.delivered = delivered(judged.selection, judged.base_may_stay);
    judged.base_may_stay = judged.delivered == kBasePlace;
  }

  /// A weight reads the law's own angle. Columns of an angle so near the target predict more than the law does that
  /// they make, so a found law with a weight counts as what it leaves when it runs.
  void judge_as_it_runs(Selection& selection) const {
    if (left_running_ == 0.0) {
      return;
    }
    JudgedLaw& found = selection.laws[kFoundPlace];
    found.score = std::max(found.score, left_running_);
    const auto least = std::min_element(selection.laws.begin(), selection.laws.end(),
                                        [](const auto& a, const auto& b) { return a.score < b.score; });
    selection.best = static_cast<std::size_t>(least - selection.laws.begin());
  }

  /// With the wider vocabulary, from the base law and from the best law so far, and beside all laws so far. With so
  /// much more to choose from the least error is lucky: the law so far stays unless it errs more by a standard error.
  void ask_again(Judged& judged) {
    const Selection so_far = judged.selection;
    const std::size_t place = judged.delivered;
    std::vector<LawCandidate> laws = given_;
    for (std::size_t i = given_.size(); i < judged.selection.laws.size(); ++i) {
      laws.push_back(judged.selection.laws[i].law);
    }
    std::vector<LawCandidate> starts = {given_.front()};
    if (judged.selection.best != kBasePlace) {
      starts.push_back(judged.selection.laws[judged.selection.best].law);
    }
    select(laws, wider_vocabulary(data_, std::move(starts)), judged);
    const LawCandidate& before = so_far.laws[place].law;
    const LawCandidate& now = judged.selection.laws[judged.delivered].law;
    if (!(now == before) && !errs_less(judged.forward, now, before)) {
      judged.selection = so_far;
      judged.delivered = place;
    }
  }

  /// By more than the standard error of the difference, over runs of pieces.
  [[nodiscard]] auto errs_less(ForwardScore& forward, const LawCandidate& law, const LawCandidate& other) const
      -> bool {
    const Eigen::VectorXd gain = decimated(forward.losses(other) - forward.losses(law), data_.numbers().run);
    const auto runs = static_cast<double>(gain.size());
    const double spread = std::sqrt((gain.array() - gain.mean()).square().sum() / (runs - 1.0));
    return gain.mean() > spread / std::sqrt(runs);
  }

  auto choice() -> LawChoice {
    const std::size_t place = whole_.delivered;
    LawChoice choice;
    choice.is_named = is_found(place);
    choice.status =
        choice.is_named ? LawStatus::kConfirmed : (place == kBasePlace ? LawStatus::kBase : LawStatus::kProvisional);
    // What is delivered is what is reported on.
    choice.learned = choice.status == LawStatus::kBase ? base_ : law_of(learned_);
    choice.law = law_of(whole_);
    choice.law.status = choice.learned.status = choice.status;
    choice.selection = whole_.selection;
    choice.unseen_rms = std::sqrt(whole_.selection.laws[place].score);
    for (std::size_t half = 0; half < 2; ++half) {
      choice.halves_agree += agrees(choice.selection, place, half) ? 1 : 0;
    }
    return choice;
  }

  /// Which of the laws that were judged is delivered.
  [[nodiscard]] auto delivered(const Selection& selection, bool base_may_stay) const -> std::size_t {
    const double best = selection.laws[selection.best].score;
    const auto& found = selection.laws[std::min(kFoundPlace, selection.laws.size() - 1)];
    if (found_ && found.score <= data_.numbers().worth_a_name * best) {
      return kFoundPlace;
    }
    const JudgedLaw& base = selection.laws[kBasePlace];
    const bool stays = base_may_stay && base.in_set && base.score <= data_.numbers().worth_a_law * best;
    return stays ? kBasePlace : selection.best;
  }

  auto agrees(const Selection& selection, std::size_t place, std::size_t half) const -> bool {
    const double own = selection.laws[place].halves[half];
    return std::all_of(selection.laws.begin(), selection.laws.end(),
                       [&](const auto& other) { return own <= data_.numbers().worth_a_name * other.halves[half]; });
  }

  auto law_of(const Judged& judged) -> JointFile {
    if (judged.delivered == kBasePlace) {
      return base_;
    }
    if (is_found(judged.delivered)) {
      return *found_;
    }
    const LawCandidate& law = judged.selection.laws[judged.delivered].law;
    JointFile joint = joint_of(data_, judged.rows, law, base_.parameters.conditioner);
    describe_logs(p_.logs, p_.causal, p_.target, estimates(p_.logs, p_.causal, joint), joint);
    return joint;
  }

  const Preparation& p_;
  const JointFile& base_;
  const std::optional<JointFile>& found_;
  Eigen::VectorXd running_;  ///< the estimate of the found law, or else of the base law
  double left_running_;      ///< what that leaves of a found law with a weight, mean square; 0 of others
  SelectionData data_;
  std::vector<LawCandidate> given_;
  Judged learned_, whole_;
};

}  // namespace

auto choose_law(const Preparation& p, const JointFile& base, const std::optional<JointFile>& found, Lacking lacking,
                const DecidingNumbers& numbers) -> LawChoice {
  return Chooser(p, base, found, numbers).run(lacking);
}

auto choose_small_law(const Preparation& p, const JointFile& base) -> LawChoice {
  DecidingNumbers numbers;
  numbers.growth.most_steps = 1;
  return choose_law(p, base, std::nullopt, Lacking::kNothing, numbers);
}

}  // namespace capstan::tools
