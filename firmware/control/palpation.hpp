// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/model/tension_state.hpp"

namespace capstan {

/// What the tip touches at one site, at the joint.
struct SiteStiffness {
  std::int32_t site = 0;
  Q24 value_nm_per_rad{};
  Q24 half_interval{};       ///< of 95 %
  std::int32_t strokes = 0;  ///< stretches that the interval comes from
};

/// How a site is pressed.
struct Pressing {
  std::int32_t site = 0;
  Q24 largest_nm{};  ///< the largest torque of the motor, either way
};

/// Stiffness from motor torque and angle alone (thesis ch. 3): the tension state says the joint's torque and angle
/// while the tip is pressed, and one over the other is what it presses on. Stretches in which at least one tendon moves
/// in its whole length count, each about its own mean, so neither friction nor where the contact begins matter. Tissue
/// that resists speed is too stiff by a share of the speed on the way in and too soft by it on the way out; the two are
/// weighted by their speeds, so that the answer is that at rest. The same method as `capstan palpate`
/// (tools/identify/palpation.hpp), with sums in place of rows. For the background; a sample costs at most one step of
/// the tension state.
class Palpation {
 public:
  static constexpr std::size_t kMostSites = 16;

  /// What the force law must have: pull-push with both tendons' stiffness. nullptr, or "sentence; cure".
  static auto check(const ForceConfig& force) -> const char*;

  /// Begins a site. @pre check(force) has nothing against it
  void begin(const ForceConfig& force, const Pressing& pressing);
  /// What was measured in the next cycle.
  void add(Q24 q1_rad, Q24 tau_nm);
  /// The site's stiffness, which goes into the map; none if the tip was not pressed far enough, or is as stiff as the
  /// instrument.
  auto end() -> std::optional<SiteStiffness>;

  /// In the order they were pressed; the oldest go when there are more than kMostSites.
  [[nodiscard]] auto map() const -> std::span<const SiteStiffness> { return {sites_.data(), count_}; }
  /// From this many times the median on a site is stiffer than the rest, its whole interval; `capstan palpate` has the
  /// same (tools/identify/palpation.hpp).
  static constexpr Q24 kStiffFactor = Q24::from_double(1.2);
  /// The stiffness that the whole interval of a site has to be above to stand out; none with fewer than three sites.
  [[nodiscard]] auto stiff_from(Q24 factor) const -> std::optional<Q24>;
  void clear() { count_ = 0; }

 private:
  /// In 2^-16 N m and 2^-16 rad, from the first of its stretch.
  struct Row {
    std::int32_t torque = 0;
    std::int32_t angle = 0;
    std::int32_t time = 0;  ///< in rows
  };
  /// Sums of squares and products of torque and angle.
  struct Products {
    std::int64_t tt = 0, tq = 0, qq = 0;
    void add(std::int64_t t, std::int64_t q);
    void add(const Products& other);
  };
  /// Rows from a point where the tip is pressed, as far as they are taken.
  struct Stretch {
    Row first, last;
    std::int64_t t = 0, q = 0;
    Products rows, steps;  ///< the latter of the differences between neighbours
    std::int32_t count = 0;
  };
  /// All stretches of one side, stroke and phase, each about its own mean.
  struct Group {
    Products rows, steps;
    std::int32_t count = 0, stretches = 0;
    std::int32_t travel = 0, span = 0;  ///< of the joint, and the rows it took
  };
  struct Estimate {
    Q24 value;
    Q24 half;
  };
  struct Kind {
    bool forward_side;  ///< the joint's torque is positive
    bool pressing;      ///< the motor goes further in
    bool one_slack;
    friend auto operator==(const Kind&, const Kind&) -> bool = default;
  };
  static constexpr std::int32_t kEdge = 3;          ///< rows at either end of a stretch that lie near a kink of the law
  static constexpr std::int32_t kHeld = 6 * kEdge;  ///< a shorter stretch loses a sixth at either end

  void take(const TensionStateEstimate<Q24>& estimate, bool forward);
  void hold(const Row& row);
  void add_row(const Row& row);
  void close_stretch();
  static auto place_of(const Kind& kind) -> std::size_t;
  static auto stiffness_of(const Group& group) -> std::optional<Estimate>;
  [[nodiscard]] auto at_rest(bool forward_side, bool one_slack) const -> std::optional<Estimate>;
  [[nodiscard]] auto fit() const -> std::optional<SiteStiffness>;

  TensionState<Q24> state_{{}};
  Q24 extreme_;  // of the motor's angle in the present direction
  std::int64_t q1_sum_ = 0, tau_sum_ = 0;
  std::int32_t averaged_ = 0;
  Q24 largest_;  // torque of the joint at that of the motor
  std::int32_t time_ = 0;
  Row origin_;
  std::array<Row, kHeld> held_{};  // the last of the stretch, each at its number's remainder
  std::int32_t in_stretch_ = 0;
  Kind kind_{};  // of the stretch
  bool moved_forward_ = true;
  Stretch stretch_;
  std::array<Group, 8> groups_{};
  std::int32_t site_ = 0;
  std::array<SiteStiffness, kMostSites> sites_{};
  std::size_t count_ = 0;
};

}  // namespace capstan
