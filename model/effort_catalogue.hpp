// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/catalogue.hpp"
#include "capstan/model/terms/angle_periodic.hpp"
#include "capstan/model/terms/axis_coupling.hpp"
#include "capstan/model/terms/effort/coulomb_friction.hpp"
#include "capstan/model/terms/effort/friction_asymmetry.hpp"
#include "capstan/model/terms/effort/inertia.hpp"
#include "capstan/model/terms/effort/load_friction.hpp"
#include "capstan/model/terms/effort/motion_coupling.hpp"
#include "capstan/model/terms/effort/offset.hpp"
#include "capstan/model/terms/effort/play_friction.hpp"
#include "capstan/model/terms/effort/power_law_friction.hpp"
#include "capstan/model/terms/effort/spring.hpp"
#include "capstan/model/terms/effort/stribeck_friction.hpp"
#include "capstan/model/terms/effort/viscous_friction.hpp"
#include "capstan/model/terms/gear/gear_torque.hpp"
#include "capstan/model/terms/gear/load_friction.hpp"
#include "capstan/model/terms/gear/torque_saturation.hpp"
#include "capstan/model/terms/gravity.hpp"
#include "capstan/model/terms/thermal_drift.hpp"

namespace capstan {

/// What an effort may consist of: the target is the torque, and q1 with its derivatives is given. Units are those of a
/// rotary axis; a linear one has m and N for rad and N m. The first two are the base law of rigid dynamics.
using EffortTerms = TermList<effort::Inertia, effort::ViscousFriction, effort::CoulombFriction,
                             effort::FrictionAsymmetry, effort::StribeckFriction, effort::PlayFriction, effort::Offset>;

/// Terms of the joint angle that an effort may hold as well, by the same files; their coefficients are then efforts per
/// regressor. OutputTerms act on it too.
using SharedTerms = TermList<Gravity, AxisCoupling, AnglePeriodic, ThermalDrift>;

/// What measured machines have beside these. They take part in laws that are chosen for what they predict
/// (tools/select), not yet in the search for names.
using MachineEffortTerms = TermList<effort::PowerLawFriction, effort::Spring, effort::LoadFriction>;

/// What another joint's motion asks of this motor: terms of the other joint's sample.
using CouplingEffortTerms = TermList<effort::MotionCoupling>;

/// Torque behind a gear from the motor's: the gear's own terms. What the motor pays for friction the joint goes
/// without, so terms of efforts take part with any sign.
using GearTerms = TermList<gear::GearTorque, gear::LoadFriction, gear::TorqueSaturation>;

}  // namespace capstan
