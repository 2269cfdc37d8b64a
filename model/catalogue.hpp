// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>

#include "capstan/model/terms/angle_periodic.hpp"
#include "capstan/model/terms/axis_coupling.hpp"
#include "capstan/model/terms/coupled_hysteresis.hpp"
#include "capstan/model/terms/curved_ratio.hpp"
#include "capstan/model/terms/gravity.hpp"
#include "capstan/model/terms/hysteresis.hpp"
#include "capstan/model/terms/joint_offset.hpp"
#include "capstan/model/terms/load_inertia.hpp"
#include "capstan/model/terms/motor_angle.hpp"
#include "capstan/model/terms/play.hpp"
#include "capstan/model/terms/presliding.hpp"
#include "capstan/model/terms/pretension_offset.hpp"
#include "capstan/model/terms/reversal_memory.hpp"
#include "capstan/model/terms/slip_propagation.hpp"
#include "capstan/model/terms/stiffness_hardening.hpp"
#include "capstan/model/terms/table.hpp"
#include "capstan/model/terms/tendon.hpp"
#include "capstan/model/terms/tendon_elongation.hpp"
#include "capstan/model/terms/thermal_drift.hpp"
#include "capstan/model/terms/transmission_viscous.hpp"
#include "capstan/model/terms/transport_delay.hpp"
#include "capstan/model/terms/viscoelastic_creep.hpp"

namespace capstan {

/// A list of term templates; its order is the flat order of coefficients and shapes.
template <template <typename> typename... Terms>
struct TermList {
  static constexpr std::size_t kCoefficients = (std::size_t{0} + ... + kCoefficientsOf<Terms<double>>);
  static constexpr std::size_t kShapes = (std::size_t{0} + ... + kShapesOf<Terms<double>>);

  template <typename Scalar>
  using Tuple = std::tuple<Terms<Scalar>...>;

  /// Calls visit.template operator()<Term>() for every term written in Scalar, in order.
  template <typename Scalar, typename Visit>
  static constexpr void for_each(Visit&& visit) {
    (visit.template operator()<Terms<Scalar>>(), ...);
  }
};

/// The catalogue: a chain of input terms, the sum, output terms. A new effect is one file in terms/ and one word here:
/// parameters, shell, storage, fit and diagnosis follow.
/// What lies between the motor and the ratio, in this order; the ratio and its curve see what comes out of it.
using InputTerms = TermList<Hysteresis>;
using SumTerms = TermList<MotorAngle, JointOffset, TendonElongation, TransmissionViscous, PretensionOffset,
                          ReversalMemory, SlipPropagation, Play, Presliding, Gravity, AxisCoupling, ViscoelasticCreep,
                          ThermalDrift, AnglePeriodic, StiffnessHardening, LoadInertia, CurvedRatio, CoupledHysteresis,
                          CoupledHysteresis2, CoupledHysteresis3, Table, Tendons, AxisCoupling2, AxisCoupling3>;
/// Effects of the joint's own sensor, applied to the finished sum in this order.
using OutputTerms = TermList<TransportDelay>;

inline constexpr std::size_t kCoefficientCount = SumTerms::kCoefficients;
/// Of the input terms, then the sum's, then the output terms.
inline constexpr std::size_t kShapeCount = InputTerms::kShapes + SumTerms::kShapes + OutputTerms::kShapes;

/// Of any law that runs on a board: what its numbers hold, with room for a sum.
inline constexpr double kCoefficientLimit = 100.0;

/// Visits every term of the chain in the order of its flat lists of shapes and coefficients.
template <typename Scalar, typename Visit>
constexpr void for_each_term(Visit&& visit) {
  InputTerms::for_each<Scalar>(visit);
  SumTerms::for_each<Scalar>(visit);
  OutputTerms::for_each<Scalar>(visit);
}

}  // namespace capstan
