// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/catalogue.hpp"
#include "model/terms/angle_periodic.hpp"
#include "model/terms/axis_coupling.hpp"
#include "model/terms/effort/coulomb_friction.hpp"
#include "model/terms/effort/friction_asymmetry.hpp"
#include "model/terms/effort/inertia.hpp"
#include "model/terms/effort/offset.hpp"
#include "model/terms/effort/play_friction.hpp"
#include "model/terms/effort/stribeck_friction.hpp"
#include "model/terms/effort/viscous_friction.hpp"
#include "model/terms/gravity.hpp"
#include "model/terms/thermal_drift.hpp"

namespace capstan {

/// What an effort may consist of: the target is the torque, and q1 with its derivatives is given. Units are those of a
/// rotary axis; a linear one has m and N for rad and N m. The first two are the base law of rigid dynamics.
using EffortTerms = TermList<effort::Inertia, effort::ViscousFriction, effort::CoulombFriction,
                             effort::FrictionAsymmetry, effort::StribeckFriction, effort::PlayFriction, effort::Offset>;

/// Terms of the joint angle that an effort may hold as well, by the same files; their coefficients are then efforts per
/// regressor. OutputTerms act on it too.
using SharedTerms = TermList<Gravity, AxisCoupling, AnglePeriodic, ThermalDrift>;

}  // namespace capstan
