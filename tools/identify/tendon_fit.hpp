// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// The base law whose tendons have friction, pretension and stiffness of their own.
inline constexpr const char* kTendonModel = "tendon";

/// Time constant of the rate's filter that such laws are looked for with, s. Acceleration and torque come five times
/// that late, and so do angles where the tendons are fitted. Of 0.5, 1 and 2 ms the best on 7 joints with 40960 counts
/// a turn (4711, 9020 and 9022 of hal/sim, 6100, 6106, 6116 and 8004 of the independent plant); choose_tendon_filter
/// takes another where it is better.
inline constexpr double kTendonRateFilterS = 0.001;

/// Half the distance between the torques forward and backward on these rows, the faster the more weight: the friction
/// of everything while the joint is free. 0 where the motor moves one way only.
/// @param counts  which samples count
auto friction_torque(
    const LawDesign& design, const Blocks& rows,
    const std::function<bool(const Sample<double>&)>& counts = [](const Sample<double>&) { return true; }) -> double;

/// Finds the shapes of a law's term `tendon` from a motion of q1, tau and the target: from several starts that the
/// torque of steady motion suggests, on means over few rows first, seen at more places than the board has. Leaves the
/// other shapes as they are.
/// @param rows  samples that take part, in order
auto fit_tendon(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const LawForm& form)
    -> LawForm;

/// The same from where the shapes are: for a law whose joint has changed a little.
auto refine_tendon(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, LawForm form) -> LawForm;

/// How well logs tell a law's pretension from its friction numbers.
struct PretensionTrial {
  double left = 0.0;  ///< rms that the law leaves beyond the target's white noise
  double rise =
      0.0;  ///< rms by which it leaves more with a fifth less pretension or a quarter more, the lesser of both
};

/// Fits all but the pretension anew beside other pretensions. What a search's own intervals say holds near one of them
/// only: where both tendons stay taut their friction alone is told, and each pretension has friction numbers that serve
/// nearly as well.
auto try_pretensions(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const LawForm& law)
    -> PretensionTrial;

/// The law with the pretension that fits these rows best, its other shapes as they are.
auto with_other_pretension(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, LawForm form)
    -> LawForm;

}  // namespace capstan::tools
