// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/model/force_estimate.hpp"
#include "capstan/model/reversal_surface.hpp"

namespace capstan {

/// What is assumed about the past until the input has been at an end of the table for the first time.
enum class StartState : std::uint8_t {
  kNegativeSaturation,  ///< the input rose from the lower end: exact if it did
  kPositiveSaturation,  ///< the input fell from the upper end: exact if it did
  kDemagnetised,  ///< ever smaller swings about the middle of the grid: halfway between what the past could have been
};

/// Classical Preisach model from first-order reversal values, (4.4) and (4.5):
///   f = f- + sum_{k<n} (f_{a_k b_k} - f_{a_k b_{k-1}}) + f*,
///   f* = f_{a_n u} - f_{a_n b_{n-1}} falling, f_{u u} - f_{u b_{n-1}} rising.
/// The thesis starts from -f+, which assumes symmetric saturations; here the sum starts from the measured lower one,
/// f-. The remembered extremes (a_k falling, b_k rising) are a stack; each keeps the sum up to itself, so a step costs
/// one or two table look-ups however deep the stack is. Peaks and valleys are nested, so what a step wipes out is found
/// by halving: six comparisons for sixty loops. No allocation; every loop is bounded by the bits of Depth or MaxLevels.
/// @tparam MaxLevels  largest grid   @tparam Depth  most extremes remembered, the lower saturation included
template <typename Scalar, std::size_t MaxLevels, std::size_t Depth = 64>
class Preisach {
  static_assert(Depth >= 4);

 public:
  using Table = ReversalTable<Scalar, MaxLevels>;

  /// @param table  must outlive the model. A table that `check` refuses with this tolerance makes every step report
  /// `beyond_table` and force zero; ask `check` why.
  constexpr explicit Preisach(const Table& table, StartState start = StartState::kNegativeSaturation,
                              Scalar tolerance = {})
      : usable_(check(table, tolerance).ok()), surface_(usable_ ? Surface(table) : Surface()) {
    reset(start);
  }
  explicit Preisach(const Table&& table, StartState start = {}, Scalar tolerance = {}) = delete;

  /// Forgets the past and assumes another one.
  constexpr void reset(StartState start) {
    known_ = false;
    cut_loops_ = 0;
    if (!usable_) {
      return;
    }
    size_ = 1;
    history_[0] = {surface_.lowest(), surface_.lower_saturation()};
    last_ = {surface_.lowest(), Scalar{}};
    if (start == StartState::kPositiveSaturation) {
      move_to(surface_.highest());
    } else if (start == StartState::kDemagnetised) {
      demagnetise();
    }
  }

  /// One sample of the input (torque or voltage, the unit of the table); between samples the input is taken as
  /// monotone.
  constexpr auto update(Scalar input) -> ForceEstimate<Scalar> {
    if (!usable_) {
      return {.beyond_table = true};
    }
    bool beyond = false;
    const Position x = surface_.locate(input, beyond);
    const std::uint32_t cut_before = cut_loops_;
    move_to(x);
    known_ = known_ || x == surface_.lowest() || x == surface_.highest();
    return {.force = force_here(), .known = known_, .beyond_table = beyond, .history_cut = cut_loops_ != cut_before};
  }

  /// The law turned round: the input that a monotone motion from the present one has to reach for this force, with all
  /// that it wipes out on the way. Exact, since the force is piecewise linear along every branch: there and back is off
  /// by rounding only. Where the force does not change with the input, the input nearest to the present one. A force
  /// beyond a saturation gives that end of the table and is not reachable. Changes nothing; one halving of the
  /// extremes and one of the grid.
  [[nodiscard]] constexpr auto input_for(Scalar force) const -> InputCommand<Scalar> {
    if (!usable_) {
      return {};
    }
    const Scalar now = force_here();
    if (force == now) {
      return {surface_.input_at(last_.position), true};
    }
    return now < force ? rise_for(force) : fall_for(force);
  }

  [[nodiscard]] constexpr auto is_known() const -> bool { return known_; }
  /// Extremes in memory, the lower saturation included: 1 to Depth.
  [[nodiscard]] constexpr auto extremes() const -> std::size_t { return size_; }
  /// Loops dropped since the last reset because the memory was full; stays at its maximum.
  [[nodiscard]] constexpr auto cut_loops() const -> std::uint32_t { return cut_loops_; }

 private:
  using Surface = ReversalSurface<Scalar, MaxLevels>;
  using Position = GridPosition<Scalar>;
  using Gain = typename ScalarTraits<Scalar>::Gain;
  /// An extreme of the input and the sum up to it: the force is closed + f_{position, u} below a peak, and
  /// closed + f_uu - f_{u, position} above a valley, so closed itself at the valley.
  struct Extreme {
    Position position{};
    Scalar closed{};
  };

