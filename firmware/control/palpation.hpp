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

/// Stiffness from motor torque and angle alone (thesis ch. 3): the tension state says the joint's torque and angle
/// while the tip is pressed, and one over the other is what it presses on. Stretches in which at least one tendon moves
/// in its whole length count, each about its own mean, so neither friction nor where the contact begins matter; the
/// interval is Student's, from how much the stretches differ, widened by what the law's own numbers are trusted to: 2 %
/// of any torque and 5 % of the instrument's compliance. For the background.
class Palpation {
 public:
  static constexpr std::size_t kMostSites = 16;

  /// What the force law must have: pull-push with both tendons' stiffness. nullptr, or "sentence; cure".
  static auto check(const ForceConfig& force) -> const char*;

  /// Begins a site. @pre check(force) has nothing against it   @param every_ms  between samples
  void begin(const ForceConfig& force, std::int32_t site, std::int32_t every_ms);
  void add(Q24 q1_rad, Q24 tau_nm);
  /// The site's stiffness, which goes into the map; none if the tip was not pressed far or often enough, or is as stiff
  /// as the instrument.
  auto end() -> std::optional<SiteStiffness>;

  /// In the order they were pressed; the oldest go when there are more than kMostSites.
  [[nodiscard]] auto map() const -> std::span<const SiteStiffness> { return {sites_.data(), count_}; }
  void clear() { count_ = 0; }

 private:
  /// In 2^-16 N m and 2^-16 rad, from the first of its stretch.
  struct Row {
    std::int32_t torque = 0;
    std::int32_t angle = 0;
  };
  struct Sums {
    std::int64_t n = 0, t = 0, q = 0, tt = 0, tq = 0;
  };
  struct Stretch {
    std::int64_t tt = 0;  // about the means
    std::int64_t tq = 0;
  };
  static constexpr std::size_t kMostStretches = 10;
  static constexpr std::size_t kEdge = 3;  ///< rows at either end of a stretch that lie near a kink of the law

  void take(const TensionStateEstimate<Q24>& estimate, bool forward);
  void add_row(const Row& row);
  void close_stretch();
  [[nodiscard]] auto fit() const -> std::optional<SiteStiffness>;

  TensionState<Q24> state_{{}};
  Q24 extreme_;  // of the motor's angle in the present direction
  std::int64_t q1_sum_ = 0, tau_sum_ = 0;
  std::int32_t averaged_ = 0, per_row_ = 1;
  Q24 largest_;
  Q24 own_compliance_;  // of the instrument at the joint, rad/(N m)
  Row origin_;
  std::array<Row, kEdge> pending_{};
  std::int32_t in_stretch_ = 0;
  ForcePhase phase_ = ForcePhase::kUnknown;
  bool forward_ = true;  // of the stretch
  bool moved_forward_ = true;
  Sums sums_;
  std::array<Stretch, kMostStretches> stretches_{};
  std::size_t stretch_count_ = 0;
  std::int32_t site_ = 0;
  std::array<SiteStiffness, kMostSites> sites_{};
  std::size_t count_ = 0;
};

}  // namespace capstan
