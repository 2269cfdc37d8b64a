// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/noncausal_samples.hpp"

namespace capstan::tools {

/// Samples of an effort's log noncausally, the motion being given: the acceleration is the second difference, which
/// passes the whole band of the motion. Its noise is left to the averaging that effort and columns share; a longer
/// window would take from the acceleration what it does not take from the effort.
auto given_motion(const AxisLog& log, const ConditionerShape<double>& conditioner, const AngleNoise& noise)
    -> NoncausalSamples;

/// The same samples by an encoder with its edges elsewhere, or with its noise drawn anew: what a law makes of the
/// difference is neither noise of the effort nor an effect.
auto motion_seen_again(const AxisLog& log, const NoncausalSamples& seen, const AngleNoise& noise) -> Samples;

/// How far an effort and everything that is to explain it are averaged alike, half width in samples of a mean taken
/// twice. A rigid law holds in the band of the motion: as far as the speed keeps 99.97 % of its energy. Further only
/// where the noise of the effort, or of the acceleration times the inertia, is above 2 % of the effort, to 15 ms at
/// most; and to 40 ms where the acceleration's noise is more than half of the effort's, for a coarse encoder's steps
/// come back with every equal cycle and look like something that the law lacks.
auto effort_smoothing(const std::vector<AxisLog>& logs, const AngleNoise& noise) -> Eigen::Index;

}  // namespace capstan::tools
