// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/choice.hpp"

#include <algorithm>

namespace capstan::tools {
namespace {

constexpr std::size_t kBasePlace = 0;
constexpr std::size_t kFoundPlace = 1;

class Chooser {
 public:
  Chooser(const Preparation& p, const JointFile& base, const std::optional<JointFile>& found,
          const DecidingNumbers& numbers)
      : p_(p),
        base_(base),
        found_(found),
        data_(p, *base.catalogue, numbers, estimates(p.logs, p.causal, found ? *found : base)) {
    given_ = {candidate_of(form_of(base))};
    if (found) {
      given_.push_back(candidate_of(form_of(*found)));
    }
  }

  auto run() -> LawChoice {
    const Blocks learned = p_.split.learned();
    const Selection by_learned = select_law(data_, learned, given_);
    LawChoice choice;
    choice.learned = law_of(by_learned, learned);
    choice.selection = select_law(data_, data_.logs(), given_);
    const std::size_t place = delivered(choice.selection);
    choice.law = law_of(choice.selection, data_.logs());
    choice.is_named = found_ && place == kFoundPlace;
    choice.status =
        choice.is_named ? LawStatus::kConfirmed : (place == kBasePlace ? LawStatus::kBase : LawStatus::kProvisional);
    if (choice.status == LawStatus::kBase) {
      choice.learned = base_;  // what is delivered is what is reported on
    }
    choice.law.status = choice.learned.status = choice.status;
    for (std::size_t half = 0; half < 2; ++half) {
      choice.halves_agree += agrees(choice.selection, place, half) ? 1 : 0;
    }
    return choice;
  }

 private:
  /// Which of the laws that were judged is delivered.
  auto delivered(const Selection& selection) const -> std::size_t {
    const double best = selection.laws[selection.best].score;
    const auto& found = selection.laws[std::min(kFoundPlace, selection.laws.size() - 1)];
    if (found_ && found.score <= data_.numbers().worth_a_name * best) {
      return kFoundPlace;
    }
    const JudgedLaw& base = selection.laws[kBasePlace];
    return base.in_set && base.score <= data_.numbers().worth_a_law * best ? kBasePlace : selection.best;
  }

  auto agrees(const Selection& selection, std::size_t place, std::size_t half) const -> bool {
    const double own = selection.laws[place].halves[half];
    return std::all_of(selection.laws.begin(), selection.laws.end(),
                       [&](const auto& other) { return own <= data_.numbers().worth_a_name * other.halves[half]; });
  }

  auto law_of(const Selection& selection, const Blocks& rows) -> JointFile {
    const std::size_t place = delivered(selection);
    if (place == kBasePlace) {
      return base_;
    }
    if (found_ && place == kFoundPlace) {
      return *found_;
    }
    JointFile joint = joint_of(data_, rows, selection.laws[place].law, base_.parameters.conditioner);
    describe_logs(p_.logs, p_.causal, p_.target, estimates(p_.logs, p_.causal, joint), joint);
    return joint;
  }

  const Preparation& p_;
  const JointFile& base_;
  const std::optional<JointFile>& found_;
  SelectionData data_;
  std::vector<LawCandidate> given_;
};

}  // namespace

auto choose_law(const Preparation& p, const JointFile& base, const std::optional<JointFile>& found,
                const DecidingNumbers& numbers) -> LawChoice {
  return Chooser(p, base, found, numbers).run();
}

}  // namespace capstan::tools
