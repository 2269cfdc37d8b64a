// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "capstan/hal/sim/parameters.hpp"
#include "capstan/tools/identify/pretension.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// A drawn instrument whose pretension is 3 to 30 N, each as likely as its double.
auto drawn_pretension(std::uint64_t seed) -> sim::PlantParameters;

/// A free motion of a plant and one with the tip held, in which the motor pulls at it.
auto free_and_held(const sim::PlantParameters& plant, std::uint64_t seed) -> std::vector<AxisLog>;

/// What was told beside the plant's own number.
struct Told {
  Gauged told;
  double truth = 0.0;
  [[nodiscard]] auto error() const -> double { return told.value / truth - 1.0; }
  [[nodiscard]] auto held() const -> bool { return std::abs(told.value - truth) <= told.half; }
};

/// The gauge's whole way: identified from a free motion and one with the tip held, then asked by a free one alone.
struct GaugeAnswer {
  Told force_n, by_stiffness_n, eta;    ///< as identified; newtons by the radius, and by the stiffness instead
  std::optional<Told> now_n, change_n;  ///< after the pretension changed; nothing where it was not told
};
/// A joint, what is true of it, and its logs.
struct GaugedJoint {
  double radius_m, stiffness_n_per_m, eta, pretension_n;
  std::vector<AxisLog> free_and_held;
  std::function<AxisLog(double change_n)> free_later;  ///< once the pretension has changed by so much
};
/// @param times  the pretension that is left, or more than 1
auto gauge(const GaugedJoint& joint, double times) -> GaugeAnswer;
auto gauge(const sim::PlantParameters& plant, std::uint64_t seed, double times) -> GaugeAnswer;

/// Prints how well the gauge does on joints drawn by these seeds, with 0.5 to 1.8 times the pretension later.
/// @param independent  of the other plant, in its own motions
void ask_gauges(std::uint64_t first, int joints, bool independent);

}  // namespace capstan::tools::plant
