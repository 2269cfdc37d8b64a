// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/thesis/figures.hpp"
#include "capstan/tools/thesis/tissues.hpp"

namespace capstan::tools {

/// How many 95 % intervals of `palpate` hold the stiffness of the tissue that was pressed.
struct CoverageCount {
  int asked = 0, answered = 0, inside = 0;
  double error = 0.0, half = 0.0;  ///< sums of shares of the truth

  void count(double truth, const std::optional<Stiffness>& said);
  [[nodiscard]] auto percent() const -> double { return 100.0 * inside / std::max(answered, 1); }
  [[nodiscard]] auto mean_error() const -> double { return error / std::max(answered, 1); }
  [[nodiscard]] auto mean_half() const -> double { return half / std::max(answered, 1); }
};
/// Tissues drawn from `first_seed` on, each pressed and released twice at a frequency.
auto tissue_coverage(int tissues, double frequency_hz, std::uint64_t first_seed) -> CoverageCount;

/// An inclusion under the middle of a row of sites, as much stiffer than tissue of 0.06 N m/rad that differs by up to
/// 10 % from site to site.
struct Inclusion {
  double stiffness_nm_per_rad, depth_rad;
};
/// What maps over such inclusions find, by the factor over the median from which on a site counts as stiff.
struct Detection {
  int maps = 0, others = 0;  ///< sites with an inclusion, and sites far from one
  std::vector<double> factors;
  std::vector<int> hits, alarms;  ///< one per factor
};
auto detect(const Inclusion& inclusion, int maps, std::uint64_t first_seed, const std::vector<double>& factors,
            const TensionStateParameters<double>& law) -> Detection;
/// Hits over false alarms, both as shares.
auto detection_series(const Detection& detection, const std::string& label, const std::string& colour) -> Series;

/// Coverage and detection as tables; detection as curves. Both draw the same tissues, once.
auto table_coverage() -> ThesisTable;
auto table_detection() -> ThesisTable;
auto detection_figure() -> ThesisFigure;

}  // namespace capstan::tools
