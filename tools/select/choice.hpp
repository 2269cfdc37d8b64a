// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/select/selection.hpp"

namespace capstan::tools {

/// Places in a selection of the base law, and of the law with the effects that were found, if any.
inline constexpr std::size_t kBasePlace = 0;
inline constexpr std::size_t kFoundPlace = 1;

/// Which law is delivered, and how sure it is.
struct LawChoice {
  JointFile law;      ///< fitted to all rows
  JointFile learned;  ///< chosen and fitted without the rows set aside, for the error that is reported
  LawStatus status = LawStatus::kBase;
  bool is_named = false;    ///< it is the law with the effects that were found
  int halves_agree = 0;     ///< of two: halves of the judged rows on which no other of the laws compared does better
  Selection selection;      ///< by all rows
  double unseen_rms = 0.0;  ///< what `law` left of rows that it was not fitted to, some of them later; 0: not asked
};

/// What the search for names says of the base law.
enum class Lacking : std::uint8_t { kNothing, kSomething };

/// Chooses the law of a joint angle among the base law, the law with the effects that were found, if any, and those
/// that are grown from the log's vocabulary. The found law where it costs next to nothing; else the base law where it
/// may be the best; else what errs least. Base and found law come with shapes that were refined already. Where that is
/// neither the found law nor the base law, or the base law lacks something for certain, laws are grown once more, from
/// the wider vocabulary and from the base law too: what has a good answer without it is not asked again, for with more
/// laws to choose from some of them make up for switches of the direction that a log's encoder shows late.
auto choose_law(const Preparation& p, const JointFile& base, const std::optional<JointFile>& found,
                Lacking lacking = Lacking::kNothing, const DecidingNumbers& numbers = {}) -> LawChoice;

/// The same among the base law and those that are one step of growth away from it.
auto choose_small_law(const Preparation& p, const JointFile& base) -> LawChoice;

}  // namespace capstan::tools
