// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"
#include "capstan/tools/select/choice.hpp"

namespace capstan::tools {

/// The motion that shows the most, where nothing narrower is known to be wanted.
inline constexpr const char* kEverything =
    "Record four equal cycles with reversals under several loads and at several speeds, and with holds.";

/// A verdict that names no effect, why, and what to record instead.
struct Nameless {
  Verdict verdict;
  std::string reason, next_experiment;
};
void say(const Nameless& why, Diagnosis& d);
/// @param reason  what is wrong, and behind a semicolon the cure
auto unfit(const std::string& what_for, const std::string& reason) -> Nameless;
/// Why no effect may be named whatever the search finds: too few strokes, or a base law that the logs can not
/// determine.
auto nameless(const Preparation& p, const LawForm& law) -> std::optional<Nameless>;
/// Parameters of a law that the logs can not determine. A Preisach table has cells that no motion but its recipe
/// visits; they take no part then. Nor do a table's knots, and parts of effects whose signal the logs lack.
auto undetermined(const Preparation& p, const LawForm& law) -> std::vector<std::string>;
/// Coefficients whose signal the logs lack, or whose knots they do not visit, stay those of the law that was given.
void keep_what_is_not_asked(const Preparation& p, const JointFile& given, JointFile& law);

/// Puts what the search found into words and decides what may be named, before any error is reported. Writes reason,
/// warnings and next experiment.
auto judge(const Search& search, Diagnosis& d) -> Verdict;

/// Takes `nothing_missing` back from a law that leaves more than it left of its own logs: cycles that differ from each
/// other by what has come to the joint make a high floor of it.
void hold_to_own_logs(const Preparation& p, const JointFile& law, Diagnosis& d);

/// What repeats and a flexible model call noise is no more than a healthy law left of its own logs: what comes and goes
/// in one cycle and not in the next, as a tip that touches, passes for noise with them.
void bound_floor_by(const JointFile& law, const Preparation& p, Diagnosis& d);

/// "play and gravity"
auto names_of(const std::vector<AddedEffect>& effects) -> std::string;

/// "The law lacks play and gravity", and how it goes on where the delivered law has more than these. @pre effects
auto what_the_law_lacks(const std::vector<AddedEffect>& effects) -> std::string;
inline constexpr const char* kMoreThanNamed = "; a law with more than that certainly predicts unseen rows better.";
inline constexpr const char* kAnotherPredictsBetter =
    "Something is missing from the law: another law certainly predicts unseen rows better, but this log does not show "
    "which effect it is.";

/// Number of the axis whose column a probe of the search is called by; nothing for other probes.
auto axis_of_probe(const std::string& probe) -> std::optional<int>;

/// That something is missing which has no name, and what it is most like, where that is known.
/// @param held_as  the term that the delivered law has for it, or nothing
auto reason_without_name(const std::string& unlisted, const std::string& held_as = "") -> std::string;

/// Whether the delivered law takes away no more of the base law's energy than an inexact form would where the running
/// switch knows the direction: what it gains in the rows between a reversal and its notice shows no effect.
auto gains_nothing(const Preparation& p, const Diagnosis& d) -> bool;

/// Makes the verdict agree with the law that is delivered and with the errors before and after: nothing is called
/// complete that another law betters for certain, or that leaves more than its floor, or in which an effect of a tenth
/// of the target could hide.
void reconcile(const Preparation& p, const Search& search, const LawChoice& choice, Diagnosis& d);

/// What the delivered law corrects without a name for it; nothing where it has no such part.
auto unnamed_part(const Preparation& p, const LawChoice& choice, const Diagnosis& d) -> std::optional<UnnamedPart>;

/// Effects that explain most of what the base law leaves, most first, with their shares of its energy.
auto candidate_shares(const Search& search) -> std::vector<CandidateShare>;

}  // namespace capstan::tools
