// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {

/// A law and how well it predicts.
template <typename Law>
struct ScoredLaw {
  Law law;
  double score = 0.0;  ///< mean squared error on rows that it was not fitted to
};

/// Laws of one kind, as far as growing them goes.
template <typename Law>
class LawFamily {
 public:
  LawFamily() = default;
  LawFamily(const LawFamily&) = delete;
  auto operator=(const LawFamily&) -> LawFamily& = delete;
  virtual ~LawFamily() = default;

  /// Infinity if it is no law.
  virtual auto score(const Law& law) -> double = 0;
  /// Every law with one thing more, with one less, and with one setting moved to a neighbour's.
  [[nodiscard]] virtual auto additions(const Law& law) const -> std::vector<Law> = 0;
  [[nodiscard]] virtual auto reductions(const Law& law) const -> std::vector<Law> = 0;
  [[nodiscard]] virtual auto variations(const Law& law) const -> std::vector<Law> = 0;
};

/// Grows a law by what lowers its error on unseen rows most, as long as that is worth a step; at the start and after
/// each step it is looked at whether something is superfluous or another setting serves better.
template <typename Law>
class Grower {
 public:
  Grower(LawFamily<Law>& family, const GrowthRules& rules) : family_(family), rules_(rules) {}

  /// The law after each step, the first without a step.
  auto run(const Law& start) -> std::vector<ScoredLaw<Law>> {
    std::vector<ScoredLaw<Law>> path = {settled({start, family_.score(start)})};
    for (int step = 0; step < rules_.most_steps; ++step) {
      ScoredLaw<Law> next = best_of(family_.additions(path.back().law));
      if (!(next.score < rules_.worth_a_step * path.back().score)) {
        break;
      }
      path.push_back(settled(std::move(next)));
    }
    return path;
  }

 private:
  auto best_of(const std::vector<Law>& laws) -> ScoredLaw<Law> {
    ScoredLaw<Law> best{{}, std::numeric_limits<double>::infinity()};
    for (const auto& law : laws) {
      if (const double here = family_.score(law); here < best.score) {
        best = {law, here};
      }
    }
    return best;
  }

  /// The law without what it does as well without, its settings where a neighbour does no better.
  auto settled(ScoredLaw<Law> law) -> ScoredLaw<Law> {
    constexpr int kMostMoves = 40;
    for (int move = 0; move < kMostMoves; ++move) {
      ScoredLaw<Law> less = best_of(family_.reductions(law.law));
      if (less.score < rules_.as_good * law.score) {
        law = std::move(less);
        continue;
      }
      ScoredLaw<Law> other = best_of(family_.variations(law.law));
      if (!(other.score < rules_.worth_a_move * law.score)) {
        break;
      }
      law = std::move(other);
    }
    return law;
  }

  LawFamily<Law>& family_;
  const GrowthRules& rules_;
};

}  // namespace capstan::tools