  // Valleys and peaks alternate from the lower saturation at index 0.
  [[nodiscard]] constexpr auto last_is_peak() const -> bool { return size_ % 2 == 0; }
  [[nodiscard]] constexpr auto top() const -> const Extreme& { return history_[size_ - 1]; }
  [[nodiscard]] constexpr auto peaks() const -> std::size_t { return size_ / 2; }
  [[nodiscard]] constexpr auto valleys() const -> std::size_t { return (size_ + 1) / 2; }
  [[nodiscard]] constexpr auto peak(std::size_t i) const -> const Extreme& { return history_[2 * i + 1]; }
  [[nodiscard]] constexpr auto valley(std::size_t i) const -> const Extreme& { return history_[2 * i]; }

  [[nodiscard]] constexpr auto force_here() const -> Scalar {
    return last_is_peak() ? last_.closed : last_.closed + surface_.on_diagonal(last_.position);
  }

  /// A branch that the input may run along: up from a valley, or down from a peak.
  struct Branch {
    Extreme from{};
    bool rising = true;
  };
  [[nodiscard]] constexpr auto force_on(const Branch& branch, const Position& x) const -> Scalar {
    const Position& from = branch.from.position;
    return branch.rising ? branch.from.closed + (surface_.on_diagonal(x) - surface_.at(x, from))
                         : branch.from.closed + surface_.at(from, x);
  }
  /// What would be remembered if the input turned here.
  [[nodiscard]] constexpr auto turned_at(const Position& extreme) const -> Extreme {
    const Extreme& before = top();
    return {extreme, last_is_peak() ? before.closed + surface_.at(before.position, extreme)
                                    : before.closed - surface_.at(extreme, before.position)};
  }

