// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace capstan::tools {

/// Quantile p in [0, 1] of the values (nearest rank). @pre values not empty
auto quantile(const Eigen::VectorXd& values, double p) -> double;
auto median(const Eigen::VectorXd& values) -> double;
auto rms(const Eigen::VectorXd& values) -> double;
auto rms_about_mean(const Eigen::VectorXd& values) -> double;

/// From the least to the most. @pre values not empty
auto range_of(const Eigen::VectorXd& values) -> double;

/// Two-sided 95 % point of Student's t.
auto student_t95(double degrees_of_freedom) -> double;
/// Upper tail probability of the standard normal.
auto normal_tail(double z) -> double;
/// z with normal_tail(z) = p, 0 < p < 0.5.
auto normal_quantile_upper(double p) -> double;

/// Goodness of fit as the thesis defines it (ch. 6): 100 (1 - |q - q^| / |q^ - mean(q^)|), q measured, q^ estimated.
/// Percent.
auto goodness_of_fit_percent(const Eigen::VectorXd& measured, const Eigen::VectorXd& estimated) -> double;

/// Noise of a signal sampled faster than it changes: rms of the third difference, scaled for white noise. A smooth
/// signal has next to none, whatever its size.
auto white_noise_level(const Eigen::VectorXd& signal) -> double;
/// The same by the sixth difference, which has less of a fast motion in it, and more of an encoder's steps: up to 0.8
/// of one, where every other sample is a step further.
auto fast_noise_level(const Eigen::VectorXd& signal) -> double;
/// Resolution of a quantised channel: the step of which all changes are multiples. 0 if there is none to be seen.
auto quantisation_step(const Eigen::VectorXd& signal) -> double;

}  // namespace capstan::tools
