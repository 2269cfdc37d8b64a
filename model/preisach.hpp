// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "model/reversal_surface.hpp"

namespace capstan {

/// What is assumed about the past until the input has been at an end of the table for the first time.
enum class StartState : std::uint8_t {
  kNegativeSaturation,  ///< the input rose from the lower end: exact if it did
  kDemagnetised,  ///< ever smaller swings about the middle of the grid: halfway between what the past could have been
};

template <typename Scalar>
struct ForceEstimate {
  Scalar force{};      ///< in the unit of the table
  bool known = false;  ///< the input has been at an end of the table, so the start state no longer matters
  bool beyond_table =
      false;  ///< the input is outside the table: the force is the saturation's, or there is no usable table
  bool history_cut = false;  ///< this step found the memory full and dropped the smallest loop in it
};

/// Classical Preisach model from first-order reversal values, (4.4) and (4.5):
///   f = f- + sum_{k<n} (f_{a_k b_k} - f_{a_k b_{k-1}}) + f*,
///   f* = f_{a_n u} - f_{a_n b_{n-1}} falling, f_{u u} - f_{u b_{n-1}} rising.
/// The thesis starts from -f+, which assumes symmetric saturations; here the sum starts from the measured lower one,
/// f-. The remembered extremes (a_k falling, b_k rising) are a stack; each keeps the sum up to itself, so a step costs
/// one or two table look-ups however deep the stack is, and wiping out an extreme is one comparison. No allocation;
/// every loop is bounded by Depth or MaxLevels.
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
    last_ = surface_.lowest();
    if (start == StartState::kDemagnetised) {
      demagnetise();
    }
  }

  /// One sample of the input (torque or voltage, the unit of the table); between samples the input is taken as
  /// monotone.
  constexpr auto update(Scalar input) -> ForceEstimate<Scalar> {
    ForceEstimate<Scalar> estimate;
    if (!usable_) {
      estimate.beyond_table = true;
      return estimate;
    }
    const Position x = surface_.locate(input, estimate.beyond_table);
    const std::uint32_t cut_before = cut_loops_;
    move_to(x);
    known_ = known_ || x == surface_.lowest() || x == surface_.highest();
    estimate.force = force_at(x);
    estimate.known = known_;
    estimate.history_cut = cut_loops_ != cut_before;
    return estimate;
  }

  [[nodiscard]] constexpr auto is_known() const -> bool { return known_; }
  /// Extremes in memory, the lower saturation included: 1 to Depth.
  [[nodiscard]] constexpr auto extremes() const -> std::size_t { return size_; }
  /// Loops dropped since the last reset because the memory was full; stays at its maximum.
  [[nodiscard]] constexpr auto cut_loops() const -> std::uint32_t { return cut_loops_; }

 private:
  using Surface = ReversalSurface<Scalar, MaxLevels>;
  using Position = GridPosition<Scalar>;
  /// An extreme of the input and the sum up to it: the force is closed + f_{position, u} below a peak, and
  /// closed + f_uu - f_{u, position} above a valley.
  struct Extreme {
    Position position{};
    Scalar closed{};
  };

  // Valleys and peaks alternate from the lower saturation at index 0.
  [[nodiscard]] constexpr auto last_is_peak() const -> bool { return size_ % 2 == 0; }
  [[nodiscard]] constexpr auto top() const -> const Extreme& { return history_[size_ - 1]; }

  [[nodiscard]] constexpr auto force_at(const Position& x) const -> Scalar {
    return last_is_peak() ? top().closed + surface_.at(top().position, x)
                          : top().closed + (surface_.at(x, x) - surface_.at(x, top().position));
  }

  constexpr void move_to(const Position& x) {
    if (last_ < x) {
      rise_to(x);
    } else if (x < last_) {
      fall_to(x);
    }
    last_ = x;
  }

  constexpr void rise_to(const Position& x) {
    if (last_is_peak()) {
      if (x < top().position) {
        remember(last_);
        return;
      }
      --size_;
    }
    while (size_ > 1 && !(x < history_[size_ - 2].position)) {
      size_ -= 2;  // wiped out: the valley and the peak before it
    }
  }

  constexpr void fall_to(const Position& x) {
    if (!last_is_peak()) {
      if (top().position < x) {
        remember(last_);
        return;
      }
      size_ -= size_ > 1 ? 1 : 0;
    }
    while (size_ > 1 && !(history_[size_ - 2].position < x)) {
      size_ -= size_ > 2 ? 2 : 1;  // the lower saturation itself stays
    }
  }

  /// Turns at an extreme. With the memory full, the loop between it and the last extreme is the smallest there is (each
  /// loop lies inside the one before): both are dropped, and the force steps by what that loop held.
  constexpr void remember(const Position& extreme) {
    if (size_ == Depth) {
      --size_;
      cut_loops_ += cut_loops_ < std::numeric_limits<std::uint32_t>::max() ? 1 : 0;
      return;
    }
    const Extreme& before = top();
    history_[size_] = {extreme, last_is_peak() ? before.closed + surface_.at(before.position, extreme)
                                               : before.closed - surface_.at(extreme, before.position)};
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
    constexpr std::array kFractions = {Traits::from(0.0), Traits::from(0.25), Traits::from(0.5), Traits::from(0.75)};
    return {quarter / 4, kFractions[quarter % 4]};
  }

  bool usable_;
  Surface surface_;
  std::array<Extreme, Depth> history_{};
  std::size_t size_ = 1;
  Position last_{};
  bool known_ = false;
  std::uint32_t cut_loops_ = 0;
};

}  // namespace capstan
