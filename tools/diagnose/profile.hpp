// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/cross_validation.hpp"

namespace capstan::tools {

/// A model with a noise model of its own, both fitted to some rows: what is compared is then the whole likelihood, and
/// no model's misfit is charged to another's noise.
struct Profile {
  Eigen::VectorXd theta;  ///< of the model's free columns
  AutoregressiveNoise noise;
};

/// Fits alternately by generalised least squares and Burg's method. `known` fixes the noise instead (pure error of
/// repeats).
auto fit_profile(const Eigen::MatrixXd& columns, const Layout& layout, const ColumnModel& model, const Blocks& rows,
                 const AutoregressiveNoise* known) -> Profile;

/// Log likelihood of each block of rows under a profile fitted to these rows or to others.
auto log_likelihood(const Eigen::MatrixXd& columns, const Layout& layout, const ColumnModel& model,
                    const Profile& profile, const Blocks& rows) -> Eigen::VectorXd;

}  // namespace capstan::tools