  /// How many of so many nested extremes stay when every one after the first that does not is gone. Halving finds it;
  /// the innermost is tried first, since most steps wipe out nothing.
  template <typename Stays>
  static constexpr auto staying(std::size_t count, Stays&& stays) -> std::size_t {
    if (count == 0 || stays(count - 1)) {
      return count;
    }
    std::size_t low = 0;
    for (std::size_t high = count - 1; low < high;) {  // at most as many rounds as Depth has bits
      const std::size_t middle = (low + high) / 2;
      if (stays(middle)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /// A peak that the force passes on the way up is wiped out with the valley below it, and the branch before goes on.
  [[nodiscard]] constexpr auto rise_for(Scalar force) const -> InputCommand<Scalar> {
    const std::size_t left = staying(peaks(), [&](std::size_t i) {
      const Extreme& top_of_loop = peak(i);
      return !(top_of_loop.closed + surface_.on_diagonal(top_of_loop.position) < force);
    });
    const bool passes = left < peaks();
    const Branch branch{passes ? valley(left) : (last_is_peak() ? last_ : top()), true};
    const Position start = passes ? peak(left).position : last_.position;
    const Position limit = left > 0 ? peak(left - 1).position : surface_.highest();
    if (left == 0 && force_on(branch, limit) < force) {
      return {surface_.input_at(limit), false};
    }
    return solve(branch, start, limit, force);
  }

  [[nodiscard]] constexpr auto fall_for(Scalar force) const -> InputCommand<Scalar> {
    const std::size_t left = staying(valleys(), [&](std::size_t i) { return !(force < valley(i).closed); });
    if (left == 0) {
      return {surface_.input_at(valley(0).position), false};
    }
    const bool passes = left < valleys();
    const Branch branch{passes ? peak(left - 1) : (last_is_peak() ? top() : last_), false};
    return solve(branch, passes ? valley(left).position : last_.position, valley(left - 1).position, force);
  }

  /// The place nearest to `start` where a branch has the force. @pre the force lies between those at start and limit
  [[nodiscard]] constexpr auto solve(const Branch& branch, const Position& start, const Position& limit,
                                     Scalar force) const -> InputCommand<Scalar> {
    constexpr Gain kWhole = ScalarTraits<Scalar>::fraction(1.0);
    const Position& bottom = branch.rising ? start : limit;
    const Position& ceiling = branch.rising ? limit : start;
    // Either branch gives more force at more input, and is linear between two lines of the grid.
    std::size_t cell = bottom.cell;
    for (std::size_t high = ceiling.cell; cell < high;) {
      const std::size_t line = (cell + high + 1) / 2;
      const Scalar there = force_on(branch, {line, Gain{}});
      if (there < force || (!branch.rising && there == force)) {
        cell = line;
      } else {
        high = line - 1;
      }
    }
    const Gain low = cell == bottom.cell ? bottom.fraction : Gain{};
    const Gain high = cell == ceiling.cell ? ceiling.fraction : kWhole;
    const Scalar force_low = force_on(branch, {cell, low});
    const Scalar height = force_on(branch, {cell, high}) - force_low;
    if (!(Scalar{} < height)) {
      return {surface_.input_at({cell, branch.rising ? low : high}), true};
    }
    const Gain share = clamp(ScalarTraits<Scalar>::gain(force - force_low, height), Gain{}, kWhole);
    return {surface_.input_at({cell, low + (high - low) * share}), true};
  }

  constexpr void move_to(const Position& x) {
    if (last_.position < x) {
      rise_to(x);
    } else if (x < last_.position) {
      fall_to(x);
    } else {
      return;
    }
    last_ = turned_at(x);
  }

  /// Wipes out every peak that x reaches, each with the valley below it.
  constexpr void rise_to(const Position& x) {
    const std::size_t left = staying(peaks(), [&](std::size_t i) { return x < peak(i).position; });
    if (last_is_peak() && left == peaks()) {
      remember_last();
    } else {
      size_ = 2 * left + 1;
    }
  }

  /// Wipes out every valley that x reaches, each with the peak above it; the lower saturation itself stays.
  constexpr void fall_to(const Position& x) {
    const std::size_t left = staying(valleys(), [&](std::size_t i) { return valley(i).position < x; });
    if (!last_is_peak() && left == valleys()) {
      remember_last();
    } else {
      size_ = std::max<std::size_t>(2 * left, 1);
    }
  }

  /// Turns. With the memory full, the loop between here and the last extreme is the smallest there is (each loop lies
  /// inside the one before): both are dropped, and the force steps by what that loop held.
  constexpr void remember_last() {
    if (size_ == Depth) {
      --size_;
      cut_loops_ += cut_loops_ < std::numeric_limits<std::uint32_t>::max() ? 1 : 0;
      return;
    }
    history_[size_] = last_;
    ++size_;
  }

  /// Ever smaller swings about the middle of the grid, one pair per cell as far as half the memory goes. Valleys lie on
  /// the line a + b = const and peaks half a step inside it, so the staircase has as much on one side of the line as on
  /// the other.
  constexpr void demagnetise() {
    const std::size_t quarters = 4 * (surface_.levels() - 1);
    const std::size_t pairs = std::min(surface_.levels() - 1, Depth / 4);
    for (std::size_t k = 1; k <= pairs; ++k) {
      move_to(at_quarter(quarters - quarters * (2 * k - 1) / (4 * pairs)));
      move_to(at_quarter(quarters * k / (2 * pairs)));
    }
  }

  static constexpr auto at_quarter(std::size_t quarter) -> Position {
    using Traits = ScalarTraits<Scalar>;
    constexpr std::array kFractions = {Traits::fraction(0.0), Traits::fraction(0.25), Traits::fraction(0.5),
                                       Traits::fraction(0.75)};
    return {quarter / 4, kFractions[quarter % 4]};
  }

  bool usable_;
  Surface surface_;
  std::array<Extreme, Depth> history_{};
  std::size_t size_ = 1;
  Extreme last_{};  ///< where the input is, as it would be remembered
  bool known_ = false;
  std::uint32_t cut_loops_ = 0;
};

/// A Preisach model that does not know its past and says how much that matters. Of all pasts, the two saturations leave
/// the most and the fewest relays up, so the force lies between those of the two models started there; what the input
/// sweeps closes the gap, and the first saturation closes it for good.
template <typename Scalar, std::size_t MaxLevels, std::size_t Depth = 64>
class PreisachBounds {
 public:
  using Model = Preisach<Scalar, MaxLevels, Depth>;
  using Table = typename Model::Table;
  struct Estimate {
    ForceEstimate<Scalar> middle{};  ///< its force is halfway between the bounds
    Scalar half_width{};             ///< the true force is within this of it; 0 once the past is known
  };

  /// As the model's own constructor. With noise in the table, bounds hold but for the tolerance.
  constexpr explicit PreisachBounds(const Table& table, Scalar tolerance = {})
      : low_(table, StartState::kNegativeSaturation, tolerance),
        high_(table, StartState::kPositiveSaturation, tolerance) {}
  explicit PreisachBounds(const Table&& table, Scalar tolerance = {}) = delete;

  constexpr auto update(Scalar input) -> Estimate {
    constexpr Scalar kHalf = ScalarTraits<Scalar>::from(0.5);
    Estimate estimate{low_.update(input), {}};
    if (!estimate.middle.known) {
      const auto high = high_.update(input);
      estimate.half_width = abs(high.force - estimate.middle.force) * kHalf;
      estimate.middle.force += (high.force - estimate.middle.force) * kHalf;
      estimate.middle.history_cut |= high.history_cut;
    }
    return estimate;
  }

  /// The model from the lower saturation: exact once the past is known.
  [[nodiscard]] constexpr auto lower() const -> const Model& { return low_; }

 private:
  Model low_;
  Model high_;
};

}  // namespace capstan
