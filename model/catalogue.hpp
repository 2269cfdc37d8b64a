// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>

#include "model/terms/angle_periodic.hpp"
#include "model/terms/axis_coupling.hpp"
#include "model/terms/gravity.hpp"
#include "model/terms/joint_offset.hpp"
#include "model/terms/load_inertia.hpp"
#include "model/terms/motor_angle.hpp"
#include "model/terms/play.hpp"
#include "model/terms/presliding.hpp"
#include "model/terms/pretension_offset.hpp"
#include "model/terms/reversal_memory.hpp"
#include "model/terms/slip_propagation.hpp"
#include "model/terms/stiffness_hardening.hpp"
#include "model/terms/tendon_elongation.hpp"
#include "model/terms/thermal_drift.hpp"
#include "model/terms/transmission_viscous.hpp"
#include "model/terms/transport_delay.hpp"
#include "model/terms/viscoelastic_creep.hpp"

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

/// The catalogue. A new effect is one file in terms/ and one word here: parameters, shell, storage, fit and diagnosis
/// follow.
using SumTerms = TermList<MotorAngle, JointOffset, TendonElongation, TransmissionViscous, PretensionOffset,
                          ReversalMemory, SlipPropagation, Play, Presliding, Gravity, AxisCoupling, ViscoelasticCreep,
                          ThermalDrift, AnglePeriodic, StiffnessHardening, LoadInertia>;
/// Effects of the joint's own sensor, applied to the finished sum in this order.
using OutputTerms = TermList<TransportDelay>;

inline constexpr std::size_t kCoefficientCount = SumTerms::kCoefficients;
inline constexpr std::size_t kShapeCount = SumTerms::kShapes + OutputTerms::kShapes;

}  // namespace capstan
